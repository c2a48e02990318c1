/* The mires' light in every pixel. */
#ifndef PLACIDO_PHANTOM_LIGHT_H
#define PLACIDO_PHANTOM_LIGHT_H

#include "phantom/trace.h"

#include <placido/image.h>

/* Fills `light`, one plane of the instrument's image size, with the lit share of each pixel, 0 to
 * 1, from subsamples × subsamples rays where an edge crosses the pixel. */
int placido_phantom_light(placido_image *light, const placido_phantom_rig *rig, int subsamples,
                          int threads, placido_error *err);

/* How many threads to work with where the caller asked for `threads` (0 or less: all there are). */
int placido_phantom_threads(int threads);

#endif
