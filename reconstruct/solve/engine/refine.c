/* Gauss-Newton with Levenberg damping only where the cost would rise: sum of pseudo-Huber losses,
 * third-derivative penalty, and the given distance as a stiff spring. */
#include "reconstruct/solve/engine/refine.h"

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/engine/assemble.h"

#include <math.h>

#define HUBER PLACIDO_HUBER
#define SIGMA_MIN_PX 0.01
#define SIGMA_MAX_PX 5.0
#define NEAR 0.1          /* of the cost: after falls below it the next one is at most */
#define RATE 0.05         /* times as large, where points are well fitted; twice where badly */
#define ROUNDING 1e-7 /* a rise of the cost as small as this is no rise */

int placido_refinement_new(placido_refinement *r, const placido_conicoid *base,
                           const placido_grid *grid, placido_sightlines *rays, double smoothing,
                           int steps_max, int threads, placido_error *err) {
  *r = (placido_refinement){.shape = {.base = *base, .grid = grid},
                            .rays = rays,
                            .samples = rays->samples,
                            .count = rays->count,
                            .smoothing = smoothing,
                            .steps_max = steps_max,
                            .threads = threads};
  int status = placido_normal_new(&r->normal, grid, err);
  if (!status) {
    status = placido_sightlines_fit_grid(rays, grid, err);
  }
  if (!status) {
    r->coefficients = placido_memory_new((size_t)grid->side * (size_t)grid->side,
                                         sizeof *r->coefficients, err);
    r->work = placido_memory_new(r->count, sizeof *r->work, err);
    status = r->coefficients && r->work ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (status) {
    placido_refinement_free(r);
    return status;
  }
  r->shape.coefficients = r->coefficients;
  return PLACIDO_OK;
}

void placido_refinement_free(placido_refinement *r) {
  placido_normal_free(r->normal);
  placido_memory_free(r->coefficients);
  placido_memory_free(r->work);
  *r = (placido_refinement){0};
}

int placido_refinement_aim(placido_refinement *r, placido_sightlines *rays, placido_error *err) {
  double *work = placido_memory_new(rays->count, sizeof *work, err);
  int status = work ? placido_sightlines_fit_grid(rays, r->shape.grid, err) : PLACIDO_MEMORY;
  if (status) {
    placido_memory_free(work);
    return status;
  }
  placido_memory_free(r->work);
  r->work = work;
  r->rays = rays;
  r->samples = rays->samples;
  r->count = rays->count;
  r->traced = false;
  return PLACIDO_OK;
}

/* Twice the pseudo-Huber loss of a residual in sigmas. */
static double loss(double residual) {
  double x = residual / HUBER;
  return 2 * HUBER * HUBER * (sqrt(1 + x * x) - 1);
}

static void trace(placido_refinement *r) {
  r->told = false;
  placido_sightlines_trace(r->rays, &r->shape, r->threads);
}

/* The cost at the present sigma. Points whose ray misses cost as much as far outliers, so that a
 * step cannot win by losing points. */
static double cost(const placido_refinement *r) {
  const double *residual_px = r->rays->numbers[PLACIDO_RAY_RESIDUAL_PX];
  double sum = 0, share = 1 / r->sigma_px;
  for (size_t i = 0; i < r->count; i++) {
    if (r->rays->used[i]) {
      sum += isnan(residual_px[i]) ? loss(100) : loss(residual_px[i] * share);
    }
  }
  placido_basis basis;
  double off = placido_refinement_at_axis(r, &basis);
  return sum + PLACIDO_DISTANCE_WEIGHT * off * off +
         r->smoothing * placido_normal_roughness(r->normal, r->coefficients);
}

/* Robust spread of the residuals that count. */
static void rescale(placido_refinement *r) {
  const double *residual_px = r->rays->numbers[PLACIDO_RAY_RESIDUAL_PX];
  size_t n = 0;
  for (size_t i = 0; i < r->count; i++) {
    if (r->rays->used[i] && !isnan(residual_px[i])) {
      r->work[n++] = fabs(residual_px[i]);
    }
  }
  double spread = 1.4826 * placido_quantile(r->work, n, 0.5);
  r->sigma_px = fmax(SIGMA_MIN_PX, fmin(SIGMA_MAX_PX, spread));
}

/* One step down, with as much damping as it needs. Sets *fell to the relative fall of the cost. */
static int descend(placido_refinement *r, double *step, double *fell, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  double before = cost(r), damping = 0;
  placido_refinement_assemble(r);
  *fell = 0;
  for (int attempt = 0; attempt < 8; attempt++) {
    int status = placido_normal_solve(r->normal, damping, step, err);
    r->damped = damping > 0;
    if (status) {
      return status;
    }
    for (size_t i = 0; i < n; i++) {
      r->coefficients[i] += step[i];
    }
    trace(r);
    double after = cost(r);
    if (after <= before * (1 + ROUNDING)) {
      *fell = (before - after) / before;
      return PLACIDO_OK;
    }
    for (size_t i = 0; i < n; i++) {
      r->coefficients[i] -= step[i];
    }
    damping = damping > 0 ? damping * 10 : 1e-3;
  }
  trace(r);
  return PLACIDO_OK;
}

void placido_refinement_trace(placido_refinement *r) {
  placido_sightlines_hear(r->rays);
  if (!r->traced) {
    trace(r);
    r->traced = true;
  }
  placido_sightlines_tell(r->rays);
}

int placido_refinement_run(placido_refinement *r, double settled, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  double *step = placido_memory_new(n, sizeof *step, err);
  int status = step ? PLACIDO_OK : PLACIDO_MEMORY;
  double fell = 1, next = 1; /* of the cost in a step, and what is expected of one more */
  placido_sightlines_hear(r->rays);
  if (!r->traced) {
    trace(r);
    r->traced = true;
  }
  for (int i = 0; i < r->steps_max && !status; i++, r->steps++) {
    double sigma_before = r->sigma_px;
    rescale(r);
    bool same_unit = fabs(r->sigma_px / sigma_before - 1) < 0.03;
    if (same_unit && fmin(fell, next) < settled) {
      break;
    }
    double before = fell;
    status = descend(r, step, &fell, err);
    next = fell * (fell < NEAR ? fmax(RATE, i > 0 ? fell / before : 0) : 1);
  }
  placido_sightlines_tell(r->rays);
  if (!status && !(fmin(fell, next) < 10 * settled)) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "the surface did not settle within %d steps", r->steps_max);
  }
  if (!status && r->damped) {
    /* a damped factor would make error bars of it that are far too small */
    status = placido_normal_solve(r->normal, 0, step, err);
    r->damped = false;
  }
  placido_memory_free(step);
  return status;
}

void placido_refinement_tell(placido_refinement *r) {
  if (!r->told) {
    placido_sightlines_tell_all(r->rays, &r->shape, r->threads);
    r->told = true;
  }
}
