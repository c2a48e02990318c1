/* A build without FFmpeg: Motion-JPEG is refused. */
#include "drivers/v4l2/mjpeg.h"

bool placido_v4l2_is_readable(const placido_v4l2_format *format) {
  return format->unpack != NULL;
}

int placido_v4l2_mjpeg_new(placido_v4l2_mjpeg **decoder, int width_px, int height_px,
                           placido_error *err) {
  (void)width_px;
  (void)height_px;
  *decoder = NULL;
  return placido_error_set(err, PLACIDO_UNSUPPORTED, "this build cannot decode Motion-JPEG");
}

void placido_v4l2_mjpeg_free(placido_v4l2_mjpeg *decoder) {
  (void)decoder;
}

int placido_v4l2_mjpeg_decode(placido_v4l2_mjpeg *decoder, placido_frame *frame,
                              const uint8_t *bytes, size_t size, placido_error *err) {
  (void)decoder;
  (void)frame;
  (void)bytes;
  (void)size;
  return placido_error_set(err, PLACIDO_UNSUPPORTED, "this build cannot decode Motion-JPEG");
}
