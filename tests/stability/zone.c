/* The zone on a grid that mirroring and quarter turns take onto itself. */
#include "tests/stability/zone.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

void zone_see(struct zone *zone, const placido_surface *surface, const double turn[2][2]) {
  static const double none[2][2] = {{1, 0}, {0, 1}};
  const double(*t)[2] = turn ? turn : none;
  int near = 0;
  zone->level_um = 0;
  for (int k = 0; k < ZONE_PLACES; k++) {
    double at[2] = {(k % (2 * ZONE_HALF + 1) - ZONE_HALF) * ZONE_STEP_MM,
                    (k / (2 * ZONE_HALF + 1) - ZONE_HALF) * ZONE_STEP_MM};
    double x = t[0][0] * at[0] + t[0][1] * at[1], y = t[1][0] * at[0] + t[1][1] * at[1];
    double r = hypot(x, y);
    placido_jet jet;
    zone->height_um[k] = zone->axial_D[k] = NAN;
    if (r <= ZONE_MM / 2) {
      assert_true(placido_surface_at(surface, x, y, &jet));
      double slope = r > 0 ? (jet.sx * x + jet.sy * y) / r : 0;
      zone->height_um[k] = 1e3 * (placido_surface_vertex_z_mm(surface) - jet.sag);
      zone->axial_D[k] = r > 0 ? 337.5 * slope / (r * sqrt(1 + slope * slope)) : (double)NAN;
      zone->level_um += r <= LEVEL_MM / 2 ? zone->height_um[k] : 0;
      near += r <= LEVEL_MM / 2;
    }
  }
  zone->level_um /= near;
  for (int k = 0; k < ZONE_PLACES; k++) {
    zone->height_um[k] -= zone->level_um;
  }
}

double zone_difference(const double *a, const double *b) {
  double sum = 0;
  int count = 0;
  for (int k = 0; k < ZONE_PLACES; k++) {
    if (!isnan(a[k] - b[k])) {
      sum += (a[k] - b[k]) * (a[k] - b[k]);
      count++;
    }
  }
  return sqrt(sum / count);
}
