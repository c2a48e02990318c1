/* Planes, point spread functions and their convolution summed up, for tests. */
#include "tests/simulate/planes.h"

#include "tests/support/near.h"

#include <math.h>
#include <stdlib.h>

static double noise(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return (double)(*seed >> 8) / (1 << 24);
}

float *noise_plane(int width, int height, unsigned seed) {
  size_t count = (size_t)width * (size_t)height;
  float *plane = malloc(count * sizeof *plane);
  assert_non_null(plane);
  for (size_t i = 0; i < count; i++) {
    plane[i] = (float)noise(&seed);
  }
  return plane;
}

placido_psf noise_psf(double *values, int n, unsigned seed) {
  double sum = 0;
  for (int i = 0; i < n * n; i++) {
    values[i] = noise(&seed);
    sum += values[i];
  }
  for (int i = 0; i < n * n; i++) {
    values[i] /= sum;
  }
  return (placido_psf){.n = n, .bucket_arcmin = 0.5, .values = values};
}

double direct_sum(const float *source, int width, int height, const placido_psf *psf, int x,
                  int y) {
  double sum = 0;
  int half = psf->n / 2;
  for (int row = 0; row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      int from_x = x - (column - half), from_y = y - (row - half);
      if (from_x >= 0 && from_x < width && from_y >= 0 && from_y < height) {
        sum += psf->values[row * psf->n + column] * (double)source[from_y * width + from_x];
      }
    }
  }
  return sum;
}

float *convolved_plane(const float *source, int width, int height, const placido_psf *psf,
                       const placido_convolution *how) {
  placido_convolver *convolver;
  placido_transfer *transfer;
  float *target = noise_plane(width, height, 99); /* so that what is not written shows */
  assert_int_equal(
      placido_convolver_new(&convolver, width, height, placido_psf_reach(psf), how, NULL, NULL),
      PLACIDO_OK);
  assert_int_equal(placido_transfer_new(&transfer, convolver, psf, NULL), PLACIDO_OK);
  const placido_convolution_term term = {source, transfer};
  const placido_superposition plane = {target, &term, 1};
  assert_int_equal(placido_convolver_run(convolver, &plane, 1, NULL), PLACIDO_OK);
  placido_transfer_free(transfer);
  placido_convolver_free(convolver);
  return target;
}

double rounding_bound(const float *source, int width, int height, const placido_psf *psf,
                      double epsilon) {
  double light = 0, squares = 0, gain = 0, psf_squares = 0;
  for (int i = 0; i < width * height; i++) {
    squares += (double)source[i] * (double)source[i];
    light += fabs((double)source[i]);
  }
  for (int i = 0; i < psf->n * psf->n; i++) {
    psf_squares += psf->values[i] * psf->values[i];
    gain += fabs(psf->values[i]);
  }
  double padded = 4.0 * (width + psf->n) * (height + psf->n);
  return epsilon * log2(padded) * (2 * gain * sqrt(squares) + light * sqrt(psf_squares));
}
