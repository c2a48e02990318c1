/* Autocorrelation of the filtered PSF, by the transform of its power.
 *
 * Wiener and Khinchin. The inner product of two letters a and b seen through a filter h is the
 * integral of the letters' cross-correlation times the autocorrelation of h; letters end at their
 * own size, so that no more of h is needed than shifts of that size, however far its ghosts lie. */
#include "simulate/acuity/lags.h"

#include "base/memory.h"
#include "simulate/acuity/neural.h"
#include "simulate/fft.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define BUCKETS_MAX 8191

static const double rounding = 1e-6; /* that light may be below 0, and all light above 1 */

int placido_psf_check(const placido_psf *psf, placido_error *err) {
  if (psf->values == NULL || psf->n < 3 || psf->n > BUCKETS_MAX || psf->n % 2 == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "PSF: %d buckets a side; an odd number from 3 to "
                             "%d was expected", psf->n, BUCKETS_MAX);
  }
  if (!(psf->bucket_arcmin > 0) || !isfinite(psf->bucket_arcmin)) {
    return placido_error_set(err, PLACIDO_INPUT, "PSF: buckets of %g' are not above 0",
                             psf->bucket_arcmin);
  }
  double sum = 0;
  for (size_t i = 0; i < (size_t)psf->n * (size_t)psf->n; i++) {
    if (!(psf->values[i] >= -rounding)) {
      return placido_error_set(err, PLACIDO_INPUT, "PSF: %g in bucket %zu is not light",
                               psf->values[i], i);
    }
    sum += psf->values[i];
  }
  if (!(sum > 0) || sum > 1 + rounding) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "PSF: its light sums to %g; above 0 and up to 1 was expected", sum);
  }
  return PLACIDO_OK;
}

static double place(const placido_fft *fft, float *plane, const placido_psf *psf) {
  double sum = 0;
  for (int row = 0; row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      double value = psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
      plane[(size_t)row * fft->stride + (size_t)column] = (float)value;
      sum += value;
    }
  }
  return sum;
}

/* Modulation transfer of averaging over a bucket. */
static double bucket_mtf(double cycles_per_bucket) {
  double x = M_PI * cycles_per_bucket;
  return x == 0 ? 1 : sin(x) / x;
}

/* What amplitudes are to be multiplied with, sampled in |frequency| and read off in between: many
 * thousand frequencies share it. */
typedef struct filter {
  double step_cpd;
  double gains[2048];
} filter;

static filter make_filter(const placido_psf *psf, double highest_cpd) {
  bool by_rays = psf->wavelength_nm == 0 && psf->pupil_mm > 0;
  filter f = {.step_cpd = highest_cpd / 2046};
  for (int i = 0; i < 2048; i++) {
    double cpd = i * f.step_cpd;
    double rays = by_rays ? placido_diffraction_mtf(cpd, psf->pupil_mm) : 1;
    f.gains[i] = rays * placido_neural_filter(cpd);
  }
  return f;
}

static double gain_at(const filter *f, double cpd) {
  double at = cpd / f->step_cpd;
  int i = (int)at;
  return f->gains[i] + (at - i) * (f->gains[i + 1] - f->gains[i]);
}

/* Power of one row of the spectrum in place of its amplitudes. Buckets average the light that falls
 * into them: that is taken back, but never to more than all light. */
static void make_power(float *row, const placido_fft *fft, const filter *f, double sum,
                       double cycles_y, double bucket_deg, double scale) {
  double bucket_y = bucket_mtf(cycles_y);
  for (int i = 0; i <= fft->columns / 2; i++) {
    double cycles_x = (double)i / fft->columns;
    double amplitude = hypot(row[2 * i], row[2 * i + 1]) / (bucket_y * bucket_mtf(cycles_x));
    double seen = fmin(amplitude, sum) * gain_at(f, hypot(cycles_x, cycles_y) / bucket_deg);
    row[2 * i] = (float)(scale * seen * seen);
    row[2 * i + 1] = 0;
  }
}

static void correlate(placido_lags *lags, const placido_fft *fft, const placido_psf *psf,
                      double sum) {
  const double bucket_deg = psf->bucket_arcmin / 60;
  const filter f = make_filter(psf, 0.5 * sqrt(2) / bucket_deg);
  double scale = 1 / ((double)fft->columns * fft->rows * bucket_deg * bucket_deg);
  placido_fft_forward(fft, lags->values);
  for (int row = 0; row < fft->rows; row++) {
    int wave = row <= fft->rows / 2 ? row : fft->rows - row;
    make_power(&lags->values[(size_t)row * fft->stride], fft, &f, sum, (double)wave / fft->rows,
               bucket_deg, scale);
  }
  placido_fft_backward(fft, lags->values);
}

int placido_lags_new(placido_lags *lags, const placido_psf *psf, placido_error *err) {
  *lags = (placido_lags){0};
  placido_fft fft = {0};
  int status = placido_psf_check(psf, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  fft = placido_fft_shape(2 * psf->n, 2 * psf->n);
  *lags = (placido_lags){.columns = fft.columns, .rows = fft.rows, .stride = fft.stride,
                         .step_arcmin = psf->bucket_arcmin,
                         .window_arcmin = psf->n * psf->bucket_arcmin};
  lags->values = placido_memory_new_aligned(fft.plane * sizeof *lags->values, err);
  if (lags->values == NULL) {
    status = PLACIDO_MEMORY;
    goto fail;
  }
  memset(lags->values, 0, fft.plane * sizeof *lags->values);
  status = placido_fft_new(&fft, lags->values, err);
  if (status != PLACIDO_OK) {
    goto fail;
  }
  double sum = place(&fft, lags->values, psf);
  lags->lost = fmax(1 - sum, 0);
  correlate(lags, &fft, psf, sum);
  placido_fft_free(&fft);
  return PLACIDO_OK;
fail:
  placido_lags_free(lags);
  return status;
}

void placido_lags_free(placido_lags *lags) {
  if (lags != NULL) {
    placido_memory_free(lags->values);
    *lags = (placido_lags){0};
  }
}
