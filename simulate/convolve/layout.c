/* A plane is cut into tiles where that is quicker or where it would not fit: overlap-save, the
 * source of a tile reaching beyond it as far as the PSF does.
 *
 * A plane in one piece needs less padding: beyond its rim is nothing, so what spills over either
 * side wraps into the same zeros. */
#include "simulate/convolve/layout.h"

#include "simulate/fft.h"

#include <math.h>
#include <stdbool.h>

#define TILES_MAX 64 /* along an axis: a quarter of a thousand samples of the largest plane */

static int padded_of(int needed, int least) {
  return placido_fft_fast_length(needed > least ? needed : least);
}

static placido_axis whole(int length, int reach, int least) {
  return (placido_axis){.length = length,
                        .reach = reach,
                        .tiles = 1,
                        .tile = length,
                        .padded = padded_of(length + reach, least)};
}

static placido_axis cut(int length, int reach, int tiles, int least) {
  if (tiles == 1) {
    return whole(length, reach, least);
  }
  placido_axis axis = {.length = length, .reach = reach, .lead = reach};
  axis.padded = padded_of((length + tiles - 1) / tiles + 2 * reach, least);
  axis.tile = axis.padded - 2 * reach;
  axis.tiles = (length + axis.tile - 1) / axis.tile;
  return axis;
}

/* What is transformed, as time: a tile beyond this size pays for fresh memory and lost caches, as
 * measured for 3840 by 2160 pixels. */
static const double easy_bytes = 24e6, uneasy = 1.25;

static double bytes_of(const placido_layout *layout, size_t sample_bytes) {
  return (double)layout->x.padded * layout->y.padded * (double)sample_bytes;
}

static double cost_of(const placido_layout *layout, size_t sample_bytes) {
  double bytes = bytes_of(layout, sample_bytes);
  return bytes * layout->x.tiles * layout->y.tiles * (bytes > easy_bytes ? uneasy : 1);
}

/* It fits where the other does not, or is smaller where neither fits, or costs less. */
static bool is_better(const placido_layout *one, const placido_layout *other, double bytes_max,
                      size_t sample_bytes) {
  double bytes = bytes_of(one, sample_bytes), others = bytes_of(other, sample_bytes);
  if (fmax(bytes, others) > bytes_max) {
    return bytes < others;
  }
  return cost_of(one, sample_bytes) < cost_of(other, sample_bytes);
}

placido_layout placido_layout_find(int width, int height, int reach, double bytes_max,
                                   int padded_least, size_t sample_bytes) {
  /* A PSF wider than the plane: buckets farther out than the plane is long meet nothing. */
  int reach_x = reach < width ? reach : width - 1, reach_y = reach < height ? reach : height - 1;
  placido_layout best = {whole(width, reach_x, padded_least),
                         whole(height, reach_y, padded_least)};
  placido_axis columns[TILES_MAX];
  if (bytes_of(&best, sample_bytes) <= fmin(bytes_max, easy_bytes)) {
    return best;
  }
  for (int i = 0; i < TILES_MAX; i++) {
    columns[i] = cut(width, reach_x, i + 1, padded_least);
  }
  for (int i = 0; i < TILES_MAX; i++) {
    placido_layout layout = {.y = cut(height, reach_y, i + 1, padded_least)};
    for (int k = 0; k < TILES_MAX; k++) {
      layout.x = columns[k];
      if (is_better(&layout, &best, bytes_max, sample_bytes)) {
        best = layout;
      }
    }
  }
  return best;
}

static int lesser(int a, int b) {
  return a < b ? a : b;
}

placido_stretch placido_axis_stretch(const placido_axis *axis, int index) {
  int first = index * axis->tile, begin = first - axis->lead;
  int from = begin > 0 ? begin : 0;
  int end = lesser(begin + axis->padded, axis->length);
  return (placido_stretch){.first = first,
                           .count = lesser(axis->tile, axis->length - first),
                           .lead = axis->lead,
                           .from = from,
                           .used = end - from,
                           .at = from - begin};
}
