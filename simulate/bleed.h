/* What lies around the part of a picture that is shown: it spreads its light into it. */
#ifndef PLACIDO_SIMULATE_BLEED_H
#define PLACIDO_SIMULATE_BLEED_H

#include <placido/image.h>
#include <placido/status.h>

/* A copy with `more_px` on every side, in which the rim's samples go on outwards. Free with
 * placido_image_free. Returns PLACIDO_OK, PLACIDO_INPUT (too large), PLACIDO_MEMORY. */
int placido_bleed_widen(placido_image *wide, const placido_image *image, int more_px,
                        placido_error *err);

/* Cuts `bleed_px` off every side: moves every row to its place and keeps the memory. */
void placido_bleed_cut(placido_image *image, int bleed_px);

#endif
