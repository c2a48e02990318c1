/* Places where most of what was seen was set aside. */
#ifndef PLACIDO_SOLVE_CONTRADICT_H
#define PLACIDO_SOLVE_CONTRADICT_H

#include "reconstruct/solve/doubt/mask.h"

/* The places of the samples that were set aside where more of the samples about were than were not,
 * into room for `count`, and how many these are. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_contradict_find(placido_place *places, size_t *found, const placido_sample *samples,
                            size_t count, placido_error *err);

#endif
