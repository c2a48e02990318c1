/* What a topographer's rings say beside the heights: their shapes, and keratometry by its maker's
 * rule. CSO's: 337.5 over the mean axial radius on the rings 6 to 10 of both halves of a diameter;
 * the flattest diameter and the one perpendicular to it. Found from published exports, whose
 * headers it reproduces to 0.04 D on average. */
#include "exchange/rings.h"

#include "reconstruct/maps/kinds.h"

#include <math.h>

#define FIRST_RING 5
#define END_RING 10
#define RINGS_MIN 3     /* of a semi-meridian */
#define DIAMETERS_MAX 1800
#define NO_CYLINDER_D 1e-6

void placido_elevation_rings(placido_mire_rings *rings, const placido_elevation *elevation) {
  *rings = (placido_mire_rings){.cso = true};
  if (elevation->meridian_count != PLACIDO_MIRE_RING_POINTS) {
    return;
  }
  for (int k = 0; k < elevation->ring_count && k < PLACIDO_MIRE_RINGS_MAX; k++) {
    for (int j = 0; j < PLACIDO_MIRE_RING_POINTS; j++) {
      size_t at = (size_t)k * PLACIDO_MIRE_RING_POINTS + (size_t)j;
      if (isnan(elevation->ring_x_mm[at])) {
        return;
      }
      rings->points_mm[k][j][0] = elevation->ring_x_mm[at];
      rings->points_mm[k][j][1] = elevation->ring_y_mm[at];
    }
    rings->count++;
  }
}

/* Adds the axial radii on one semi-meridian; returns how many there are. */
static int add_radii(double *sum_mm, const placido_elevation *e, const placido_surface *surface,
                     int meridian) {
  int count = 0;
  for (int k = FIRST_RING; k < END_RING; k++) {
    size_t at = (size_t)k * (size_t)e->meridian_count + (size_t)meridian;
    placido_map_point point = {.x_mm = e->ring_x_mm[at], .y_mm = e->ring_y_mm[at]};
    if (!isnan(point.x_mm) && placido_surface_at(surface, point.x_mm, point.y_mm, &point.jet)) {
      *sum_mm += PLACIDO_KERATOMETRIC / placido_map_axial(&point);
      count++;
    }
  }
  return count;
}

/* Power of a diameter; NaN where a half of it lacks rings. */
static double power_D(const placido_elevation *e, const placido_surface *surface, int diameter) {
  double sum_mm = 0;
  int one = add_radii(&sum_mm, e, surface, diameter);
  int other = add_radii(&sum_mm, e, surface, diameter + e->meridian_count / 2);
  return one >= RINGS_MIN && other >= RINGS_MIN ? PLACIDO_KERATOMETRIC * (one + other) / sum_mm
                                                : (double)NAN;
}

/* The flattest diameter, and between which of its neighbours the least of the parabola through them
 * lies. */
static int find_flattest(double *offset, const double *powers, int diameters) {
  int best = -1;
  for (int i = 0; i < diameters; i++) {
    if (isfinite(powers[i]) && (best < 0 || powers[i] < powers[best])) {
      best = i;
    }
  }
  *offset = 0;
  if (best >= 0) {
    double before = powers[(best + diameters - 1) % diameters];
    double behind = powers[(best + 1) % diameters], bend = before + behind - 2 * powers[best];
    *offset = bend > 0 ? 0.5 * (before - behind) / bend : 0;
  }
  return best;
}

bool placido_elevation_simk(placido_ring_simk *simk, const placido_elevation *elevation,
                            const placido_surface *surface) {
  double powers[DIAMETERS_MAX], offset;
  int diameters = elevation->meridian_count / 2;
  *simk = (placido_ring_simk){NAN, NAN, NAN, NAN};
  if (elevation->ring_count < END_RING || elevation->meridian_count % 4 != 0 ||
      diameters > DIAMETERS_MAX) {
    return false;
  }
  for (int i = 0; i < diameters; i++) {
    powers[i] = power_D(elevation, surface, i);
  }
  int flat = find_flattest(&offset, powers, diameters);
  if (flat < 0 || isnan(powers[(flat + diameters / 2) % diameters])) {
    return false;
  }
  simk->flat_D = powers[flat];
  simk->steep_D = powers[(flat + diameters / 2) % diameters];
  if (simk->steep_D - simk->flat_D > NO_CYLINDER_D) {
    simk->flat_axis_deg = fmod((flat + offset + diameters) * 180 / diameters, 180);
    simk->steep_axis_deg = fmod(simk->flat_axis_deg + 90, 180);
  }
  return true;
}
