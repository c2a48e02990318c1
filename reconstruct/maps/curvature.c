/* Curvatures: axial, tangential, mean, Gaussian.
 * Axial and tangential belong to the meridian through the z axis (ISO 19980; Klein & Mandell,
 * Invest. Ophthalmol. Vis. Sci. 36, 2096-2109, 1995); mean and Gaussian are the surface's own (do
 * Carmo, Differential Geometry of Curves and Surfaces, 1976, section 3-3, for a graph). */
#include "reconstruct/maps/kinds.h"

#include <math.h>

/* Slope of the sag along the meridian, and the slope's derivative along it; on the axis along +x.
 */
static double meridian(const placido_map_point *point, double *bend) {
  const placido_jet *jet = &point->jet;
  double r = hypot(point->x_mm, point->y_mm);
  double c = r > 0 ? point->x_mm / r : 1, s = r > 0 ? point->y_mm / r : 0;
  *bend = c * c * jet->sxx + 2 * c * s * jet->sxy + s * s * jet->syy;
  return c * jet->sx + s * jet->sy;
}

/* Where r is so small that slope / r loses its digits the limit, s', stands for it. */
static bool is_on_axis(const placido_map_point *point) {
  return hypot(point->x_mm, point->y_mm) < 1e-9;
}

double placido_map_axial(const placido_map_point *point) {
  double bend, slope = meridian(point, &bend);
  if (is_on_axis(point)) {
    return PLACIDO_KERATOMETRIC * bend;
  }
  double r = hypot(point->x_mm, point->y_mm);
  return PLACIDO_KERATOMETRIC * slope / (r * sqrt(1 + slope * slope));
}

double placido_map_tangential(const placido_map_point *point) {
  double bend, slope = meridian(point, &bend), square = 1 + slope * slope;
  return PLACIDO_KERATOMETRIC * (is_on_axis(point) ? bend : bend / (square * sqrt(square)));
}

double placido_map_mean(const placido_map_point *point) {
  const placido_jet *jet = &point->jet;
  double xx = 1 + jet->sx * jet->sx, yy = 1 + jet->sy * jet->sy;
  double square = xx + jet->sy * jet->sy;
  double numerator = xx * jet->syy - 2 * jet->sx * jet->sy * jet->sxy + yy * jet->sxx;
  return PLACIDO_KERATOMETRIC * numerator / (2 * square * sqrt(square));
}

double placido_map_gaussian(const placido_map_point *point) {
  const placido_jet *jet = &point->jet;
  double square = 1 + jet->sx * jet->sx + jet->sy * jet->sy;
  return (jet->sxx * jet->syy - jet->sxy * jet->sxy) / (square * square);
}
