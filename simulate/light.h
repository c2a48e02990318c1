/* How much of the light lies close together, and around which point. */
#ifndef PLACIDO_SIMULATE_LIGHT_H
#define PLACIDO_SIMULATE_LIGHT_H

#include <stddef.h>

/* Sum of 1 / (1 + d²/width²)² over `count` points, d the distance from their densest place, which
 * is found by narrowing from all the points down to `width` and settled there by `settle` steps
 * more; `peak` (x, y) receives it. Any unit of length. */
double placido_light_gathered(const double *x, const double *y, size_t count, double width,
                              int settle, double peak[2]);

#endif
