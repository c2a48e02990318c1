/* Cholesky's factor and the solution with it (Golub & Van Loan, Matrix Computations, 4th ed.,
 * algorithm 4.2.2). */
#include "base/dense.h"

#include <math.h>

bool placido_dense_factor(double *a, int n, int stride, double singular) {
  for (int i = 0; i < n; i++) {
    double *row = a + (size_t)i * (size_t)stride;
    for (int j = 0; j <= i; j++) {
      const double *other = a + (size_t)j * (size_t)stride;
      double sum = row[j];
      for (int k = 0; k < j; k++) {
        sum -= row[k] * other[k];
      }
      if (j < i) {
        row[j] = sum / other[j];
      } else if (sum > singular * row[i]) {
        row[i] = sqrt(sum);
      } else {
        return false;
      }
    }
    for (int j = i + 1; j < n; j++) {
      row[j] = 0;
    }
  }
  return true;
}

void placido_dense_solve(const double *factor, int n, int stride, double *b) {
  for (int i = 0; i < n; i++) {
    const double *row = factor + (size_t)i * (size_t)stride;
    for (int k = 0; k < i; k++) {
      b[i] -= row[k] * b[k];
    }
    b[i] /= row[i];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++) {
      b[i] -= factor[(size_t)k * (size_t)stride + (size_t)i] * b[k];
    }
    b[i] /= factor[(size_t)i * (size_t)stride + (size_t)i];
  }
}
