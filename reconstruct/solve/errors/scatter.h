/* How much more a smooth surface scatters than the normal equations say: they take the edge points'
 * errors for independent and alike everywhere, and neither is so. */
#ifndef PLACIDO_SOLVE_SCATTER_H
#define PLACIDO_SOLVE_SCATTER_H

#include "reconstruct/solve/engine/refine.h"

/* The covariance of the coefficients c from the edge points' noise is
 *   C(i, j) = spread(i) · inverse(i, j) · spread(j) + Σ step(i) · step(j)
 * over the steps, which the common errors of whole edges cause. */
typedef struct placido_scatter {
  double *spread; /* one factor a coefficient, from the points about its place */
  int steps;
  double *step; /* step by step, all coefficients */
} placido_scatter;

/* From a refinement's end. `residual_px` are the samples' residuals less what other causes explain,
 * `kin_px` the distance along an edge over which points err alike (noise.h), `inverse` that of the
 * refinement's normal matrix. Samples are ordered by edge, then meridian. Free with
 * placido_scatter_free. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_scatter_find(placido_scatter *scatter, const placido_refinement *r,
                         const placido_mires *mires, const double *residual_px, double kin_px,
                         const double *inverse, placido_error *err);
void placido_scatter_free(placido_scatter *scatter);

#endif
