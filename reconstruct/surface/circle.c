/* The OSA/ANSI circle polynomials as such: index, radial polynomials, values at many points.
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

placido_zernike_step placido_zernike_step_of(int m, int k) {
  double f = abs(m), sum = 2 * k + f, next = (k + 1) * (k + f + 1);
  if (k == 0) {
    return (placido_zernike_step){f + 2, -(f + 1), 0};
  }
  double turn = (sum + 1) * (sum + 2) / next;
  return (placido_zernike_step){turn, -turn / 2 - (sum + 1) * f * f / (2 * next * sum),
                                k * (k + f) * (sum + 2) / (next * sum)};
}

double placido_zernike_norm(int n, int m) {
  return sqrt((m == 0 ? 1.0 : 2.0) * (n + 1));
}

int placido_zernike_radial(double powers[PLACIDO_ZERNIKE_POWERS], int n, int m) {
  int frequency = abs(m), half = (n - frequency) / 2;
  double weight = placido_zernike_norm(n, m);
  for (int k = 0; k <= half; k++) {
    powers[half - k] = weight * factorial(n - k) /
                       (factorial(k) * factorial((n + frequency) / 2 - k) * factorial(half - k));
    weight = -weight;
  }
  return half + 1;
}

/* The real and imaginary part of (x + iy)^m. */
static void power_of(double out[2], double x, double y, int m) {
  out[0] = 1;
  out[1] = 0;
  for (int k = 0; k < m; k++) {
    double turned = out[0] * x - out[1] * y;
    out[1] = out[0] * y + out[1] * x;
    out[0] = turned;
  }
}

/* The terms of frequencies m and -m at point number i. */
static void fill_point(double *terms, int order, int m, const placido_zernike_step *steps, double x,
                       double y, size_t i, size_t count) {
  double power[2], s = x * x + y * y, q = 1, before = 0;
  power_of(power, x, y, m);
  for (int n = m, k = 0; n <= order; n += 2, k++) {
    double value = placido_zernike_norm(n, m) * q;
    terms[(size_t)placido_zernike_index(n, -m) * count + i] = value * power[1];
    terms[(size_t)placido_zernike_index(n, m) * count + i] = value * power[0]; /* m = 0: one row */
    double next = (steps[k].by_s * s + steps[k].constant) * q - steps[k].before * before;
    before = q;
    q = next;
  }
}

void placido_zernike_terms(double *terms, int order, const double *x, const double *y,
                           size_t count) {
  placido_zernike_step steps[PLACIDO_ZERNIKE_POWERS];
  for (int m = 0; m <= order; m++) {
    for (int k = 0; k < PLACIDO_ZERNIKE_POWERS; k++) {
      steps[k] = placido_zernike_step_of(m, k);
    }
    for (size_t i = 0; i < count; i++) {
      fill_point(terms, order, m, steps, x[i], y[i], i, count);
    }
  }
}
