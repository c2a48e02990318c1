/* The OSA/ANSI circle polynomials as such: index, radial coefficients, values at many points.
 * ANSI Z80.28; Thibos et al., "Standards for reporting the optical aberrations of eyes",
 * J. Refract. Surg. 18, S652-S660 (2002), eqs. 1 to 5. */
#include "reconstruct/surface/zernike.h"

#include <math.h>
#include <stdlib.h>

int placido_zernike_count(int order) {
  return (order + 1) * (order + 2) / 2;
}

int placido_zernike_index(int n, int m) {
  return (n * (n + 2) + m) / 2;
}

void placido_zernike_name(int j, int *n, int *m) {
  *n = 0;
  while (placido_zernike_count(*n) <= j) {
    ++*n;
  }
  *m = 2 * j - *n * (*n + 2);
}

static double factorial(int n) {
  double product = 1;
  for (int i = 2; i <= n; i++) {
    product *= i;
  }
  return product;
}

int placido_zernike_radial(double powers[PLACIDO_ZERNIKE_POWERS], int n, int m) {
  int frequency = abs(m), half = (n - frequency) / 2;
  double weight = sqrt((m == 0 ? 1.0 : 2.0) * (n + 1));
  for (int k = 0; k <= half; k++) {
    powers[half - k] = weight * factorial(n - k) /
                       (factorial(k) * factorial((n + frequency) / 2 - k) * factorial(half - k));
    weight = -weight;
  }
  return half + 1;
}

static double polynomial(const double *powers, int count, double s) {
  double f = 0;
  for (int k = count - 1; k >= 0; k--) {
    f = f * s + powers[k];
  }
  return f;
}

/* The terms of order n and frequencies m and -m. */
static void fill_pair(double *cosine, double *sine, int n, int m, const double *x, const double *y,
                      size_t count) {
  double powers[PLACIDO_ZERNIKE_POWERS];
  int length = placido_zernike_radial(powers, n, m);
  for (size_t i = 0; i < count; i++) {
    double real = polynomial(powers, length, x[i] * x[i] + y[i] * y[i]), imaginary = 0;
    for (int k = 0; k < m; k++) {
      double turned = real * x[i] - imaginary * y[i];
      imaginary = real * y[i] + imaginary * x[i];
      real = turned;
    }
    sine[i] = imaginary;
    cosine[i] = real; /* last: where m is 0 both are one row */
  }
}

void placido_zernike_terms(double *terms, int order, const double *x, const double *y,
                           size_t count) {
  for (int n = 0; n <= order; n++) {
    for (int m = n % 2; m <= n; m += 2) {
      fill_pair(terms + (size_t)placido_zernike_index(n, m) * count,
                terms + (size_t)placido_zernike_index(n, -m) * count, n, m, x, y, count);
    }
  }
}
