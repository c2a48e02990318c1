/* The covariance as steps: the noise's as draws with the factor of the normal equations, distance
 * and geometry by the derivative of the solution. */
#include "base/memory.h"
#include "base/random.h"
#include "reconstruct/solve/errors/result.h"
#include "reconstruct/surface/surface.h"

#include <math.h>

#define SEED 1 /* any number: the draws need only be the same every time */

static size_t unknowns(const placido_fit *fit) {
  return (size_t)fit->grid.side * (size_t)fit->grid.side;
}

int placido_fit_variant_count(const placido_fit *fit) {
  return PLACIDO_NOISE_VARIANTS + 1 + fit->mode_count;
}

enum placido_sigma_source placido_fit_variant_source(const placido_fit *fit, int variant) {
  (void)fit;
  return variant < PLACIDO_NOISE_VARIANTS    ? PLACIDO_SIGMA_NOISE
         : variant == PLACIDO_NOISE_VARIANTS ? PLACIDO_SIGMA_DISTANCE
                                             : PLACIDO_SIGMA_GEOMETRY;
}

/* One draw of the noise, of PLACIDO_NOISE_VARIANTS: with the factor of the normal equations, which
 * the scatter makes larger here and smaller there, and what whole edges have in common. */
static int draw(double *step, const placido_fit *fit, int variant, placido_error *err) {
  const placido_scatter *scatter = &fit->scatter;
  size_t n = unknowns(fit);
  uint64_t stream = (uint64_t)variant;
  double scale = sqrt(1.0 / PLACIDO_NOISE_VARIANTS);
  for (size_t i = 0; i < n; i++) {
    step[i] = scale * placido_random_normal(SEED, stream, i);
  }
  int status = placido_normal_draw(fit->normal, step, 1, step, err);
  for (size_t i = 0; i < n && !status; i++) {
    step[i] *= scatter->spread[i];
  }
  for (int k = 0; k < scatter->steps && !status; k++) {
    const double *common = scatter->step + (size_t)k * n;
    double amount =
        scale * placido_random_normal(SEED, PLACIDO_NOISE_VARIANTS + stream, (uint64_t)k);
    for (size_t i = 0; i < n; i++) {
      step[i] += amount * common[i];
    }
  }
  return status;
}

static void copy(double *step, const placido_fit *fit, const double *from, double factor) {
  for (size_t i = 0; i < unknowns(fit); i++) {
    step[i] = factor * from[i];
  }
}

/* The variant's step of the coefficients, in mm of z. */
static int step_of(double *step, const placido_fit *fit, int variant, placido_error *err) {
  switch (placido_fit_variant_source(fit, variant)) {
  case PLACIDO_SIGMA_NOISE:
    return draw(step, fit, variant, err);
  case PLACIDO_SIGMA_DISTANCE:
    copy(step, fit, fit->by_distance, fit->axis_z_sigma_mm);
    return PLACIDO_OK;
  default:
    copy(step, fit,
         fit->modes + (size_t)(variant - PLACIDO_NOISE_VARIANTS - 1) * unknowns(fit), 1);
    return PLACIDO_OK;
  }
}

int placido_fit_variant(placido_surface **surface, const placido_fit *fit, int variant,
                        placido_error *err) {
  *surface = NULL;
  size_t n = unknowns(fit);
  double *change = placido_memory_new(n, sizeof *change, err);
  int status = change ? step_of(change, fit, variant, err) : PLACIDO_MEMORY;
  for (size_t i = 0; i < n && !status; i++) {
    change[i] = -change[i]; /* the file holds sags */
  }
  if (!status) {
    status = placido_surface_bend(surface, fit->surface, change, err);
  }
  placido_memory_free(change);
  return status;
}
