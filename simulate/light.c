/* The share of light about its own peak: a smooth stand-in for the highest bucket of a histogram.
 *
 * Counting rays in a half-minute bucket gives steps and many local maxima. Instead every ray counts
 * by the profile (1 + d²/w²)^-3/2. Where a peak is, there are rays: some are tried on a sample of
 * all, and the densest settle by the mean-shift step of that profile (Comaniciu and Meer, PAMI 24
 * (2002) 603: weights are the profile's derivative, (1 + d²/w²)^-5/2). Sums are made in LANES
 * interleaved parts, so that they are the same for every vector width. */
#include "simulate/light.h"

#include "base/dispatch.h"

#include <math.h>

enum { TRIED = 128, SAMPLE = 1024, SETTLED = 4, SETTLE = 16, LANES = 16 };

/* Sums over the points about a place. */
typedef struct sums {
  float gathered[LANES], weight[LANES], x[LANES], y[LANES];
} sums;

PLACIDO_INSIDE void add_point(sums *s, size_t lane, float dx, float dy, float scale) {
  float near = 1 / (1 + (dx * dx + dy * dy) * scale);
  float share = near * sqrtf(near);
  s->gathered[lane] += share;
  share *= near;
  s->weight[lane] += share;
  s->x[lane] += share * dx;
  s->y[lane] += share * dy;
}

PLACIDO_WIDE static void add_points(sums *s, const float *x, const float *y, size_t count,
                                    float scale, float at_x, float at_y) {
  size_t whole = count - count % LANES;
  for (size_t i = 0; i < whole; i += LANES) {
#pragma omp simd
    for (size_t k = 0; k < LANES; k++) {
      add_point(s, k, x[i + k] - at_x, y[i + k] - at_y, scale);
    }
  }
  for (size_t i = whole; i < count; i++) {
    add_point(s, i - whole, x[i] - at_x, y[i] - at_y, scale);
  }
}

/* Gathers at `peak`; `next` receives where the mean-shift step leads. */
static double gather(const float *x, const float *y, size_t count, double width,
                     const double peak[2], double next[2]) {
  sums s = {{0}, {0}, {0}, {0}};
  add_points(&s, x, y, count, (float)(1 / (width * width)), (float)peak[0], (float)peak[1]);
  double gathered = 0, weight = 0, sx = 0, sy = 0;
  for (int k = 0; k < LANES; k++) {
    gathered += (double)s.gathered[k];
    weight += (double)s.weight[k];
    sx += (double)s.x[k];
    sy += (double)s.y[k];
  }
  next[0] = peak[0] + sx / weight;
  next[1] = peak[1] + sy / weight;
  return gathered;
}

/* What was gathered where. */
typedef struct place {
  double gathered, at[2];
} place;

/* Puts a place among the best, which are in descending order. */
static void keep(place best[SETTLED], const place *found) {
  int at = SETTLED;
  for (; at > 0 && found->gathered > best[at - 1].gathered; at--) {
    if (at < SETTLED) {
      best[at] = best[at - 1];
    }
  }
  if (at < SETTLED) {
    best[at] = *found;
  }
}

/* Tries some of the points on a sample of them. */
static void try_points(place best[SETTLED], const float *x, const float *y, size_t count,
                       double width) {
  float sample_x[SAMPLE], sample_y[SAMPLE];
  size_t sampled = 0;
  for (size_t i = 0; i < count && sampled < SAMPLE; i += count / SAMPLE + 1, sampled++) {
    sample_x[sampled] = x[i];
    sample_y[sampled] = y[i];
  }
  for (size_t i = 0; i < count; i += count / TRIED + 1) {
    place found = {.at = {(double)x[i], (double)y[i]}};
    double next[2];
    found.gathered = gather(sample_x, sample_y, sampled, width, found.at, next);
    keep(best, &found);
  }
}

double placido_light_peak(const float *x, const float *y, size_t count, double width,
                          double peak[2]) {
  place best[SETTLED] = {{0}};
  double most = 0, next[2];
  peak[0] = peak[1] = 0;
  try_points(best, x, y, count, width);
  for (int i = 0; i < SETTLED && best[i].gathered > 0; i++) {
    double *at = best[i].at;
    for (int k = 0; k < SETTLE; k++) {
      gather(x, y, count, width, at, next);
      at[0] = next[0];
      at[1] = next[1];
    }
    double gathered = gather(x, y, count, width, at, next);
    if (gathered > most) {
      most = gathered;
      peak[0] = at[0];
      peak[1] = at[1];
    }
  }
  return most;
}
