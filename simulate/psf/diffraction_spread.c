/* From the field over the pupil to the light in square buckets, exactly for the sampled field.
 *
 * Light at an angle is |sum of field e^(i...)|², whose transform is the field's autocorrelation:
 * finitely many lags. Integrating over a bucket multiplies each lag by two sinc functions, so no
 * angle finer than a bucket is ever computed. With the field's spacing d chosen so that
 * wavelength / d is `period` whole buckets, lags that differ by the period act alike on every
 * bucket's middle: they are added up, and one small transform gives the image.
 * (Goodman, Introduction to Fourier Optics, 6.3: OTF as autocorrelation of the pupil.) */
#include "simulate/psf/diffraction.h"

#include "base/dispatch.h"
#include "base/memory.h"
#include "simulate/fft.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* An odd number of cache lines of 64 bytes, so that a column does not fall on few cache sets. */
static size_t good_stride(size_t count) {
  size_t lines = (count + 7) / 8;
  return 8 * (lines | 1);
}

static fftwf_plan plan_many(int length, size_t count, fftwf_complex *data, size_t step,
                            size_t distance, int sign) {
  return fftwf_plan_many_dft(1, &length, (int)count, data, NULL, (int)step, (int)distance, data,
                             NULL, (int)step, (int)distance, sign, FFTW_ESTIMATE);
}

static void make_plans(placido_spread *s, fftwf_complex *field, fftwf_complex *image) {
  int n = s->padded, m = s->period;
  size_t wide = s->field_stride, narrow = s->image_stride, used = (size_t)s->samples;
  s->rows = plan_many(n, used, field, 1, wide, FFTW_BACKWARD);
  s->columns = plan_many(n, (size_t)n, field, wide, 1, FFTW_BACKWARD);
  s->real_rows = fftwf_plan_many_dft_r2c(1, &n, n, (float *)(void *)field, NULL, 1,
                                         2 * (int)wide, field, NULL, 1, (int)wide, FFTW_ESTIMATE);
  s->real_columns = plan_many(n, used, field, wide, 1, FFTW_FORWARD);
  int shape[2] = {m, m}, complex_shape[2] = {m, (int)narrow}, real_shape[2] = {m, 2 * (int)narrow};
  s->image = fftwf_plan_many_dft_c2r(2, shape, 1, image, complex_shape, 1, 0,
                                     (float *)(void *)image, real_shape, 1, 0, FFTW_ESTIMATE);
}

int placido_spread_new(placido_spread *spread, int samples, int period, placido_error *err) {
  *spread = (placido_spread){.samples = samples,
                             .padded = placido_fft_good_length(2 * samples),
                             .period = period};
  spread->field_stride = good_stride((size_t)spread->padded);
  spread->image_stride = good_stride((size_t)period / 2 + 1);
  spread->field_size = spread->field_stride * (size_t)spread->padded;
  spread->image_size = spread->image_stride * (size_t)period + (size_t)samples;
  fftwf_complex *field =
    placido_memory_new_aligned(spread->field_size * sizeof(fftwf_complex), err);
  fftwf_complex *image =
    placido_memory_new_aligned(spread->image_size * sizeof(fftwf_complex), err);
  int status = field != NULL && image != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  if (status == PLACIDO_OK) {
    placido_fft_lock();
    make_plans(spread, field, image);
    placido_fft_unlock();
    if (!spread->rows || !spread->columns || !spread->real_rows || !spread->real_columns ||
        !spread->image) {
      status = placido_error_set(err, PLACIDO_MEMORY, "no transform of %d by %d samples could be "
                                 "made", spread->padded, spread->padded);
    }
  }
  placido_memory_free(field);
  placido_memory_free(image);
  if (status != PLACIDO_OK) {
    placido_spread_free(spread);
  }
  return status;
}

void placido_spread_free(placido_spread *spread) {
  if (spread == NULL) {
    return;
  }
  fftwf_plan plans[] = {spread->rows, spread->columns, spread->real_rows, spread->real_columns,
                        spread->image};
  placido_fft_lock();
  for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
    if (plans[i] != NULL) {
      fftwf_destroy_plan(plans[i]);
    }
  }
  placido_fft_unlock();
  *spread = (placido_spread){0};
}

/* Squares of the absolute values, in place, from complex to real numbers. */
PLACIDO_WIDE
static void square(float *row, int count) {
  for (int i = 0; i < count; i++) {
    row[i] = row[2 * i] * row[2 * i] + row[2 * i + 1] * row[2 * i + 1];
  }
}

PLACIDO_WIDE
static void add_row(float *sum, const float *row, size_t count, float weight) {
  for (size_t i = 0; i < count; i++) {
    sum[i] += weight * row[i];
  }
}

/* Bucket of a lag: sin(pi lag / period) / (pi lag / period). */
static float sinc(int lag, int period, bool points) {
  double angle = pi * lag / period;
  return points || lag == 0 ? 1.0f : (float)(sin(angle) / angle);
}

/* Adds the lag of one row, which stands for its mirrored one, too, to a row of the image's
 * transform; `mirror` is the row of the opposite lag. Half of the columns are kept. */
static void fold_columns(float *row, float *mirror, const float *lags, const placido_spread *s,
                         int samples, bool points) {
  int period = s->period, half = period / 2;
  for (int lag = 0; lag < samples; lag++) {
    float weight = sinc(lag, period, points);
    float real = weight * lags[2 * lag], imaginary = weight * lags[2 * lag + 1];
    int column = lag % period, opposite = (period - column) % period;
    if (column <= half) {
      row[2 * column] += real;
      row[2 * column + 1] += imaginary;
    }
    if (lag > 0 && opposite <= half) {
      mirror[2 * opposite] += real;
      mirror[2 * opposite + 1] -= imaginary;
    }
  }
}

/* Lags of `field` (their rows modulo the padded length) to the transform of the image; `line` has
 * room for a row of lags. */
static void fold(const placido_spread *s, const float *field, float *image, float *line,
                 int samples, bool points) {
  size_t wide = 2 * s->field_stride, narrow = 2 * s->image_stride;
  memset(image, 0, s->image_stride * (size_t)s->period * sizeof(fftwf_complex));
  for (int row = 0; row < s->period; row++) {
    int first = row - (samples - 1 + row) / s->period * s->period; /* lag, the least of this row */
    memset(line, 0, 2 * (size_t)samples * sizeof *line);
    for (int lag = first; lag < samples; lag += s->period) {
      size_t from = (size_t)(lag < 0 ? lag + s->padded : lag);
      add_row(line, field + from * wide, 2 * (size_t)samples, sinc(lag, s->period, points));
    }
    fold_columns(image + (size_t)row * narrow,
                 image + (size_t)((s->period - row) % s->period) * narrow, line, s, samples,
                 points);
  }
}

void placido_spread_run(const placido_spread *s, float *field, float *image, bool points) {
  fftwf_complex *waves = (fftwf_complex *)(void *)field;
  fftwf_complex *folded = (fftwf_complex *)(void *)image;
  float *line = image + 2 * s->image_stride * (size_t)s->period;
  fftwf_execute_dft(s->rows, waves, waves);
  fftwf_execute_dft(s->columns, waves, waves);
  for (int row = 0; row < s->padded; row++) {
    square(field + 2 * (size_t)row * s->field_stride, s->padded);
  }
  fftwf_execute_dft_r2c(s->real_rows, field, waves);
  fftwf_execute_dft(s->real_columns, waves, waves);
  fold(s, field, image, line, s->samples, points);
  fftwf_execute_dft_c2r(s->image, folded, image);
}
