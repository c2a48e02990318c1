/* Snell's law for many rays at a time. */
#ifndef PLACIDO_SIMULATE_RAYS_REFRACT_H
#define PLACIDO_SIMULATE_RAYS_REFRACT_H

#include <placido/eye.h>
#include <stddef.h>

/* What became of a ray. */
enum placido_fate {
  PLACIDO_FATE_ARRIVED,
  PLACIDO_FATE_MISSED,   /* the surface is not defined there */
  PLACIDO_FATE_GRAZED,   /* met from behind or at more than 80 degrees */
  PLACIDO_FATE_REFLECTED /* totally */
};

/* Slopes dx/dz, dy/dz behind the surface of light that comes along the axis through the thin lens
 * that `eye` wears and meets the surface at (x, y) with the slopes sx, sy of its sag. NaN where it
 * is missed (a slope is NaN), grazed, or reflected. Each ray by itself: however they are grouped. */
void placido_refract(double *restrict u, double *restrict v, const double *restrict x_mm,
                     const double *restrict y_mm, const double *restrict sx,
                     const double *restrict sy, size_t count, const placido_eye *eye);

/* Why the ray has no slopes; PLACIDO_FATE_ARRIVED where it has. */
enum placido_fate placido_refract_fate(double x_mm, double y_mm, double sx, double sy,
                                       const placido_eye *eye);

#endif
