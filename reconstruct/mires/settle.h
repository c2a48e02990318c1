/* Numbers held against each other over the whole image. */
#ifndef PLACIDO_MIRES_SETTLE_H
#define PLACIDO_MIRES_SETTLE_H

#include "reconstruct/mires/link.h"

/* Keeps the numbers that hang together with the innermost mires', edge by edge and sector by
 * sector; from them foretells where each edge is on every meridian and numbers what lies there
 * anew, also what no chain had reached; and so on until nothing changes. `ordinary_px`: the
 * edges' radii in an ordinary cornea, NaN where not mirrored. */
int placido_crossings_settle(placido_crossings *crossings, const placido_chains *chains,
                             int edge_count, bool first_rises, const double *ordinary_px,
                             placido_error *err);

#endif
