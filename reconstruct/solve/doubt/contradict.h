/* Places where most of what was seen was set aside. */
#ifndef PLACIDO_SOLVE_CONTRADICT_H
#define PLACIDO_SOLVE_CONTRADICT_H

#include "reconstruct/solve/doubt/mask.h"

#define PLACIDO_CONTRADICT_REACH_MM                                                                \
  0.25 /* about such a place; what was set aside pulls at nothing */

/* The places of the samples that were set aside for being off the surface where more of the samples
 * about are so than are not, into room for `count`, and how many these are. `sigma_px` is the
 * standard deviation of a point. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_contradict_find(placido_place *places, size_t *found, const placido_sample *samples,
                            size_t count, double sigma_px, placido_error *err);

#endif
