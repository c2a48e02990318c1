/* A picture at another scale. */
#ifndef PLACIDO_SIMULATE_RESAMPLE_H
#define PLACIDO_SIMULATE_RESAMPLE_H

#include <placido/image.h>
#include <placido/scene.h>
#include <placido/status.h>

/* Fills every plane of `target` (allocated by the caller). Target pixel (x, y) covers the square of
 * `step` source pixels a side from (left + x * step, top + y * step) on. Steps above 1 average,
 * with the filter as wide as they are, steps below 1 interpolate. Where the filter reaches beyond
 * the source's rim it is cut off and weighed anew. Sums in double; the same for any `threads`.
 * Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_resample(placido_image *target, const placido_image *source, double left, double top,
                     double step, enum placido_resampling resampling, int threads,
                     placido_error *err);

#endif
