/* The one grey plane in which the mires are looked for. */
#ifndef PLACIDO_MIRES_PLANE_H
#define PLACIDO_MIRES_PLANE_H

#include <placido/frame.h>
#include <placido/image.h>

/* Samples of the frame scaled to 0..1; of a colour frame the plane with the strongest fine
 * contrast that is not clipped, the less so the more of it is. `plane` is a new one-plane image. */
int placido_mires_plane(placido_image *plane, const placido_frame *frame, placido_error *err);

#endif
