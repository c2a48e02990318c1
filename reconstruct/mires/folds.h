/* Where the cornea folds the mires, as the image's topology shows it. */
#ifndef PLACIDO_MIRES_FOLDS_H
#define PLACIDO_MIRES_FOLDS_H

#include "reconstruct/mires/edges.h"

/* Sets `folded` of the numbered crossings that lie in a fold. Two signs must meet on a meridian or
 * beside it: edges crowded to less than half of what is usual between them, and strong edges among
 * the numbered ones that have no number, as those of loops which do not run round the centre. One
 * alone is a steep cone, or a lash. `*folded` receives the share of the meridians with both signs,
 * `*stray` of those with the second. */
int placido_crossings_folds(placido_crossings *crossings, int edge_count, double *folded,
                            double *stray, placido_error *err);

#endif
