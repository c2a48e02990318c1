/* Whether the numbers reach the last edge. */
#ifndef PLACIDO_MIRES_OUTERMOST_H
#define PLACIDO_MIRES_OUTERMOST_H

#include "reconstruct/mires/edges.h"

/* Numbers that are off by a whole mire everywhere fit a smooth cornea, too: a steep one whose
 * innermost mire is hidden looks ordinary. But then the last mires are missing all round.
 * PLACIDO_QUALITY where nearly every meridian ends with the same edge, whole mires short of the
 * last, although the image and the cornea go on and it is quiet there; `reach_px` is how far an
 * ordinary cornea shows the mires. */
int placido_crossings_outermost(const placido_crossings *crossings, int edge_count,
                                const double centre_px[2], int width_px, int height_px,
                                double reach_px, placido_error *err);

#endif
