/* The share of light about its own peak: a smooth stand-in for the highest bucket of a histogram.
 *
 * Counting rays in a half-minute bucket gives steps and many local maxima. Instead every ray counts
 * by Moffat's profile (1 + d²/w²)^-2. Where a peak is, there are rays: a sample of them is tried,
 * and the densest settles by the mean-shift step of that profile (Comaniciu and Meer, PAMI 24
 * (2002) 603: weights are the profile's derivative, (1 + d²/w²)^-3). */
#include "simulate/light.h"

enum { TRIED = 128, SETTLE = 12 };

/* Gathers at `peak`; `next` receives where the mean-shift step leads. */
static double gather(const double *x, const double *y, size_t count, double width,
                     const double peak[2], double next[2]) {
  double scale = 1 / (width * width), gathered = 0, weight = 0, sx = 0, sy = 0;
#pragma omp simd reduction(+ : gathered, weight, sx, sy)
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
  next[0] = peak[0] + sx / weight;
  next[1] = peak[1] + sy / weight;
  return gathered;
}

double placido_light_peak(const double *x, const double *y, size_t count, double width,
                          double peak[2]) {
  double best = 0, next[2];
  size_t stride = count / TRIED + 1;
  peak[0] = peak[1] = 0;
  for (size_t i = 0; i < count; i += stride) {
    double gathered = gather(x, y, count, width, (double[2]){x[i], y[i]}, next);
    if (gathered > best) {
      best = gathered;
      peak[0] = x[i];
      peak[1] = y[i];
    }
  }
  for (int i = 0; i < SETTLE && count > 0; i++) {
    gather(x, y, count, width, peak, next);
    peak[0] = next[0];
    peak[1] = next[1];
  }
  return count > 0 ? gather(x, y, count, width, peak, next) : 0;
}
