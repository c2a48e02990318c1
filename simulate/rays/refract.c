/* The thin lens and Snell's law in vector form, for columns of rays.
 *
 * The light comes along -z. A thin lens on the cornea changes a ray's slope by -S r (Prentice's
 * rule), S = [[M + J0, J45], [J45, M - J0]] and r the position from the pupil's centre. The surface
 * then refracts it exactly: with d the ray, N the normal towards the light and c = -d.N,
 * t = d / n + (c / n - sqrt(1 - (1 - c²) / n²)) N. */
#include "simulate/rays/refract.h"

#include "base/dispatch.h"

#include <math.h>

static const double cosine_min = 0.17364817766693034885; /* of 80 degrees */

/* The thin lens as slope per millimetre, and 1 / n. */
typedef struct lens {
  double xx, xy, yy, x_mm, y_mm, slowness;
} lens;

static lens lens_of(const placido_eye *eye) {
  const placido_correction *worn = &eye->correction;
  return (lens){-(worn->m_D + worn->j0_D) / 1000, -worn->j45_D / 1000,
                -(worn->m_D - worn->j0_D) / 1000, eye->pupil_x_mm,
                eye->pupil_y_mm,                  1 / eye->index};
}

/* A ray at the surface: along itself, along the normal, and downwards. */
typedef struct ray {
  double ax, ay;              /* slopes of what the lens lets through */
  double cosine, root;        /* of the incidence; under Snell's square root */
  double on_ray, on_normal, down;
} ray;

PLACIDO_INSIDE ray bend(const lens *l, double x_mm, double y_mm, double sx, double sy) {
  ray r;
  double rx = x_mm - l->x_mm, ry = y_mm - l->y_mm;
  r.ax = l->xx * rx + l->xy * ry;
  r.ay = l->xy * rx + l->yy * ry;
  double along_ray = 1 / sqrt(1 + r.ax * r.ax + r.ay * r.ay);
  double along_normal = 1 / sqrt(1 + sx * sx + sy * sy);
  r.cosine = (1 - r.ax * sx - r.ay * sy) * along_ray * along_normal;
  r.root = 1 - l->slowness * l->slowness * (1 - r.cosine * r.cosine);
  r.on_ray = l->slowness * along_ray;
  r.on_normal = (l->slowness * r.cosine - sqrt(r.root)) * along_normal;
  r.down = r.on_ray - r.on_normal;
  return r;
}

PLACIDO_WIDE
void placido_refract(double *restrict u, double *restrict v, const double *restrict x_mm,
                     const double *restrict y_mm, const double *restrict sx,
                     const double *restrict sy, size_t count, const placido_eye *eye) {
  const lens l = lens_of(eye);
  for (size_t i = 0; i < count; i++) {
    ray r = bend(&l, x_mm[i], y_mm[i], sx[i], sy[i]);
    double along = r.cosine >= cosine_min && r.down > 0 ? 1 / r.down : NAN;
    u[i] = (r.on_ray * r.ax + r.on_normal * sx[i]) * along;
    v[i] = (r.on_ray * r.ay + r.on_normal * sy[i]) * along;
  }
}

enum placido_fate placido_refract_fate(double x_mm, double y_mm, double sx, double sy,
                                       const placido_eye *eye) {
  const lens l = lens_of(eye);
  ray r = bend(&l, x_mm, y_mm, sx, sy);
  if (!isfinite(sx + sy)) {
    return PLACIDO_FATE_MISSED;
  }
  if (!(r.cosine >= cosine_min)) {
    return PLACIDO_FATE_GRAZED;
  }
  if (!(r.root >= 0)) {
    return PLACIDO_FATE_REFLECTED;
  }
  return r.down > 0 ? PLACIDO_FATE_ARRIVED : PLACIDO_FATE_GRAZED;
}
