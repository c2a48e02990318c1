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

/* Fills `step` with a draw from the noise's covariance, `scale` times as large: with the factor of
 * the normal equations, which the scatter makes larger here and smaller there, and what whole edges
 * have in common, which has a stream of its own. */
static int draw(double *step, const placido_fit *fit, uint64_t stream, uint64_t common_stream,
                double scale, placido_error *err) {
  const placido_scatter *scatter = &fit->scatter;
  size_t n = unknowns(fit);
  for (size_t i = 0; i < n; i++) {
    step[i] = scale * placido_random_normal(SEED, stream, i);
  }
  int status = placido_normal_draw(fit->normal, step, 1, step, err);
  for (size_t i = 0; i < n && !status; i++) {
    step[i] *= scatter->spread[i];
  }
  for (int k = 0; k < scatter->steps && !status; k++) {
    const double *common = scatter->step + (size_t)k * n;
    double amount = scale * placido_random_normal(SEED, common_stream, (uint64_t)k);
    for (size_t i = 0; i < n; i++) {
      step[i] += amount * common[i];
    }
  }
  return status;
}

static void add(double *step, const placido_fit *fit, const double *from, double factor) {
  for (size_t i = 0; i < unknowns(fit); i++) {
    step[i] += factor * from[i];
  }
}

static const double *mode_of(const placido_fit *fit, int mode) {
  return fit->modes + (size_t)mode * unknowns(fit);
}

/* The variant's step of the coefficients, in mm of z; `step` is zero. */
static int step_of(double *step, const placido_fit *fit, int variant, placido_error *err) {
  switch (placido_fit_variant_source(fit, variant)) {
  case PLACIDO_SIGMA_NOISE:
    return draw(step, fit, (uint64_t)variant, PLACIDO_NOISE_VARIANTS + (uint64_t)variant,
                sqrt(1.0 / PLACIDO_NOISE_VARIANTS), err);
  case PLACIDO_SIGMA_DISTANCE:
    add(step, fit, fit->by_distance, fit->axis_z_sigma_mm);
    return PLACIDO_OK;
  default:
    add(step, fit, mode_of(fit, variant - PLACIDO_NOISE_VARIANTS - 1), 1);
    return PLACIDO_OK;
  }
}

/* All sources together, each by a normal amount; `step` is zero. Streams beyond the variants'. */
static int draw_all(double *step, const placido_fit *fit, int number, placido_error *err) {
  uint64_t stream = 2 * PLACIDO_NOISE_VARIANTS + 3 * (uint64_t)number;
  int status = draw(step, fit, stream, stream + 1, 1, err);
  add(step, fit, fit->by_distance,
      fit->axis_z_sigma_mm * placido_random_normal(SEED, stream + 2, 0));
  for (int m = 0; m < fit->mode_count; m++) {
    add(step, fit, mode_of(fit, m), placido_random_normal(SEED, stream + 2, 1 + (uint64_t)m));
  }
  return status;
}

/* The surface moved by the variant or, where `drawn`, by the draw of that number. */
static int move(placido_surface **surface, const placido_fit *fit, bool drawn, int number,
                placido_error *err) {
  *surface = NULL;
  size_t n = unknowns(fit);
  double *change = placido_memory_new(n, sizeof *change, err);
  int status = !change ? PLACIDO_MEMORY
               : drawn ? draw_all(change, fit, number, err)
                       : step_of(change, fit, number, err);
  for (size_t i = 0; i < n && !status; i++) {
    change[i] = -change[i]; /* the file holds sags */
  }
  if (!status) {
    status = placido_surface_bend(surface, fit->surface, change, err);
  }
  placido_memory_free(change);
  return status;
}

int placido_fit_variant(placido_surface **surface, const placido_fit *fit, int variant,
                        placido_error *err) {
  return move(surface, fit, false, variant, err);
}

int placido_fit_draw(placido_surface **surface, const placido_fit *fit, int number,
                     placido_error *err) {
  return move(surface, fit, true, number, err);
}

int placido_fit_moved(placido_surface **surface, const placido_fit *fit, double distance_mm,
                      placido_error *err) {
  *surface = NULL;
  double *change = placido_memory_new(unknowns(fit), sizeof *change, err);
  if (!change) {
    return PLACIDO_MEMORY;
  }
  add(change, fit, fit->by_distance, -distance_mm); /* of the sag */
  int status = placido_surface_bend(surface, fit->surface, change, err);
  placido_memory_free(change);
  return status;
}
