/* The median of the mean power over the covered surface, held against what corneas have. */
#include "reconstruct/solve/doubt/power.h"

#include "reconstruct/maps/kinds.h"
#include "reconstruct/median.h"

#include <math.h>

/* Mean power of a whole cornea, keratometric: from a radius of 13.5 mm to one of 4.2 mm. */
#define POWER_LEAST_D 25
#define POWER_MOST_D 80
#define POWER_STEP_MM 0.5
#define POWER_GRID 32

/* Median of the mean power over the covered surface, on a coarse grid. */
static double usual_power_D(const placido_surface *surface, double *work) {
  double radius = placido_surface_radius_mm(surface);
  int half = (int)fmin(POWER_GRID / 2, radius / POWER_STEP_MM);
  size_t n = 0;
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * POWER_STEP_MM, y = j * POWER_STEP_MM;
      placido_map_point point = {.x_mm = x, .y_mm = y};
      if (placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, &point.jet)) {
        work[n++] = placido_map_mean(&point);
      }
    }
  }
  return placido_quantile(work, n, 0.5);
}

/* A surface that follows the mires and is no cornea comes of a wrong distance, instrument or
 * numbering. */
int placido_power_check(const placido_surface *surface, placido_error *err) {
  double work[(POWER_GRID + 1) * (POWER_GRID + 1)];
  double power = usual_power_D(surface, work);
  if (power > POWER_LEAST_D && power < POWER_MOST_D) {
    return PLACIDO_OK;
  }
  if (isnan(power)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "nothing is left of the map, or too little to tell its power: the "
                             "points lie on a line, or contradict each other everywhere");
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "the surface would have %.1f D, a cornea has %d to %d D: the distance, "
                           "the instrument or the numbering is wrong",
                           power, POWER_LEAST_D, POWER_MOST_D);
}
