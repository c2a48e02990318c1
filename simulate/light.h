/* How much of the light lies close together, and around which point. */
#ifndef PLACIDO_SIMULATE_LIGHT_H
#define PLACIDO_SIMULATE_LIGHT_H

#include <stddef.h>

/* Greatest sum of (1 + d²/width²)^-3/2 over `count` points, d the distance from the place that
 * `peak` (x, y) receives. Any unit of length; 0 for no points. */
double placido_light_peak(const float *x, const float *y, size_t count, double width,
                          double peak[2]);

#endif
