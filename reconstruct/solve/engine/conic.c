/* Conicoid by Levenberg-Marquardt over four parameters; the derivatives of its jet by central
 * differences, which are good to nine digits here. */
#include "reconstruct/solve/engine/conic.h"

#include <math.h>

#define PARAMETERS 4 /* radius, asphericity, cx, cy */
#define STEPS_MAX 8 /* a scale: it need not be the best conicoid, the spline takes up the rest */
#define DIFFERENCE 1e-4

static const double RANGES[PARAMETERS][2] = {{4, 16}, {-2.5, 2}, {-3, 3}, {-3, 3}};
static const double STARTS[PARAMETERS] = {7.8, 0, 0, 0};

/* A fit on its way. */
struct fit {
  placido_sightlines *rays;
  double axis_z_mm, scale; /* in px: where the loss bends */
  int threads;
};

/* The conicoid through (0, 0, axis_z): its apex lies above that by its own sag there. */
static placido_conicoid conicoid_of(const struct fit *fit, const double v[PARAMETERS]) {
  placido_conicoid conicoid = {v[0], v[1], v[2], v[3], 0};
  placido_hit axis = {0};
  placido_conicoid_at(&conicoid, &axis);
  conicoid.apex_z_mm = fit->axis_z_mm - axis.z;
  return conicoid;
}

placido_part placido_conic_part(const placido_conicoid *k) {
  return (placido_part){
      .kind = PLACIDO_PART_BICONIC,
      .as.biconic = {k->radius_mm, k->q, k->radius_mm, k->q, 0, k->cx_mm, k->cy_mm}};
}

/* Mean of the robust losses log(1 + (r/scale)²), and the share of rays that meet the conicoid. */
static double loss(const struct fit *fit, const double v[PARAMETERS], double *share) {
  const placido_target target = {.base = conicoid_of(fit, v)};
  const double *residual_px = fit->rays->numbers[PLACIDO_RAY_RESIDUAL_PX];
  double sum = 0;
  size_t met = 0, count = fit->rays->count;
  placido_sightlines_trace(fit->rays, &target, fit->threads);
  for (size_t i = 0; i < count; i++) {
    double r = residual_px[i] / fit->scale;
    met += !isnan(r);
    sum += isnan(r) ? 10 : log1p(r * r);
  }
  *share = (double)met / (double)count;
  return sum / (double)count;
}

/* A residual's derivative by each parameter, from the difference of the jets on either side. */
static void slopes(const placido_sightlines *rays, size_t i,
                   placido_conicoid sides[PARAMETERS][2], double out[PARAMETERS]) {
  double *const *n = rays->numbers;
  double t = n[PLACIDO_RAY_T][i];
  double x = n[PLACIDO_RAY_ORIGIN_X][i] + t * n[PLACIDO_RAY_DIRECTION_X][i];
  double y = n[PLACIDO_RAY_ORIGIN_Y][i] + t * n[PLACIDO_RAY_DIRECTION_Y][i];
  for (int k = 0; k < PARAMETERS; k++) {
    placido_hit a = {.x = x, .y = y}, b = a;
    placido_conicoid_at(&sides[k][0], &a);
    placido_conicoid_at(&sides[k][1], &b);
    double by = (n[PLACIDO_RAY_BY_Z][i] * (b.z - a.z) + n[PLACIDO_RAY_BY_P][i] * (b.p - a.p) +
                 n[PLACIDO_RAY_BY_Q][i] * (b.q - a.q)) /
                (2 * DIFFERENCE);
    out[k] = isnan(by) ? 0 : by;
  }
}

/* Solves the damped 4×4 normal equations by Gauss-Jordan elimination; they are positive definite.
 */
