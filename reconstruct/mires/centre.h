/* The point about which the mires run. */
#ifndef PLACIDO_MIRES_CENTRE_H
#define PLACIDO_MIRES_CENTRE_H

#include <placido/image.h>

/* Finds the centre from the gradients' lines, which all pass near it. `radius_px` is about how far
 * the mires reach, `inner_px` about how far the innermost few do: the centre is theirs, `narrow_px`
 * about the distance between two edges. PLACIDO_QUALITY where the image has no structure that runs
 * about a point. */
int placido_mires_centre(double centre_px[2], const placido_image *plane, double radius_px,
                         double inner_px, double narrow_px, placido_error *err);

#endif
