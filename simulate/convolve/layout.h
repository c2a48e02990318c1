/* How a plane is cut into tiles, and how far these are padded. */
#ifndef PLACIDO_SIMULATE_CONVOLVE_LAYOUT_H
#define PLACIDO_SIMULATE_CONVOLVE_LAYOUT_H

#include <stddef.h>

/* One direction of the plane: `tiles` tiles of `tile` samples each (the last may have fewer), which
 * are transformed in `padded` samples and start `lead` samples into them. */
typedef struct placido_axis {
  int length, reach;
  int tiles, tile, padded, lead;
} placido_axis;

/* One tile's part of an axis: samples `first` to first + count of the plane are the result, and
 * stand at `lead` of the padded tile; samples `from` to from + used of the source go to `at`. */
typedef struct placido_stretch {
  int first, count, lead;
  int from, used, at;
} placido_stretch;

typedef struct placido_layout {
  placido_axis x, y;
} placido_layout;

/* The tiles that take the least time among those of at most `bytes_max` when padded to at least
 * `padded_least` samples a side; where no tile is that small, the smallest. Depends on nothing but
 * its arguments. Overlap-save: Oppenheim and Schafer, Discrete-Time Signal Processing, 8.7.3. */
placido_layout placido_layout_find(int width, int height, int reach, double bytes_max,
                                   int padded_least, size_t sample_bytes);

/* Part `index` of an axis. */
placido_stretch placido_axis_stretch(const placido_axis *axis, int index);

#endif
