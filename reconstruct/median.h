/* Order statistics, by selection rather than sorting. */
#ifndef PLACIDO_RECONSTRUCT_MEDIAN_H
#define PLACIDO_RECONSTRUCT_MEDIAN_H

#include <stddef.h>

/* The value below which `share` (0..1) of the values lie: element floor(share·(count - 1)) of the
 * sorted list. Reorders `values`, none of which may be NaN. NaN where count is 0. */
double placido_quantile(double *values, size_t count, double share);

#endif