static void solve(double a[PARAMETERS][PARAMETERS], double b[PARAMETERS], double damping) {
  for (int i = 0; i < PARAMETERS; i++) {
    a[i][i] = a[i][i] * (1 + damping) + 1e-12;
  }
  for (int k = 0; k < PARAMETERS; k++) {
    double pivot = a[k][k];
    for (int j = 0; j < PARAMETERS; j++) {
      a[k][j] /= pivot;
    }
    b[k] /= pivot;
    for (int i = 0; i < PARAMETERS; i++) {
      double factor = a[i][k];
      for (int j = 0; i != k && j < PARAMETERS; j++) {
        a[i][j] -= factor * a[k][j];
      }
      b[i] -= i != k ? factor * b[k] : 0;
    }
  }
}

/* The normal equations of rays that have been traced. */
static void gather(const struct fit *fit, const double v[PARAMETERS],
                   double a[PARAMETERS][PARAMETERS], double b[PARAMETERS]) {
  placido_conicoid sides[PARAMETERS][2];
  for (int k = 0; k < PARAMETERS; k++) {
    for (int side = 0; side < 2; side++) {
      double moved[PARAMETERS] = {v[0], v[1], v[2], v[3]};
      moved[k] += side ? DIFFERENCE : -DIFFERENCE;
      sides[k][side] = conicoid_of(fit, moved);
    }
  }
  for (size_t s = 0; s < fit->rays->count; s++) {
    double r = fit->rays->numbers[PLACIDO_RAY_RESIDUAL_PX][s], by[PARAMETERS];
    if (isnan(r)) {
      continue;
    }
    slopes(fit->rays, s, sides, by);
    double weight = 1 / (1 + r * r / (fit->scale * fit->scale));
    for (int i = 0; i < PARAMETERS; i++) {
      b[i] -= weight * by[i] * r;
      for (int j = 0; j < PARAMETERS; j++) {
        a[i][j] += weight * by[i] * by[j];
      }
    }
  }
}

/* One accepted step, or none where every damping fails. Returns whether it is worth another one. */
static bool improve(const struct fit *fit, double v[PARAMETERS], double *cost) {
  double a[PARAMETERS][PARAMETERS] = {{0}}, b[PARAMETERS] = {0}, share;
  gather(fit, v, a, b);
  for (double damping = 1e-4; damping < 1e4; damping *= 10) {
    double m[PARAMETERS][PARAMETERS], step[PARAMETERS], trial[PARAMETERS];
    for (int i = 0; i < PARAMETERS; i++) {
      step[i] = b[i];
      for (int j = 0; j < PARAMETERS; j++) {
        m[i][j] = a[i][j];
      }
    }
    solve(m, step, damping);
    for (int i = 0; i < PARAMETERS; i++) {
      trial[i] = fmax(RANGES[i][0], fmin(RANGES[i][1], v[i] + step[i]));
    }
    double now = loss(fit, trial, &share);
    if (now < *cost) {
      bool moved = *cost - now > 1e-3 * *cost;
      *cost = now;
      for (int i = 0; i < PARAMETERS; i++) {
        v[i] = trial[i];
      }
      return moved;
    }
  }
  return false;
}

int placido_conic_fit(placido_conicoid *conicoid, placido_sightlines *rays, double axis_z_mm,
                      int threads, placido_error *err) {
  double v[PARAMETERS] = {STARTS[0], STARTS[1], STARTS[2], STARTS[3]}, share = 0;
  struct fit fit = {.rays = rays, .axis_z_mm = axis_z_mm, .threads = threads};
  /* from a generous scale, where no point is an outlier yet, down to that of a good conicoid */
  for (fit.scale = 20; fit.scale > 1; fit.scale /= 4) {
    double cost = loss(&fit, v, &share);
    for (int step = 0; step < STEPS_MAX && improve(&fit, v, &cost); step++) {
    }
  }
  loss(&fit, v, &share);
  *conicoid = conicoid_of(&fit, v);
  if (share < 0.8) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no cornea mirrors the mires to where they are seen: %.0f %% of the "
                             "camera's rays miss the best conicoid",
                             100 * (1 - share));
  }
  return PLACIDO_OK;
}
