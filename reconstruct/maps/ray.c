/* CWhatUC's four error maps (Klein, Barsky and others, Proc. SPIE 3246, 1998): a ray from a distant
 * source on the axis meets the surface at P and is refracted by Snell's law; where it crosses the
 * axis, where it meets its neighbour along the meridian (the local focus), and where it lands.
 *
 * Of a skew ray the point nearest to the axis, and the point nearest to the neighbour, stand for
 * the crossings. With t the refracted ray's unit vector and ' the derivative along the meridian the
 * latter lies at P - t (P'·t')/(t'·t'), because t·t' = 0. */
#include "reconstruct/maps/kinds.h"

#include <math.h>

/* A refracted ray at a point and how both change along the meridian. */
typedef struct ray {
  double at[3], along[3];               /* P, t */
  double at_change[3], along_change[3]; /* P', t' */
} ray;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* With N the unit normal towards the light and the ray (0, 0, -1): t = (0, 0, -1)/n + k N, k = c/n
 * - sqrt(1 - (1 - c²)/n²), c = N_z; so t' = k' N + k N', k' = c' (1/n - c/(n² sqrt(...))). */
static ray trace(const placido_map_point *point) {
  const placido_jet *jet = &point->jet;
  double r = sqrt(point->x_mm * point->x_mm + point->y_mm * point->y_mm), n = point->index;
  bool on_axis = r < 1e-9; /* there along +x, as for axial curvature */
  double m[2] = {on_axis ? 1 : point->x_mm / r, on_axis ? 0 : point->y_mm / r};
  double c = 1 / sqrt(1 + jet->sx * jet->sx + jet->sy * jet->sy);
  double slopes[2] = {jet->sxx * m[0] + jet->sxy * m[1], jet->sxy * m[0] + jet->syy * m[1]};
  double c_change = -c * c * c * (jet->sx * slopes[0] + jet->sy * slopes[1]);
  double root = sqrt(1 - (1 - c * c) / (n * n)), k = c / n - root;
  double k_change = c_change * (1 / n - c / (n * n * root));
  const double normal[3] = {c * jet->sx, c * jet->sy, c};
  const double normal_change[3] = {c * slopes[0] + c_change * jet->sx,
                                   c * slopes[1] + c_change * jet->sy, c_change};
  ray found = {.at = {point->x_mm, point->y_mm, point->z_mm},
               .along = {0, 0, -1 / n},
               .at_change = {m[0], m[1], -(jet->sx * m[0] + jet->sy * m[1])}};
  for (int i = 0; i < 3; i++) {
    found.along[i] += k * normal[i];
    found.along_change[i] = k_change * normal[i] + k * normal_change[i];
  }
  return found;
}

/* From P to the local focus, mm along the ray. */
static double to_focus(const ray *r) {
  return -dot(r->at_change, r->along_change) / dot(r->along_change, r->along_change);
}

double placido_map_axial_refractive(const placido_map_point *point) {
  ray r = trace(point);
  if (sqrt(point->x_mm * point->x_mm + point->y_mm * point->y_mm) <
      1e-9) { /* the limit of the neighbours along +x */
    return 1000 * point->index / to_focus(&r);
  }
  double across = r.along[0] * r.along[0] + r.along[1] * r.along[1];
  return -1000 * point->index * across / (r.at[0] * r.along[0] + r.at[1] * r.along[1]);
}

double placido_map_instantaneous_refractive(const placido_map_point *point) {
  ray r = trace(point);
  return 1000 * point->index / to_focus(&r);
}

double placido_map_focusing_distance(const placido_map_point *point) {
  ray r = trace(point);
  double reach = to_focus(&r);
  double x = r.at[0] + reach * r.along[0], y = r.at[1] + reach * r.along[1];
  double z = r.at[2] + reach * r.along[2] - (point->axis_z_mm - point->retina_mm);
  return sqrt(x * x + y * y + z * z);
}

double placido_map_retinal_distance(const placido_map_point *point) {
  ray r = trace(point);
  double reach = (point->axis_z_mm - point->retina_mm - r.at[2]) / r.along[2];
  return hypot(r.at[0] + reach * r.along[0], r.at[1] + reach * r.along[1]);
}
