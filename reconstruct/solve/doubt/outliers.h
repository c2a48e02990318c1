/* Edge points that do not lie where the fitted surface says, and what that means. */
#ifndef PLACIDO_SOLVE_OUTLIERS_H
#define PLACIDO_SOLVE_OUTLIERS_H

#include "reconstruct/solve/engine/shape.h"

#include <placido/notes.h>

/* Takes points that stray from their edge out of use, with their neighbours along it, and takes
 * those back that do so no longer. `work` holds `count` numbers; samples are ordered by edge, then
 * meridian. `changed` tells whether any point's use changed, `cut` how many are out of use. */
int placido_outliers_cut(placido_sample *samples, size_t count, double *work, size_t *cut,
                         bool *changed, placido_error *err);

/* Says how well the mires agree with any smooth cornea under this instrument: refuses what is
 * absurd (PLACIDO_QUALITY), warns of what noise cannot explain. */
int placido_outliers_judge(const placido_sample *samples, size_t count,
                           const placido_mires *mires, double *work, placido_notes *notes,
                           placido_error *err);

#endif
