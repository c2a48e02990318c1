/* One edge point's residual in pixels and its derivatives. Everything in the camera that moves the
 * ray of a fixed image point acts like a movement of the image point itself. */
#include "acquire/calibrate/problem.h"
#include "acquire/calibrate/sphere.h"
#include "reconstruct/camera.h"

#include <math.h>

#define PASSES 2 /* of Newton's method from the point to the predicted edge */

placido_calibrate_geometry placido_calibrate_geometry_of(const placido_calibrate_problem *problem,
                                                         const double *q, int view) {
  const placido_calibrate_view *v = &problem->views[view];
  placido_calibrate_geometry g = {.instrument = problem->start};
  for (int i = 0; i < problem->parameters; i++) {
    *placido_instrument_parameter(&g.instrument, i) =
        problem->start_value[i] + problem->sigma[i] * q[i];
  }
  int radius = problem->parameters + v->ball;
  g.radius_mm = problem->start_value[radius] + problem->sigma[radius] * q[radius];
  const double *own = q + problem->shared + (size_t)3 * (size_t)view;
  for (int i = 0; i < 3; i++) {
    g.centre_mm[i] = v->start_mm[i] + v->sigma_mm[i] * own[i];
  }
  g.centre_mm[2] -= g.radius_mm;
  return g;
}

void placido_calibrate_places(int places[PLACIDO_CALIBRATE_SHARED_MAX],
                              const placido_calibrate_problem *problem, int edge, int ball) {
  for (int i = 0; i < PLACIDO_UNCERTAINTY_CAMERA; i++) {
    places[i] = i;
  }
  int *rest = places + PLACIDO_UNCERTAINTY_CAMERA;
  rest[0] = PLACIDO_UNCERTAINTY_CAMERA + edge;
  rest[1] = rest[0] + problem->start.edge_count;
  rest[2] = problem->parameters + ball;
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* By focal length, principal point and distortion, from F's derivatives by the image point (u, v).
 * Brown's model as in OpenCV's manual of calib3d. */
static void by_intrinsics(double out[9], const placido_instrument *instrument,
                          const placido_ray *ray, const double point[2], double by_u,
                          double by_v) {
  const double *f = instrument->focal_px, *c = instrument->principal_px;
  bool pinhole = instrument->model == PLACIDO_PINHOLE;
  double x = pinhole ? ray->direction[0] : ray->origin[0] - instrument->position_mm[0];
  double y = -(pinhole ? ray->direction[1] : ray->origin[1] - instrument->position_mm[1]);
  double r2 = x * x + y * y;
  const double moved[5][2] = {{x * r2, y * r2},
                              {x * r2 * r2, y * r2 * r2},
                              {2 * x * y, r2 + 2 * y * y},
                              {r2 + 2 * x * x, 2 * x * y},
                              {x * r2 * r2 * r2, y * r2 * r2 * r2}};
  out[0] = -by_u * (point[0] - c[0]) / f[0];
  out[1] = -by_v * (point[1] - c[1]) / f[1];
  out[2] = -by_u;
  out[3] = -by_v;
  for (int i = 0; i < 5; i++) {
    out[4 + i] = -(by_u * f[0] * moved[i][0] + by_v * f[1] * moved[i][1]);
  }
}

/* The miss at an image point, with its gradient there. */
typedef struct trial {
  placido_ray ray;
  placido_sphere_miss miss;
  double by_u, by_v;
} trial;

static bool look(trial *t, const placido_calibrate_geometry *geometry, const double at[2],
                 int edge) {
  const placido_instrument *instrument = &geometry->instrument;
  t->ray = placido_camera_ray(instrument, at[0], at[1]);
  bool met = placido_sphere_miss_at(&t->miss, t->ray.origin, t->ray.direction,
                                    geometry->centre_mm, geometry->radius_mm,
                                    &instrument->edges[edge]);
  t->by_u = dot(t->miss.by_direction, t->ray.direction_u) +
            dot(t->miss.by_origin, t->ray.origin_u);
  t->by_v = dot(t->miss.by_direction, t->ray.direction_v) +
            dot(t->miss.by_origin, t->ray.origin_v);
  return met && isfinite(t->miss.f / (t->by_u * t->by_u + t->by_v * t->by_v));
}

/* Derivatives belong to the place where the edge is predicted. Taken at the noisy point instead,
 * each row would be correlated with its own error, and tens of thousands of them pull the weakly
 * held parameters by several standard deviations. */
bool placido_calibrate_row_at(placido_calibrate_row *row,
                              const placido_calibrate_geometry *geometry,
                              const placido_mire_point *point, bool derivatives) {
  double at[2] = {point->u_px, point->v_px}, scale;
  trial t;
  *row = (placido_calibrate_row){.residual_px = 0};
  for (int pass = 0; pass < PASSES; pass++) {
    if (!look(&t, geometry, at, point->edge)) {
      row->residual_px = NAN;
      return false;
    }
    scale = 1 / hypot(t.by_u, t.by_v);
    double step = t.miss.f * scale;
    row->residual_px += step;
    if (pass < PASSES - 1) {
      at[0] -= step * t.by_u * scale;
      at[1] -= step * t.by_v * scale;
    }
  }
  if (!derivatives) {
    return true;
  }
  by_intrinsics(row->shared, &geometry->instrument, &t.ray, at, t.by_u, t.by_v);
  double *rest = row->shared + PLACIDO_UNCERTAINTY_CAMERA;
  for (int i = 0; i < 3; i++) {
    row->shared[9 + i] = t.miss.by_origin[i];
    row->view[i] = scale * t.miss.by_centre[i];
  }
  rest[0] = t.miss.by_edge_radius;
  rest[1] = t.miss.by_edge_z;
  rest[2] = t.miss.by_radius - t.miss.by_centre[2]; /* the vertex is held, not the centre */
  for (int i = 0; i < PLACIDO_CALIBRATE_SHARED_MAX; i++) {
    row->shared[i] *= scale;
  }
  return true;
}
