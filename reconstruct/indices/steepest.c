/* The steepest place of the cornea, by tangential power. Axial power would not do: where the
 * surface is inclined on the axis it grows without bound towards it. */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/kinds.h"

#include <math.h>

#define POINTS_PER_MM 10
#define HALF 40 /* 4 mm */

placido_peak placido_steepest_find(const placido_surface *surface) {
  placido_peak peak = {NAN, NAN, NAN};
  for (int j = -HALF; j <= HALF; j++) {
    for (int i = -HALF; i <= HALF; i++) {
      placido_map_point point = {.x_mm = i / (double)POINTS_PER_MM,
                                 .y_mm = j / (double)POINTS_PER_MM};
      if (i * i + j * j > HALF * HALF ||
          !placido_surface_covered(surface, point.x_mm, point.y_mm) ||
          !placido_surface_at(surface, point.x_mm, point.y_mm, &point.jet)) {
        continue;
      }
      double power = placido_map_tangential(&point);
      if (!(power <= peak.power_D)) { /* also where there is none yet */
        peak = (placido_peak){point.x_mm, point.y_mm, power};
      }
    }
  }
  return peak;
}

double placido_index_steepest(const placido_cornea *cornea, double *sigma) {
  *sigma = NAN;
  return cornea->steepest.power_D;
}

double placido_index_steepest_x(const placido_cornea *cornea, double *sigma) {
  *sigma = NAN;
  return cornea->steepest.x_mm;
}

double placido_index_steepest_y(const placido_cornea *cornea, double *sigma) {
  *sigma = NAN;
  return cornea->steepest.y_mm;
}
