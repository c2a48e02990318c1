/* Everything that touches a frame's memory: the rest of the guide works on small arrays. */
#include "acquire/guide/view.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846
#define CONTRAST_STEP 4 /* every so manieth pixel tells which plane is the best */
#define CLIPPING_STEP 3

static int sample_at(const placido_guide_view *view, int x, int y) {
  const placido_frame *frame = view->frame;
  const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  if (frame->format == PLACIDO_MONO16) {
    return ((const uint16_t *)(const void *)row)[x];
  }
  return frame->format == PLACIDO_RGB8 ? row[3 * (size_t)x + view->channel] : row[x];
}

/* In the middle of the picture. */
static long contrast_of(const placido_guide_view *view) {
  const int width = view->frame->width_px, height = view->frame->height_px;
  long sum = 0;
  for (int y = 3 * height / 8; y < 5 * height / 8; y += CONTRAST_STEP) {
    for (int x = 3 * width / 8 + CONTRAST_STEP; x < 5 * width / 8; x += CONTRAST_STEP) {
      sum += abs(sample_at(view, x, y) - sample_at(view, x - CONTRAST_STEP, y));
    }
  }
  return sum;
}

placido_guide_view placido_guide_view_of(const placido_frame *frame) {
  placido_guide_view view = {.frame = frame, .white = (1 << frame->bits) - 1};
  if (frame->format != PLACIDO_RGB8) {
    return view;
  }
  size_t best = 0;
  long most = -1;
  for (view.channel = 0; view.channel < 3; view.channel++) {
    const long contrast = contrast_of(&view);
    if (contrast > most) {
      best = view.channel;
      most = contrast;
    }
  }
  view.channel = best;
  return view;
}

/* Sums of `bin` neighbours each of a row of bytes. */
static inline void add_bytes(float *sums, const uint8_t *row, int bin, int width) {
  for (int x = 0; x < width; x++) {
    int sum = 0;
    for (int i = 0; i < bin; i++) {
      sum += row[i];
    }
    row += bin;
    sums[x] += (float)sum;
  }
}

/* Adds a row of the frame to the sums of its bins. Bytes by twos or fours are what a camera of a
 * megapixel gives: with the number known the loop is three times as fast. */
static void add_row(float *sums, const placido_guide_view *view, int y, int bin, int width) {
  const placido_frame *frame = view->frame;
  const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  if (frame->format == PLACIDO_MONO8 && bin == 2) {
    add_bytes(sums, row, 2, width);
  } else if (frame->format == PLACIDO_MONO8 && bin == 4) {
    add_bytes(sums, row, 4, width);
  } else {
    for (int x = 0; x < width; x++) {
      int sum = 0;
      for (int i = 0; i < bin; i++) {
        sum += sample_at(view, x * bin + i, y);
      }
      sums[x] += (float)sum;
    }
  }
}

void placido_guide_view_shrink(float *small, const placido_guide_view *view, int bin) {
  const int width = view->frame->width_px / bin, height = view->frame->height_px / bin;
  const float scale = 1.0F / ((float)view->white * (float)(bin * bin));
  for (int y = 0; y < height; y++) {
    float *row = small + (size_t)y * (size_t)width;
    for (int x = 0; x < width; x++) {
      row[x] = 0;
    }
    for (int i = 0; i < bin; i++) {
      add_row(row, view, y * bin + i, bin, width);
    }
    for (int x = 0; x < width; x++) {
      row[x] *= scale;
    }
  }
}

/* Bilinear, in grey levels; PLACIDO_GUIDE_OUTSIDE beyond the picture. */
static float interpolate(const placido_guide_view *view, float u, float v) {
  if (!(u >= 0 && v >= 0 && u < (float)(view->frame->width_px - 1) &&
        v < (float)(view->frame->height_px - 1))) {
    return PLACIDO_GUIDE_OUTSIDE;
  }
  const int x = (int)u, y = (int)v;
  const float right = u - (float)x, down = v - (float)y;
  const float above = (float)sample_at(view, x, y) * (1 - right) +
                      (float)sample_at(view, x + 1, y) * right;
  const float below = (float)sample_at(view, x, y + 1) * (1 - right) +
                      (float)sample_at(view, x + 1, y + 1) * right;
  return above * (1 - down) + below * down;
}

void placido_guide_direction(double uv[2], int meridian) {
  const double angle = 2 * PI * meridian / PLACIDO_GUIDE_MERIDIANS;
  uv[0] = cos(angle);
  uv[1] = -sin(angle);
}

void placido_guide_polar_fill(placido_guide_polar *polar, const placido_guide_view *view,
                              int count) {
  const float scale = 1.0F / (3.0F * (float)view->white), step = (float)polar->step_px;
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    double along[2];
    placido_guide_direction(along, m);
    const float du = (float)along[0] * step, dv = (float)along[1] * step;
    float *row = polar->data + (size_t)m * (size_t)polar->samples;
    for (int i = 0; i < count; i++) {
      const float u = (float)polar->centre_px[0] + (float)i * du;
      const float v = (float)polar->centre_px[1] + (float)i * dv;
      const float left = interpolate(view, u - dv, v + du), middle = interpolate(view, u, v);
      const float right = interpolate(view, u + dv, v - du);
      const bool inside = left >= 0 && middle >= 0 && right >= 0;
      row[i] = inside ? scale * (left + middle + right) : PLACIDO_GUIDE_OUTSIDE;
    }
  }
}

placido_guide_clipping placido_guide_view_clipping(const placido_guide_view *view,
                                                   const double centre_px[2], double radius_px) {
  long black = 0, white = 0, all = 0;
  const int step = (int)fmax(CLIPPING_STEP, radius_px / 128);
  const int left = (int)fmax(0, centre_px[0] - radius_px);
  const int right = (int)fmin(view->frame->width_px - 1, centre_px[0] + radius_px);
  const int top = (int)fmax(0, centre_px[1] - radius_px);
  const int bottom = (int)fmin(view->frame->height_px - 1, centre_px[1] + radius_px);
  for (int y = top; y <= bottom; y += step) {
    for (int x = left; x <= right; x += step) {
      const double dx = x - centre_px[0], dy = y - centre_px[1];
      if (dx * dx + dy * dy < radius_px * radius_px) {
        const int sample = sample_at(view, x, y);
        black += sample <= 0;
        white += sample >= view->white;
        all++;
      }
    }
  }
  const double share = all > 0 ? 1.0 / (double)all : 0;
  return (placido_guide_clipping){share * (double)black, share * (double)white};
}
