/* OTF: the transform of a PSF in twice its room, between whose samples cubic B-splines blend. What
 * the blending does to the light, a fourth power of sinc, is divided out of the PSF beforehand, so
 * that only the light's first echo is left: below 1e-4 within a fifth of the PSF's half side, 1 %
 * at its rim. (Fessler and Sutton, IEEE Trans. Signal Processing 51, 560 (2003): gridding.) */
#include "simulate/quality/otf.h"

#include "base/memory.h"
#include "simulate/fft.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static int transform(float *values, int side, int stride, placido_error *err) {
  placido_fft_lock();
  int shape[2] = {side, side}, real_shape[2] = {side, 2 * stride};
  int complex_shape[2] = {side, stride};
  fftwf_complex *waves = (fftwf_complex *)(void *)values;
  fftwf_plan plan = fftwf_plan_many_dft_r2c(2, shape, 1, values, real_shape, 1, 0, waves,
                                            complex_shape, 1, 0, FFTW_ESTIMATE);
  placido_fft_unlock();
  if (plan == NULL) {
    return placido_error_set(err, PLACIDO_MEMORY, "no transform of %d by %d samples could be made",
                             side, side);
  }
  fftwf_execute(plan);
  placido_fft_lock();
  fftwf_destroy_plan(plan);
  placido_fft_unlock();
  return PLACIDO_OK;
}

/* sin(pi x) / (pi x) */
static double sinc(double x) {
  return fabs(x) < 1e-9 ? 1 : sin(pi * x) / (pi * x);
}

/* The buckets about sample (0, 0), rows upwards. */
static void lay_out(float *values, const placido_otf *otf, const placido_psf *psf, double sum) {
  int half = psf->n / 2;
  for (int row = 0; row < psf->n; row++) {
    int up = (half - row + otf->side) % otf->side;
    double faint = pow(sinc((double)(half - row) / otf->side), 4);
    for (int column = 0; column < psf->n; column++) {
      int right = (column - half + otf->side) % otf->side;
      double blend = faint * pow(sinc((double)(column - half) / otf->side), 4);
      values[(size_t)up * 2 * (size_t)otf->stride + (size_t)right] =
        (float)(psf->values[(size_t)row * (size_t)psf->n + (size_t)column] / (sum * blend));
    }
  }
}

int placido_otf_new(placido_otf *otf, const placido_psf *psf, placido_error *err) {
  *otf = (placido_otf){.side = placido_fft_good_length(2 * psf->n),
                       .bucket_deg = psf->bucket_arcmin / 60};
  otf->stride = otf->side / 2 + 1;
  otf->step_cpd = 1 / (otf->side * otf->bucket_deg);
  double sum = 0;
  for (size_t i = 0; i < (size_t)psf->n * (size_t)psf->n; i++) {
    sum += psf->values[i];
  }
  if (!(sum > 0)) {
    return placido_error_set(err, PLACIDO_QUALITY, "a PSF without light has no transfer function");
  }
  size_t size = (size_t)otf->side * (size_t)otf->stride;
  otf->values = placido_memory_new(size, sizeof(fftwf_complex), err);
  if (otf->values == NULL) {
    return PLACIDO_MEMORY;
  }
  lay_out(otf->values, otf, psf, sum);
  int status = transform(otf->values, otf->side, otf->stride, err);
  if (status != PLACIDO_OK) {
    placido_otf_free(otf);
  }
  return status;
}

void placido_otf_free(placido_otf *otf) {
  if (otf != NULL) {
    placido_memory_free(otf->values);
    *otf = (placido_otf){0};
  }
}

/* The sample at any lattice point. */
static void sample(const placido_otf *otf, int column, int row, double *real, double *imaginary) {
  bool mirrored = column < 0;
  int right = mirrored ? -column : column, up = mirrored ? -row : row;
  if (right > otf->side / 2) { /* beyond half a cycle a bucket: a whole period less */
    right = otf->side - right;
    up = -up;
    mirrored = !mirrored;
  }
  up = (up % otf->side + otf->side) % otf->side;
  const float *value = otf->values + 2 * ((size_t)up * (size_t)otf->stride + (size_t)right);
  *real = value[0];
  *imaginary = mirrored ? -value[1] : value[1];
}

/* The cubic B-spline's weights of four samples; returns the first. */
static int blend_weights(double weights[4], double place) {
  int second = (int)floor(place);
  double t = place - second, u = 1 - t;
  weights[0] = u * u * u / 6;
  weights[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
  weights[2] = (4 - 6 * u * u + 3 * u * u * u) / 6;
  weights[3] = t * t * t / 6;
  return second - 1;
}

void placido_otf_at(const placido_otf *otf, double x_cpd, double y_cpd, double *real,
                    double *imaginary) {
  double across[4], along[4];
  int column = blend_weights(across, x_cpd / otf->step_cpd);
  int row = blend_weights(along, y_cpd / otf->step_cpd);
  double bucket = sinc(x_cpd * otf->bucket_deg) * sinc(y_cpd * otf->bucket_deg);
  *real = *imaginary = 0;
  for (int j = 0; j < 4; j++) {
    for (int i = 0; i < 4; i++) {
      double re, im, weight = across[i] * along[j] / bucket;
      sample(otf, column + i, row + j, &re, &im);
      *real += weight * re;
      *imaginary += weight * im;
    }
  }
}
