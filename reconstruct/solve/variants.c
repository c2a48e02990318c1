/* The covariance as steps: the noise's as draws with the factor of the normal equations, distance
 * and geometry by the derivative of the solution. */
#include "base/memory.h"
#include "base/random.h"
#include "reconstruct/solve/result.h"
#include "reconstruct/surface/surface.h"

#include <math.h>

#define SEED 1 /* any number: the draws need only be the same every time */

static size_t unknowns(const placido_fit *fit) {
  return (size_t)fit->grid.side * (size_t)fit->grid.side;
}

int placido_fit_variants_draw(placido_fit *fit, placido_error *err) {
  const placido_scatter *scatter = &fit->scatter;
  size_t n = unknowns(fit), numbers = n * PLACIDO_NOISE_VARIANTS;
  double scale = sqrt(1.0 / PLACIDO_NOISE_VARIANTS);
  double *draws = fit->draws = placido_memory_new(numbers, sizeof *draws, err);
  if (!draws) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < numbers; i++) {
    draws[i] = scale * placido_random_normal(SEED, i / n, i % n);
  }
  int status = placido_normal_draw(fit->normal, draws, PLACIDO_NOISE_VARIANTS, draws, err);
  for (size_t i = 0; i < numbers && !status; i++) {
    draws[i] *= scatter->spread[i % n];
  }
  for (int k = 0; k < PLACIDO_NOISE_VARIANTS * scatter->steps && !status; k++) {
    size_t draw = (size_t)(k / scatter->steps), step = (size_t)(k % scatter->steps);
    double amount = scale * placido_random_normal(SEED, PLACIDO_NOISE_VARIANTS + draw, step);
    for (size_t i = 0; i < n; i++) {
      draws[draw * n + i] += amount * scatter->step[step * n + i];
    }
  }
  return status;
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

/* The variant's step of the coefficients is this times its factor, in mm of z. */
static const double *step_of(const placido_fit *fit, int variant, double *factor) {
  *factor = 1;
  switch (placido_fit_variant_source(fit, variant)) {
  case PLACIDO_SIGMA_NOISE:
    return fit->draws + (size_t)variant * unknowns(fit);
  case PLACIDO_SIGMA_DISTANCE:
    *factor = fit->axis_z_sigma_mm;
    return fit->by_distance;
  default:
    return fit->modes + (size_t)(variant - PLACIDO_NOISE_VARIANTS - 1) * unknowns(fit);
  }
}

int placido_fit_variant(placido_surface **surface, const placido_fit *fit, int variant,
                        placido_error *err) {
  *surface = NULL;
  size_t n = unknowns(fit);
  double factor, *change = placido_memory_new(n, sizeof *change, err);
  if (!change) {
    return PLACIDO_MEMORY;
  }
  const double *step = step_of(fit, variant, &factor);
  for (size_t i = 0; i < n; i++) {
    change[i] = -factor * step[i]; /* the file holds sags */
  }
  int status = placido_surface_bend(surface, fit->surface, change, err);
  placido_memory_free(change);
  return status;
}
