/* Motion-JPEG pictures to luma, where this build has FFmpeg. */
#ifndef PLACIDO_DRIVERS_V4L2_MJPEG_H
#define PLACIDO_DRIVERS_V4L2_MJPEG_H

#include "drivers/v4l2/convert.h"

#include <placido/frame.h>
#include <placido/status.h>
#include <stdbool.h>

typedef struct placido_v4l2_mjpeg placido_v4l2_mjpeg;

/* Whether pictures of the format can be made into frames by this build. */
bool placido_v4l2_is_readable(const placido_v4l2_format *format);

/* A decoder for pictures of one size; free with placido_v4l2_mjpeg_free. Returns PLACIDO_OK,
 * PLACIDO_MEMORY, PLACIDO_UNSUPPORTED. */
int placido_v4l2_mjpeg_new(placido_v4l2_mjpeg **decoder, int width_px, int height_px,
                           placido_error *err);
void placido_v4l2_mjpeg_free(placido_v4l2_mjpeg *decoder);

/* One picture's luma Y' (0 to 255) as a MONO8 frame. Returns PLACIDO_OK, PLACIDO_INPUT (damaged, or
 * of another size), PLACIDO_MEMORY. */
int placido_v4l2_mjpeg_decode(placido_v4l2_mjpeg *decoder, placido_frame *frame,
                              const uint8_t *bytes, size_t size, placido_error *err);

#endif
