/* The pull of the blur on curved edges, as far as its correction leaves it open. */
#ifndef PLACIDO_SOLVE_PULL_H
#define PLACIDO_SOLVE_PULL_H

#include "reconstruct/solve/engine/refine.h"

#define PLACIDO_PULLS 4

/* For every sample PLACIDO_PULLS possible errors of one standard deviation, in sigmas of the
 * sample. Blur reaches as far along an edge as it does across: `kin_px` (noise.h) tells how large
 * they are. `pulls` has room for all; at first it serves as a workspace. */
void placido_pulls_find(double *pulls, const placido_refinement *r, const placido_mires *mires,
                        double kin_px);

#endif
