/* Ray tracing: Newton's method finds the cornea, the law of reflection gives the way to the mires.
 */
#include "phantom/trace.h"

#include <math.h>

#define ITERATIONS_MAX 30

placido_phantom_rig placido_phantom_rig_of(const placido_surface *surface,
                                           const placido_instrument *instrument,
                                           const double shift_mm[3],
                                           const placido_phantom_film *film) {
  return (placido_phantom_rig){
      .surface = surface,
      .instrument = instrument,
      .film = film,
      .profile = placido_phantom_profile_of(instrument),
      .shift_mm = {shift_mm[0], shift_mm[1], shift_mm[2]},
  };
}

/* Distance along a camera ray (along[2] = -1) to the tangent plane of the cornea at `hit`. */
static double to_tangent(const placido_phantom_ray *ray, const placido_phantom_hit *hit) {
  const double *p = ray->from, *d = ray->along, *q = hit->point_mm, *s = hit->slope;
  double above = p[2] - q[2] + s[0] * (p[0] - q[0]) + s[1] * (p[1] - q[1]);
  return above / (1 - s[0] * d[0] - s[1] * d[1]);
}

/* Newton's method for z + sag(x, y) = vertex_z from `distance` on. The last step is taken in the
 * slopes too, by the second derivatives: what is left is quadratic in a step of under a
 * nanometre across. */
static bool meet_from(const placido_surface *surface, const placido_phantom_ray *ray,
                      double distance, placido_phantom_hit *hit) {
  const double *p = ray->from, *d = ray->along;
  const double across = hypot(d[0], d[1]), vertex_z = placido_surface_vertex_z_mm(surface);
  for (int i = 0; i < ITERATIONS_MAX; i++) {
    placido_jet jet;
    double x = p[0] + distance * d[0], y = p[1] + distance * d[1];
    if (!placido_surface_at(surface, x, y, &jet)) {
      return false;
    }
    double above = p[2] - distance + jet.sag - vertex_z;
    double step = above / (1 - jet.sx * d[0] - jet.sy * d[1]);
    distance += step;
    if (fabs(step) * across < 1e-6) {
      double dx = step * d[0], dy = step * d[1];
      *hit = (placido_phantom_hit){
          .on_cornea = true,
          .point_mm = {x + dx, y + dy, p[2] - distance},
          .slope = {jet.sx + jet.sxx * dx + jet.sxy * dy, jet.sy + jet.sxy * dx + jet.syy * dy},
          .band = hit->band,
      };
      return isfinite(distance);
    }
  }
  return false;
}

/* From the neighbour's tangent plane where there is one, else from the plane of the vertex. */
static bool meet_cornea(const placido_surface *surface, const placido_phantom_ray *ray,
                        placido_phantom_hit *hit) {
  if (hit->on_cornea && meet_from(surface, ray, to_tangent(ray, hit), hit)) {
    return true;
  }
  return meet_from(surface, ray, ray->from[2] - placido_surface_vertex_z_mm(surface), hit);
}

/* The mirrored ray, in the instrument's coordinates. */
static placido_phantom_ray reflect(const placido_phantom_rig *rig, const placido_phantom_ray *ray,
                                   const placido_phantom_hit *hit) {
  double normal[3] = {hit->slope[0], hit->slope[1], 1};
  if (rig->film) {
    placido_phantom_film_add(rig->film, hit->point_mm[0], hit->point_mm[1], normal);
  }
  double along = 0, square = 0;
  for (int i = 0; i < 3; i++) {
    along += ray->along[i] * normal[i];
    square += normal[i] * normal[i];
  }
  placido_phantom_ray mirrored;
  for (int i = 0; i < 3; i++) {
    mirrored.from[i] = hit->point_mm[i] + rig->shift_mm[i];
    mirrored.along[i] = ray->along[i] - 2 * along / square * normal[i];
  }
  return mirrored;
}

void placido_phantom_trace(const placido_phantom_rig *rig, const double normalised[2],
                           placido_phantom_hit *hit) {
  placido_phantom_ray ray = placido_phantom_camera_ray(rig->instrument, normalised);
  for (int i = 0; i < 3; i++) {
    ray.from[i] -= rig->shift_mm[i];
  }
  if (!meet_cornea(rig->surface, &ray, hit)) {
    *hit = (placido_phantom_hit){.band = PLACIDO_PHANTOM_NO_BAND};
    return;
  }
  placido_phantom_ray mirrored = reflect(rig, &ray, hit);
  hit->band = placido_phantom_profile_band(&rig->profile, &mirrored, hit->band);
}

bool placido_phantom_is_bright(const placido_instrument *instrument, int band) {
  return band != PLACIDO_PHANTOM_NO_BAND && (band % 2 == 0) == instrument->first_band_bright;
}
