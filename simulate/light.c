/* The share of light about its own peak: a smooth stand-in for the highest bucket of a histogram.
 *
 * Counting rays in a half-minute bucket gives steps and many local maxima. Instead every ray counts
 * by Moffat's profile (1 + d²/w²)^-2, whose long tail still feels light that is far off. The peak
 * is found by the mean-shift step of that profile (Comaniciu and Meer, PAMI 24 (2002) 603: weights
 * are the profile's derivative, (1 + d²/w²)^-3), first at the spot's own size, which a single step
 * from the middle settles, then at half of it, and so on: coma moves the peak from the middle. */
#include "simulate/light.h"

#include <math.h>

static double middle_and_size(const double *x, const double *y, size_t count, double middle[2]) {
  double sx = 0, sy = 0, square = 0;
  for (size_t i = 0; i < count; i++) {
    sx += x[i];
    sy += y[i];
  }
  middle[0] = sx / (double)count;
  middle[1] = sy / (double)count;
  for (size_t i = 0; i < count; i++) {
    double dx = x[i] - middle[0], dy = y[i] - middle[1];
    square += dx * dx + dy * dy;
  }
  return sqrt(square / (double)count);
}

/* One mean-shift step of `peak`; returns the light gathered at where it was. */
static double shift(const double *x, const double *y, size_t count, double width, double peak[2]) {
  double scale = 1 / (width * width), gathered = 0, weight = 0, sx = 0, sy = 0;
  for (size_t i = 0; i < count; i++) {
    double dx = x[i] - peak[0], dy = y[i] - peak[1];
    double near = 1 / (1 + (dx * dx + dy * dy) * scale);
    double share = near * near;
    gathered += share;
    share *= near;
    weight += share;
    sx += share * dx;
    sy += share * dy;
  }
  peak[0] += sx / weight;
  peak[1] += sy / weight;
  return gathered;
}

double placido_light_gathered(const double *x, const double *y, size_t count, double width,
                              int settle, double peak[2]) {
  peak[0] = peak[1] = 0;
  if (count == 0) {
    return 0;
  }
  double size = middle_and_size(x, y, count, peak);
  for (; size > width; size /= 2) {
    shift(x, y, count, size, peak);
  }
  for (int i = 0; i < settle; i++) {
    shift(x, y, count, width, peak);
  }
  return shift(x, y, count, width, (double[2]){peak[0], peak[1]});
}
