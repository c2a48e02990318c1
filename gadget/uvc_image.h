/* What the simulated UVC camera makes of the picture that it sees. */
#ifndef PLACIDO_GADGET_UVC_IMAGE_H
#define PLACIDO_GADGET_UVC_IMAGE_H

#include "gadget/uvc_descriptors.h"

#include <placido/frame.h>

/* Writes the picture of a mode; `image` has placido_uvc_picture_bytes. `seen` is MONO8 or MONO16
 * and at least as large as the size, or twice that where it is binned. `levels` is what becomes of
 * each grey level; NULL: nothing. */
void placido_uvc_image_make(uint8_t *image, const placido_frame *seen,
                            const placido_uvc_size *size, enum placido_uvc_format format,
                            const uint8_t levels[256]);

/* Levels by exposure (of the 100 at which the view is taken), gain (16 is one) and brightness. */
void placido_uvc_levels_make(uint8_t levels[256], int exposure, int gain, int brightness);

#endif
