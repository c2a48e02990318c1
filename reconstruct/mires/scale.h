/* Standard deviations held against how much the edges really waver. */
#ifndef PLACIDO_MIRES_SCALE_H
#define PLACIDO_MIRES_SCALE_H

#include "reconstruct/mires/tracks.h"

/* Scales sigma_px of the numbered crossings, sector by sector and some edges at a time, so that the
 * fourth differences of the radius along the edges are as large as they say. That covers what a
 * profile alone does not show: neighbours that overlap, noise that is not white, pixels that were
 * sampled coarsely. */
int placido_crossings_scale(placido_crossings *crossings, const placido_tracks *tracks,
                            placido_error *err);

#endif
