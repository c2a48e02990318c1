/* Residuals and their differences, sorted into squares of the cornea. */
#include "reconstruct/solve/doubt/misfit.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

#define HALF 6 /* squares from the axis outwards, of 1 mm */
#define SIDE (2 * HALF)
#define SQUARES (SIDE * SIDE)
#define SPREAD 1.4826 /* of a normal distribution: sigma over the median of magnitudes */
#define LEAST_PX 1e-3 /* of noise: no edge is known better */

/* The numbers of one square after those of the one before. */
struct sorted {
  size_t first[SQUARES + 1], filled[SQUARES];
  double *numbers;
};

static int square_of(const placido_sample *s) {
  int column = (int)fmax(0, fmin(SIDE - 1, floor(s->hit.x) + HALF));
  int row = (int)fmax(0, fmin(SIDE - 1, floor(s->hit.y) + HALF));
  return row * SIDE + column;
}

static bool tells(const placido_sample *s) {
  return s->used && isfinite(s->hit.x) && isfinite(s->hit.y) && !isnan(s->residual_px);
}

/* What sample i has to say: its residual, or its difference from the next one on its edge; false:
 * nothing. */
static bool number_of(double *number, const placido_sample *samples, size_t i, size_t count,
                      bool difference, const placido_mires *mires, int stride) {
  const placido_sample *s = &samples[i];
  *number = tells(s) ? fabs(s->residual_px) : 0;
  if (!difference || !tells(s)) {
    return tells(s);
  }
  if (i + 1 == count || !tells(s + 1) || s[1].edge != s->edge) {
    return false;
  }
  double step = (mires->points[s[1].point].meridian_deg - mires->points[s->point].meridian_deg) *
                mires->meridian_count / 360;
  *number = fabs(s[1].residual_px - s->residual_px);
  return lrint(step) <= stride;
}

static void sort(struct sorted *sorted, const placido_sample *samples, size_t count,
                 bool difference, const placido_mires *mires, int stride) {
  double number;
  for (int k = 0; k <= SQUARES; k++) {
    sorted->first[k] = 0;
  }
  for (size_t i = 0; i < count; i++) {
    if (number_of(&number, samples, i, count, difference, mires, stride)) {
      sorted->first[square_of(&samples[i]) + 1]++;
    }
  }
  for (int k = 0; k < SQUARES; k++) {
    sorted->first[k + 1] += sorted->first[k];
    sorted->filled[k] = sorted->first[k];
  }
  for (size_t i = 0; i < count; i++) {
    if (number_of(&number, samples, i, count, difference, mires, stride)) {
      sorted->numbers[sorted->filled[square_of(&samples[i])]++] = number;
    }
  }
}

static double spread_of(const struct sorted *sorted, int square) {
  return placido_quantile(sorted->numbers + sorted->first[square],
                          sorted->first[square + 1] - sorted->first[square], 0.5);
}

int placido_misfit_worst(double *worst, placido_place *place, const placido_sample *samples,
                         size_t count, const placido_mires *mires, int stride,
                         placido_error *err) {
  struct sorted residuals, differences;
  *worst = 0;
  residuals.numbers = placido_memory_new(2 * count, sizeof(double), err);
  if (!residuals.numbers) {
    return PLACIDO_MEMORY;
  }
  differences.numbers = residuals.numbers + count;
  sort(&residuals, samples, count, false, mires, stride);
  sort(&differences, samples, count, true, mires, stride);
  for (int k = 0; k < SQUARES; k++) {
    if (differences.first[k + 1] - differences.first[k] < PLACIDO_MISFIT_POINTS) {
      continue;
    }
    double noise_px = spread_of(&differences, k) / M_SQRT2;
    double ratio = spread_of(&residuals, k) / fmax(noise_px, LEAST_PX / SPREAD);
    if (ratio > *worst) {
      *worst = ratio;
      if (place) {
        *place = (placido_place){k % SIDE - HALF + 0.5, k / SIDE - HALF + 0.5};
      }
    }
  }
  placido_memory_free(residuals.numbers);
  return PLACIDO_OK;
}
