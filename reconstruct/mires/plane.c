/* Frame to grey plane; colour planes compete by the energy of their unclipped gradients. */
#include "reconstruct/mires/plane.h"

#include <math.h>

static double sample(const placido_frame *frame, int x, int y, int channel) {
  const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  switch (frame->format) {
  case PLACIDO_MONO16:
    return ((const uint16_t *)(const void *)row)[x] / (double)((1u << frame->bits) - 1);
  case PLACIDO_RGB8:
    return row[3 * x + channel] / 255.0;
  default:
    return row[x] / 255.0;
  }
}

/* Sum of squared differences over 2 px along u and v where no sample is clipped, on every third
 * pixel of every third row. */
static double contrast(const placido_frame *frame, int channel) {
  double sum = 0;
  for (int y = 2; y < frame->height_px; y += 3) {
    for (int x = 2; x < frame->width_px; x += 3) {
      double here = sample(frame, x, y, channel);
      if (here < 0.99) {
        double across = here - sample(frame, x - 2, y, channel);
        double down = here - sample(frame, x, y - 2, channel);
        sum += across * across + down * down;
      }
    }
  }
  return sum;
}

int placido_mires_plane(placido_image *plane, const placido_frame *frame, placido_error *err) {
  int status = placido_image_new(plane, frame->width_px, frame->height_px, 1, err);
  if (status) {
    return status;
  }
  int channel = 0;
  if (frame->format == PLACIDO_RGB8) {
    double best = -1;
    for (int c = 0; c < 3; c++) {
      double here = contrast(frame, c);
      if (here > best) {
        best = here;
        channel = c;
      }
    }
  }
  for (int y = 0; y < frame->height_px; y++) {
    float *out = plane->data + (size_t)y * frame->width_px;
    for (int x = 0; x < frame->width_px; x++) {
      out[x] = (float)sample(frame, x, y, channel);
    }
  }
  return PLACIDO_OK;
}
