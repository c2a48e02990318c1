/* Where the cornea mirrors the mires more than once: nothing seen there tells its shape. */
#ifndef PLACIDO_SOLVE_FOLD_H
#define PLACIDO_SOLVE_FOLD_H

#include "reconstruct/solve/doubt/mask.h"

/* The places of folds, from traced and told samples: where a point's mires say so, and where the
 * surface itself is hollow or steeper than any cornea is, for that is how it answers to a fold.
 * `places` has room for `count`. Returns how many there are; fewer than a handful are none. */
size_t placido_fold_find(placido_place *places, const placido_sample *samples, size_t count,
                         const placido_mires *mires);

#define PLACIDO_FOLD_REACH_MM 0.5 /* about a fold; knots carry its error so far */

/* Takes from a coverage's mask what lies within reach of the places. Returns the share of the
 * covered area that went. */
double placido_fold_mask(placido_coverage *coverage, unsigned char *mask,
                         const placido_place *places, size_t count, double reach_mm);

/* The area of the coverage's holes that are shut in all round. Lashes, nose and lid hide what is
 * connected with the outside; a fold leaves a hole in the middle. `area_mm2` receives it. Returns
 * PLACIDO_OK or PLACIDO_MEMORY. */
int placido_fold_hole(double *area_mm2, const placido_coverage *coverage, const unsigned char *mask,
                      placido_error *err);

#endif
