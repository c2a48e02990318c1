/* A zone's points, on a grid of its own so that what is fitted does not depend on a map's step. */
#include "reconstruct/maps/zone.h"

#include "base/memory.h"

#include <math.h>

#define POINTS_PER_MM 10

static void take(placido_zone *zone, const placido_surface *surface, double x, double y) {
  placido_jet jet;
  if (hypot(x, y) > zone->diameter_mm / 2) {
    return;
  }
  zone->sampled++;
  if (placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, &jet)) {
    double *point = zone->points[zone->count++];
    point[0] = x;
    point[1] = y;
    point[2] = placido_surface_vertex_z_mm(surface) - jet.sag;
  }
}

int placido_zone_new(placido_zone *zone, const placido_surface *surface, double diameter_mm,
                     placido_error *err) {
  *zone = (placido_zone){.diameter_mm = fmin(diameter_mm, 2 * placido_surface_radius_mm(surface))};
  int half = (int)floor(zone->diameter_mm / 2 * POINTS_PER_MM);
  size_t side = (size_t)(2 * half + 1);
  zone->points = placido_memory_new(side * side, sizeof *zone->points, err);
  if (!zone->points) {
    return PLACIDO_MEMORY;
  }
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      take(zone, surface, i / (double)POINTS_PER_MM, j / (double)POINTS_PER_MM);
    }
  }
  return PLACIDO_OK;
}

void placido_zone_free(placido_zone *zone) {
  placido_memory_free(zone->points);
  *zone = (placido_zone){0};
}
