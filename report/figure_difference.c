/* A difference map: about zero, hatched where it is within what error bars allow. */
#include "report/report.h"

#include "report/map_picture.h"
#include "report/number.h"
#include "report/range.h"

#include <math.h>
#include <stdio.h>

static bool has_sigmas(const placido_difference *difference, enum placido_difference_kind kind) {
  for (size_t k = 0; k < (size_t)difference->size * (size_t)difference->size; k++) {
    if (isfinite(difference->sigmas[kind][k])) {
      return true;
    }
  }
  return false;
}

int placido_figure_difference(const placido_difference *difference,
                              enum placido_difference_kind kind, const char *const names[2],
                              const char *path, placido_error *err) {
  const placido_maps maps = {.step_mm = difference->step_mm,
                             .radius_mm = difference->radius_mm,
                             .half = difference->half,
                             .size = difference->size,
                             .valid = difference->valid};
  char note[256], second[256];
  const char *unit = placido_difference_unit(kind);
  bool known = has_sigmas(difference, kind);
  placido_map_picture picture = {.maps = &maps,
                                 .values = difference->values[kind],
                                 .title = placido_difference_title(kind),
                                 .unit = placido_unit_text(unit),
                                 .note = note,
                                 .second_note = second,
                                 .sigmas = known ? difference->sigmas[kind] : NULL};
  placido_range r;
  int status = placido_range_find(&r, &maps, picture.values, 0, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  picture.scale = placido_scale_of_difference(unit, r.low, r.high);
  placido_range_describe(note, sizeof note, &r, picture.scale.step, picture.unit);
  snprintf(second, sizeof second, "%.90s less %.90s%s", names[1], names[0],
           known ? "" : "   ·   error bars not known");
  return placido_map_picture_write(&picture, path, err);
}
