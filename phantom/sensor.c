/* From a picture in light to counts of a sensor. */
#include "phantom/sensor.h"

#include "base/memory.h"
#include "base/random.h"
#include "phantom/light.h"
#include "phantom/streams.h"

#include <math.h>

/* One tap of a motion kernel. */
typedef struct tap {
  int dx, dy;
  double weight;
} tap;

/* Spreads the segment over the pixel grid with bilinear weights. Points are taken in pairs about
 * the middle, so that the kernel is symmetric. Weights stand in a square of 2 reach + 1 a side. */
static void spread_segment(double *square, int reach, double length_px, double deg) {
  const double radian = deg / 57.29577951308232;
  const int pairs = 32 * (reach + 1), side = 2 * reach + 1;
  for (int i = 0; i < 2 * pairs; i++) {
    double t = length_px * ((i + 0.5) / (2.0 * pairs) - 0.5);
    double x = t * cos(radian) + reach, y = -t * sin(radian) + reach;
    int column = (int)floor(x), line = (int)floor(y);
    for (int k = 0; k < 4; k++) {
      int px = column + k % 2, py = line + k / 2;
      double weight = (1 - fabs(x - px)) * (1 - fabs(y - py));
      if (weight > 0 && px >= 0 && py >= 0 && px < side && py < side) {
        square[py * side + px] += weight / (2.0 * pairs);
      }
    }
  }
}

/* The non-zero taps of the kernel. `taps` has room for the whole square. */
static int list_taps(tap *taps, const double *square, int reach) {
  int count = 0, side = 2 * reach + 1;
  for (int i = 0; i < side * side; i++) {
    if (square[i] > 0) {
      taps[count++] = (tap){i % side - reach, i / side - reach, square[i]};
    }
  }
  return count;
}

static int clip(int value, int last) {
  return value < 0 ? 0 : value > last ? last : value;
}

static void filter_row(float *target, const placido_image *source, int y, const tap *taps,
                       int count) {
  int width = source->width_px;
  for (int x = 0; x < width; x++) {
    double sum = 0;
    for (int i = 0; i < count; i++) {
      int from_y = clip(y - taps[i].dy, source->height_px - 1);
      int from_x = clip(x - taps[i].dx, width - 1);
      sum += taps[i].weight * (double)source->data[(size_t)from_y * (size_t)width + (size_t)from_x];
    }
    target[(size_t)y * (size_t)width + (size_t)x] = (float)sum;
  }
}

int placido_phantom_sensor_move(placido_image *picture, double length_px, double deg, int threads,
                                placido_error *err) {
  int status = PLACIDO_MEMORY, reach = (int)ceil(length_px / 2) + 1;
  size_t side = 2 * (size_t)reach + 1;
  placido_image moved = {0};
  tap *taps = NULL;
  double *square = placido_memory_new(side * side, sizeof *square, err);
  if (!square) {
    goto done;
  }
  taps = placido_memory_new(side * side, sizeof *taps, err);
  if (!taps) {
    goto done;
  }
  status = placido_image_new(&moved, picture->width_px, picture->height_px, 1, err);
  if (status != PLACIDO_OK) {
    goto done;
  }
  spread_segment(square, reach, length_px, deg);
  int count = list_taps(taps, square, reach);
  threads = placido_phantom_threads(threads);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < picture->height_px; y++) {
    filter_row(moved.data, picture, y, taps, count);
  }
  placido_image swapped = *picture;
  *picture = moved;
  moved = swapped;
done:
  placido_image_free(&moved);
  placido_memory_free(taps);
  placido_memory_free(square);
  return status;
}

int placido_phantom_sensor_expose(placido_frame *frame, const placido_image *picture, double noise,
                                  int bits, uint64_t seed, uint64_t frame_number, int threads,
                                  placido_error *err) {
  int width = picture->width_px, height = picture->height_px;
  enum placido_format format = bits == 8 ? PLACIDO_MONO8 : PLACIDO_MONO16;
  int status = placido_frame_resize(frame, width, height, format, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  frame->bits = bits;
  const double full = (1 << bits) - 1;
  const uint64_t stream = PLACIDO_PHANTOM_NOISE + frame_number;
  threads = placido_phantom_threads(threads);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < height; y++) {
    uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    for (int x = 0; x < width; x++) {
      size_t pixel = (size_t)y * (size_t)width + (size_t)x;
      double grey = (double)picture->data[pixel];
      if (noise > 0) {
        grey += noise * placido_random_normal(seed, stream, pixel);
      }
      double count = floor(grey / 255 * full + 0.5);
      count = count < 0 ? 0 : count > full ? full : count;
      if (bits == 8) {
        row[x] = (uint8_t)count;
      } else {
        ((uint16_t *)(void *)row)[x] = (uint16_t)count;
      }
    }
  }
  return PLACIDO_OK;
}
