/* Frame to grey plane; colour planes compete by the energy of their unclipped gradients, times the
 * share of the plane that is not clipped: next to clipped samples edges are out of place. */
#include "reconstruct/mires/plane.h"

#include <stdbool.h>

#define CLIPPED 0.99F

static float sample(const placido_frame *frame, int x, int y, int channel) {
  const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  return (float)row[3 * x + channel] / 255;
}

/* Mean squared difference over 2 px along u and v where no sample is clipped, on every fourth row,
 * times the share of the plane that is not. */
static double contrast(const placido_frame *frame, int channel) {
  double sum = 0, open = 0, all = 0;
  for (int y = 2; y < frame->height_px; y += 4) {
    for (int x = 2; x < frame->width_px; x++) {
      float here = sample(frame, x, y, channel);
      all++;
      if (here < CLIPPED) {
        open++;
        float across = here - sample(frame, x - 2, y, channel);
        float down = here - sample(frame, x, y - 2, channel);
        sum += (double)(across * across + down * down);
      }
    }
  }
  return all > 0 ? sum * open / (all * all) : 0;
}

static int best_channel(const placido_frame *frame) {
  int channel = 0;
  double best = -1;
  for (int c = 0; c < 3; c++) {
    double here = contrast(frame, c);
    if (here > best) {
      best = here;
      channel = c;
    }
  }
  return channel;
}

static void copy_bytes(float *out, const uint8_t *in, int count, int pitch, float scale) {
  for (int x = 0; x < count; x++) {
    out[x] = (float)in[x * pitch] * scale;
  }
}

static void copy_words(float *out, const uint16_t *in, int count, float scale) {
  for (int x = 0; x < count; x++) {
    out[x] = (float)in[x] * scale;
  }
}

int placido_mires_plane(placido_image *plane, const placido_frame *frame, placido_error *err) {
  int status = placido_image_new(plane, frame->width_px, frame->height_px, 1, err);
  if (status) {
    return status;
  }
  bool wide = frame->format == PLACIDO_MONO16;
  int pitch = frame->format == PLACIDO_RGB8 ? 3 : 1;
  int channel = pitch == 3 ? best_channel(frame) : 0;
  float scale = wide ? 1.0F / (float)((1u << frame->bits) - 1) : 1.0F / 255;
  for (int y = 0; y < frame->height_px; y++) {
    float *out = plane->data + (size_t)y * (size_t)frame->width_px;
    const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    if (wide) {
      copy_words(out, (const uint16_t *)(const void *)row, frame->width_px, scale);
    } else if (pitch == 1) {
      copy_bytes(out, row, frame->width_px, 1, scale);
    } else {
      copy_bytes(out, row + channel, frame->width_px, 3, scale);
    }
  }
  return PLACIDO_OK;
}
