/* What the geometry's uncertainty explains of the residuals. */
#ifndef PLACIDO_SOLVE_EXPLAIN_H
#define PLACIDO_SOLVE_EXPLAIN_H

#include "reconstruct/solve/geometry.h"

/* Factor on the variance that the normal matrix's inverse gives: placido_noise_inflation of what
 * the modes of `moves` (may be NULL) leave of the residuals, times the share of the residuals'
 * variance that they leave. Spends moves->change. */
int placido_noise_scale(double *scale, const placido_refinement *r, const placido_mires *mires,
                        placido_moves *moves, placido_error *err);

#endif
