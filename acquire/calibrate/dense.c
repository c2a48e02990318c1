/* Eigenvalues by Jacobi's cyclic rotations (Golub & Van Loan, Matrix Computations, 4th ed.,
 * algorithm 8.5.3): slow for large matrices, accurate for small ones. */
#include "acquire/calibrate/dense.h"

#include "base/dense.h"

#include <math.h>
#include <string.h>

#define SWEEPS 40

void placido_dense_inverse(double *inverse, const double *factor, int n) {
  memset(inverse, 0, (size_t)n * (size_t)n * sizeof *inverse);
  for (int i = 0; i < n; i++) {
    double *row = inverse + (size_t)i * (size_t)n;
    row[i] = 1;
    placido_dense_solve(factor, n, n, row);
  }
}

/* Turns rows i and j of `m` by the angle of cosine c and sine s. */
static void rotate_rows(double *m, int n, int i, int j, double c, double s) {
  double *a = m + (size_t)i * (size_t)n, *b = m + (size_t)j * (size_t)n;
  for (int k = 0; k < n; k++) {
    double x = a[k], y = b[k];
    a[k] = c * x - s * y;
    b[k] = s * x + c * y;
  }
}

static void rotate_columns(double *m, int n, int i, int j, double c, double s) {
  for (int k = 0; k < n; k++) {
    double *row = m + (size_t)k * (size_t)n, x = row[i], y = row[j];
    row[i] = c * x - s * y;
    row[j] = s * x + c * y;
  }
}

/* One sweep; false where nothing was left to turn. */
static bool sweep(double *a, double *vectors, int n) {
  bool turned = false;
  for (int i = 0; i < n; i++) {
    for (int j = i + 1; j < n; j++) {
      double off = a[(size_t)i * (size_t)n + (size_t)j];
      double p = a[(size_t)i * (size_t)(n + 1)], q = a[(size_t)j * (size_t)(n + 1)];
      if (fabs(off) <= 1e-16 * sqrt(fabs(p * q)) || fabs(off) < 1e-300) {
        continue;
      }
      double theta = (q - p) / (2 * off);
      double tangent = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
      double c = 1 / sqrt(tangent * tangent + 1), s = tangent * c;
      rotate_rows(a, n, i, j, c, s);
      rotate_columns(a, n, i, j, c, s);
      rotate_rows(vectors, n, i, j, c, s);
      turned = true;
    }
  }
  return turned;
}

/* The greatest first, by selection. */
static void sort(double *values, double *vectors, int n) {
  for (int i = 0; i < n; i++) {
    int best = i;
    for (int j = i + 1; j < n; j++) {
      best = values[j] > values[best] ? j : best;
    }
    double value = values[i];
    values[i] = values[best];
    values[best] = value;
    for (int k = 0; k < n && best != i; k++) {
      double *a = &vectors[(size_t)i * (size_t)n + (size_t)k];
      double *b = &vectors[(size_t)best * (size_t)n + (size_t)k], x = *a;
      *a = *b;
      *b = x;
    }
  }
}

void placido_dense_eigen(double *values, double *vectors, double *a, int n) {
  memset(vectors, 0, (size_t)n * (size_t)n * sizeof *vectors);
  for (int i = 0; i < n; i++) {
    vectors[(size_t)i * (size_t)(n + 1)] = 1;
  }
  for (int i = 0; i < SWEEPS && sweep(a, vectors, n); i++) {
  }
  for (int i = 0; i < n; i++) {
    values[i] = a[(size_t)i * (size_t)(n + 1)];
  }
  sort(values, vectors, n);
}
