/* Where the values of a map lie. */
#ifndef PLACIDO_REPORT_RANGE_H
#define PLACIDO_REPORT_RANGE_H

#include <placido/map.h>

/* NaN where there are no values. */
typedef struct placido_range {
  double lowest, highest;
  double low, high; /* without half a per cent at either end: few points never choose the scale */
} placido_range;

/* The range of `values`, one of the arrays of `maps`, further than hole_mm from the axis.
 * PLACIDO_OK, PLACIDO_MEMORY. */
int placido_range_find(placido_range *found, const placido_maps *maps, const double *values,
                       double hole_mm, placido_error *err);

/* "step 1 D   ·   lowest 41.2   ·   highest 46.0": what a figure says below its map. */
void placido_range_describe(char *note, size_t size, const placido_range *range, double step,
                            const char *unit);

#endif
