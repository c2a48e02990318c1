/* What the geometry's uncertainty explains of the residuals. */
#ifndef PLACIDO_SOLVE_EXPLAIN_H
#define PLACIDO_SOLVE_EXPLAIN_H

#include "reconstruct/solve/errors/geometry.h"

/* Leaves in r->work the samples' residuals in px less what the modes of `moves` (may be NULL)
 * explain of them. Spends moves->change. */
int placido_residuals_explain(const placido_refinement *r, const placido_mires *mires,
                              placido_moves *moves, placido_error *err);

#endif
