/* Which map figure is drawn: a kind of map, or the error bars of one, with its scale and title. */
#include "report/report.h"

#include "base/memory.h"
#include "report/map_picture.h"
#include "report/number.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where the supported values of a map lie; NaN where there are none. */
typedef struct range {
  double lowest, highest;
  double low, high; /* without half a per cent at either end: few points never choose the scale */
} range;

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static int find_range(range *found, const placido_maps *maps, const double *values,
                      placido_error *err) {
  *found = (range){NAN, NAN, NAN, NAN};
  size_t all = (size_t)maps->size * (size_t)maps->size, count = 0;
  double *sorted = placido_memory_new(all, sizeof *sorted, err);
  if (sorted == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t k = 0; k < all; k++) {
    if (maps->valid[k] && isfinite(values[k])) {
      sorted[count++] = values[k];
    }
  }
  if (count > 0) {
    qsort(sorted, count, sizeof *sorted, compare);
    size_t tail = count / 200;
    *found = (range){sorted[0], sorted[count - 1], sorted[tail], sorted[count - 1 - tail]};
  }
  placido_memory_free(sorted);
  return PLACIDO_OK;
}

/* Decimals that show a hundredth of the step's order of magnitude or better. */
static int decimals(double step) {
  double wanted = 1 - floor(log10(step));
  return (int)fmin(fmax(wanted, 0), 8);
}

/* The line below the map: its step, its extremes and, for elevation, what it is measured from. */
static void describe(char *note, size_t size, const range *r, const placido_map_picture *picture) {
  const placido_sphere *sphere = &picture->maps->sphere;
  double step = picture->scale.step;
  const char *unit = picture->unit;
  char lowest[64] = "–", highest[64] = "–", reference[96] = "";
  if (isfinite(r->lowest)) {
    placido_number_write(lowest, sizeof lowest, r->lowest, decimals(step));
    placido_number_write(highest, sizeof highest, r->highest, decimals(step));
  }
  if (picture->from_sphere && isfinite(sphere->radius_mm)) {
    snprintf(reference, sizeof reference, "   ·   sphere of %.3f mm fitted over %g mm",
             sphere->radius_mm, sphere->zone_mm);
  }
  snprintf(note, size, "step %g %s   ·   lowest %s   ·   highest %s%s", step, unit, lowest, highest,
           reference);
}

int placido_figure_map(const placido_maps *maps, int kind, const char *path, placido_error *err) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  if (kind < 0 || (size_t)kind >= count) {
    return placido_error_set(err, PLACIDO_INPUT, "map %d: expected 0 to %zu", kind, count - 1);
  }
  const double *values = maps->values[kind];
  range r;
  int status = find_range(&r, maps, values, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  char title[128], note[256];
  placido_map_picture picture = {.maps = maps, .values = values, .title = title, .note = note};
  picture.unit = placido_unit_text(kinds[kind].unit);
  picture.scale = placido_scale_of_kind(&kinds[kind], r.low, r.high);
  picture.from_sphere = strcmp(kinds[kind].name, "elevation") == 0;
  snprintf(title, sizeof title, "%s map", kinds[kind].name);
  title[0] = (char)toupper((unsigned char)title[0]);
  describe(note, sizeof note, &r, &picture);
  return placido_map_picture_write(&picture, path, err);
}

int placido_figure_sigma(const placido_maps *maps, const char *which, const char *path,
                         placido_error *err) {
  static const struct {
    const char *name, *title, *unit;
  } rows[] = {
      {"sigma_z", "Uncertainty of elevation (1 σ)", "µm"},
      {"sigma_axial", "Uncertainty of axial curvature (1 σ)", "D"},
  };
  const double *arrays[] = {maps->sigma_z_um, maps->sigma_axial_D};
  size_t row = 0;
  while (row < 2 && strcmp(which, rows[row].name) != 0) {
    row++;
  }
  if (row == 2) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "error-bar map \"%s\": expected sigma_z or sigma_axial", which);
  }
  if (arrays[row] == NULL) {
    return placido_error_set(
        err, PLACIDO_INPUT, "error-bar map %s: this surface was not fitted, so it has none", which);
  }
  range r;
  int status = find_range(&r, maps, arrays[row], err);
  if (status != PLACIDO_OK) {
    return status;
  }
  char note[256];
  placido_map_picture picture = {.maps = maps,
                                 .values = arrays[row],
                                 .note = note,
                                 .title = rows[row].title,
                                 .unit = rows[row].unit};
  picture.scale = placido_scale_from_zero(r.high);
  describe(note, sizeof note, &r, &picture);
  return placido_map_picture_write(&picture, path, err);
}
