/* The dense algebra: factors multiply back, solutions solve, eigenvectors stay what they are. */
#include "acquire/calibrate/dense.h"
#include "base/dense.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

#define N 5

/* 1/(i + j + 1), Hilbert's: positive definite and as ill-conditioned (5e5) as real ones. */
static void hilbert(double a[N * N]) {
  for (int i = 0; i < N * N; i++) {
    a[i] = 1.0 / (i / N + i % N + 1);
  }
}

static void a_solution_solves(void **state) {
  (void)state;
  double a[N * N], l[N * N], inverse[N * N], b[N] = {1, -2, 3, 0, 5}, x[N];
  hilbert(a);
  memcpy(l, a, sizeof l);
  memcpy(x, b, sizeof x);
  assert_true(placido_dense_factor(l, N, N, 0));
  placido_dense_solve(l, N, N, x);
  placido_dense_inverse(inverse, l, N);
  for (int i = 0; i < N; i++) {
    double back = 0, by_inverse = 0;
    for (int j = 0; j < N; j++) {
      back += a[N * i + j] * x[j];
      by_inverse += inverse[N * i + j] * b[j];
    }
    assert_true(fabs(back - b[i]) < 1e-8); /* rounding times the condition of 5e5 */
    assert_true(fabs(by_inverse / x[i] - 1) < 1e-8);
  }
}

static void what_is_not_positive_has_no_factor(void **state) {
  (void)state;
  double a[4] = {1, 2, 2, 1};
  assert_false(placido_dense_factor(a, 2, 2, 0));
}

static void eigenvectors_keep_their_direction(void **state) {
  (void)state;
  double a[N * N], copy[N * N], values[N], vectors[N * N];
  hilbert(a);
  memcpy(copy, a, sizeof copy);
  placido_dense_eigen(values, vectors, copy, N);
  for (int m = 0; m < N; m++) {
    assert_true(m == 0 || values[m] <= values[m - 1]);
    for (int i = 0; i < N; i++) {
      double turned = 0;
      for (int j = 0; j < N; j++) {
        turned += a[N * i + j] * vectors[N * m + j];
      }
      assert_true(fabs(turned - values[m] * vectors[N * m + i]) < 1e-14);
    }
  }
  assert_true(fabs(values[0] - 1.56705069109823) < 1e-13); /* of Hilbert's matrix of order 5 */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_solution_solves),
      cmocka_unit_test(what_is_not_positive_has_no_factor),
      cmocka_unit_test(eigenvectors_keep_their_direction),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
