/* Refractive power: what the point does to a ray from a distant source on the axis.
 * The ray (0, 0, -1) meets the surface at P and is refracted by Snell's law into index n = 1.3375.
 * Its component within the meridian plane of P (so that skew rays have a power too) crosses the
 * axis at the point's own focus F. The power is n/f with f the focal length, measured along the
 * axis from the plane of the vertex (the surface's point on the axis) to F. So f is n R/(n - 1)
 * near the axis of a sphere, which makes 337.5/R, and one and the same all over the ellipsoid with
 * Q = -1/n², which has one focus. The distance |PF| was rejected: by it the perfect ellipsoid's
 * power would grow outwards. */
#include "reconstruct/maps/kinds.h"

#include <math.h>

#define INDEX 1.3375

double placido_map_refractive(const placido_map_point *point) {
  const placido_jet *jet = &point->jet;
  double r = sqrt(point->x_mm * point->x_mm + point->y_mm * point->y_mm);
  if (r < 1e-9) { /* the limit along +x, as for axial curvature */
    return PLACIDO_KERATOMETRIC * jet->sxx;
  }
  double radial = (point->x_mm * jet->sx + point->y_mm * jet->sy) / r;
  double steepness = jet->sx * jet->sx + jet->sy * jet->sy;
  double incident = 1 / sqrt(1 + steepness); /* cosine; also the unit normal's z */
  double refracted = sqrt(1 - steepness * incident * incident / (INDEX * INDEX));
  double turn = incident / INDEX - refracted; /* ray = (0, 0, -1)/n + turn * normal */
  double ray_r = turn * radial * incident, ray_z = turn * incident - 1 / INDEX;
  return 1000 * INDEX * ray_r / ((point->axis_z_mm - point->z_mm) * ray_r + r * ray_z);
}
