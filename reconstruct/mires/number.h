/* Which edge of the instrument each chain is. */
#ifndef PLACIDO_MIRES_NUMBER_H
#define PLACIDO_MIRES_NUMBER_H

#include "reconstruct/mires/link.h"

#include <placido/instrument.h>

/* Numbers the chains from the innermost edge outwards and gives every crossing its chain's number;
 * what cannot be numbered stays -1. `expected_px` are the edges' radii in an ordinary cornea.
 * PLACIDO_QUALITY where the innermost edge is not seen: without it no number is safe. */
int placido_chains_number(placido_chains *chains, placido_crossings *crossings,
                          const placido_instrument *instrument, const double *expected_px,
                          placido_error *err);

#endif
