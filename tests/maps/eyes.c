/* Surfaces for tests of maps and indices. */
#include "tests/maps/eyes.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static placido_surface *make(const placido_part *parts, size_t count,
                             const placido_coverage *coverage) {
  placido_surface *surface;
  placido_error err = {0};
  if (placido_surface_new(&surface, 0, 4.5, parts, count, coverage, &err)) {
    fail_msg("%s", err.text);
  }
  return surface;
}

placido_surface *eye_of(const placido_part *parts, size_t count) {
  return make(parts, count, NULL);
}

placido_surface *conicoid_eye(double radius_mm, double q, double x_mm, double y_mm) {
  placido_part part = {.kind = PLACIDO_PART_BICONIC,
                       .as.biconic = {radius_mm, q, radius_mm, q, 0, x_mm, y_mm}};
  return make(&part, 1, NULL);
}

placido_surface *partly_covered_eye(double radius_mm, const unsigned char supported[19]) {
  unsigned char mask[19 * 19];
  for (int j = 0; j < 19; j++) {
    memcpy(mask + (size_t)j * 19, supported, 19);
  }
  placido_part part = {.kind = PLACIDO_PART_BICONIC,
                       .as.biconic = {radius_mm, 0, radius_mm, 0, 0, 0, 0}};
  placido_coverage coverage = {-4.5, -4.5, 0.5, 19, 19, mask};
  return make(&part, 1, &coverage);
}

placido_maps maps_of(const placido_surface *surface) {
  placido_maps maps;
  placido_error err = {0};
  if (placido_maps_new(&maps, surface, NULL, 0.1, &err)) {
    fail_msg("%s", err.text);
  }
  return maps;
}

double map_at(const placido_maps *maps, const char *name, int i, int j) {
  int kind = placido_maps_find(name);
  assert_true(kind >= 0);
  return maps->values[kind][j * maps->size + i];
}

double distance_of(const placido_maps *maps, int i, int j) {
  return hypot(placido_maps_position(maps, i), placido_maps_position(maps, j));
}
