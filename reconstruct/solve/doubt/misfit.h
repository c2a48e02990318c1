/* Where the surface does not follow the cornea: a steep cone is a small part of the points, whose
 * spread as a whole does not tell of it. */
#ifndef PLACIDO_SOLVE_MISFIT_H
#define PLACIDO_SOLVE_MISFIT_H

#include "reconstruct/solve/doubt/mask.h"
#include "reconstruct/solve/engine/shape.h"

/* A spread over the noise of the same place that no noise makes: of PLACIDO_MISFIT_POINTS points
 * either is known to 18 %, their ratio to 25 %, and four standard deviations of it are less than
 * once in any of a map's hundred places. */
#define PLACIDO_MISFIT_LOCAL 2.0
#define PLACIDO_MISFIT_POINTS 40

/* The largest ratio, over squares of 1 mm of the cornea, of the residuals' robust spread to that of
 * their differences from one point to the next on an edge, which only noise makes; at most `stride`
 * meridians lie between the two. Squares with fewer points tell nothing; without any it is 0.
 * `place` (may be NULL) is the middle of that square.
 * PLACIDO_OK or PLACIDO_MEMORY. */
int placido_misfit_worst(double *worst, placido_place *place, const placido_sample *samples, size_t count,
                         const placido_mires *mires, int stride, placido_error *err);

#endif
