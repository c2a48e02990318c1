/* A spline carried over to other knots: where a finer fit starts. */
#ifndef PLACIDO_SOLVE_PROLONG_H
#define PLACIDO_SOLVE_PROLONG_H

#include "reconstruct/solve/engine/spline.h"

#include <placido/status.h>

/* Coefficients of `to` (side × side, the caller's) for the spline on `from` with its coefficients,
 * of the same degree: exact for polynomials of that degree, and near enough for a start elsewhere.
 * Beyond the square of `from` its rim goes on. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_grid_prolong(double *coefficients, const placido_grid *to, const double *known,
                         const placido_grid *from, placido_error *err);

#endif
