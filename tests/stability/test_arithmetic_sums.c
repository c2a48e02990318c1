/* Long sums: Cholesky's factors, inverses, transforms and tallies, against extended precision. */
#include "tests/stability/exact.h"
#include "tests/stability/table.h"

#include "base/dense.h"
#include "reconstruct/solve/engine/band.h"
#include "tests/simulate/planes.h"

#include <float.h>
#include <math.h>
#include <placido/phantom.h>
#include <placido/psf.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static void add_row(const char *name, double condition, double error_ulp, double bound_ulp) {
  const struct stability_row row = {.name = name,
                                    .condition = condition,
                                    .perturbation = 0.5,
                                    .in_unit = "ulp",
                                    .change = error_ulp,
                                    .out_unit = "ulp",
                                    .bound = bound_ulp,
                                    .extended = error_ulp};
  stability_add(&row);
}

/* A symmetric matrix of `count` rows, `width` entries from the diagonal on, as it is in double. */
struct matrix {
  int count, width;
  quad *entries;
};

static quad *entry(const struct matrix *m, int row, int column) {
  int top = row > column ? row : column, low = row + column - top;
  return m->entries + (size_t)low * (size_t)m->width + (size_t)(top - low);
}

/* What the fit's penalty is along one axis: squares of third differences, and `floor` on the
 * diagonal. Its largest eigenvalue is below 64, so that its condition is 64 over the floor at most.
 */
static struct matrix differences(int count, int width, double floor) {
  static const double difference[4] = {-1, 3, -3, 1};
  struct matrix m = {count, width, calloc((size_t)(count * width), sizeof *m.entries)};
  assert_non_null(m.entries);
  for (int at = 0; at + 3 < count; at++) {
    for (int i = 0; i < 4; i++) {
      for (int j = i; j < 4; j++) {
        *entry(&m, at + j, at + i) += difference[i] * difference[j];
      }
    }
  }
  for (int i = 0; i < count; i++) {
    for (int j = i; j < count && j < i + width; j++) { /* and a little of everything */
      *entry(&m, j, i) += floor * (i == j ? 1 : 1e-3 * sin(3 * i + 5 * j));
      *entry(&m, j, i) = (double)*entry(&m, j, i);
    }
  }
  return m;
}

static void factorise(struct matrix *m) {
  for (int j = 0; j < m->count; j++) {
    int end = j + m->width < m->count ? j + m->width : m->count;
    quad pivot = sqrtq(*entry(m, j, j));
    for (int i = j; i < end; i++) {
      *entry(m, i, j) /= pivot;
    }
    for (int k = j + 1; k < end; k++) {
      for (int i = k; i < end; i++) {
        *entry(m, i, k) -= *entry(m, i, j) * *entry(m, k, j);
      }
    }
  }
}

static void solve(const struct matrix *factor, quad *x) {
  for (int j = 0; j < factor->count; j++) {
    x[j] /= *entry(factor, j, j);
    for (int i = j + 1; i < factor->count && i < j + factor->width; i++) {
      x[i] -= *entry(factor, i, j) * x[j];
    }
  }
  for (int j = factor->count - 1; j >= 0; j--) {
    for (int i = j + 1; i < factor->count && i < j + factor->width; i++) {
      x[j] -= *entry(factor, i, j) * x[i];
    }
    x[j] /= *entry(factor, j, j);
  }
}

static quad length_of(const quad *x, int count) {
  quad sum = 0;
  for (int i = 0; i < count; i++) {
    sum += x[i] * x[i];
  }
  return sqrtq(sum);
}

/* The largest eigenvalue of the inverse, by power iteration: never more than it is. */
static double inverse_norm(const struct matrix *factor) {
  quad *x = calloc((size_t)factor->count, sizeof *x), norm = 0;
  assert_non_null(x);
  for (int i = 0; i < factor->count; i++) {
    x[i] = 1 + 0.5 * sin(i);
  }
  for (int step = 0; step < 40; step++) {
    norm = length_of(x, factor->count);
    for (int i = 0; i < factor->count; i++) {
      x[i] /= norm;
    }
    solve(factor, x);
  }
  norm = length_of(x, factor->count);
  free(x);
  return (double)norm;
}

/* Factor and solution are those of a matrix that differs by γ |L| |Lᵀ|, γ = (3 w + 1) u for w
 * entries a row (Higham, theorem 10.4), which in the norm is at most w γ |A|; so the solution is
 * off by w (3 w + 1) u times the condition. The inverse within the band is made of as many
 * operations on the same factor, twice over: from either side. */
static void compare_band(int count, int width, double floor) {
  struct matrix m = differences(count, width, floor);
  placido_band band, inverse;
  double *x = calloc((size_t)count, sizeof *x);
  quad *exact = calloc((size_t)count, sizeof *exact);
  assert_int_equal(placido_band_new(&band, count, width, NULL), PLACIDO_OK);
  for (int j = 0; j < count; j++) {
    for (int i = j; i < count && i < j + width; i++) {
      placido_band_column(&band, j)[i - j] = (double)*entry(&m, i, j);
    }
    x[j] = cos(0.1 * j * j);
    exact[j] = x[j];
  }
  factorise(&m);
  assert_true(placido_band_factorise(&band));
  assert_int_equal(placido_band_solve(&band, x, 1, NULL), PLACIDO_OK);
  solve(&m, exact);
  double smallest = inverse_norm(&m), condition = 64 * smallest,
         size = (double)length_of(exact, count);
  quad error = 0, worst = 0;
  for (int i = 0; i < count; i++) {
    error += (x[i] - exact[i]) * (x[i] - exact[i]);
  }
  double bound = 0.5 * width * (3 * width + 1) * condition;
  char name[64];
  snprintf(name, sizeof name, "Cholesky, %d rows of %d", count, width);
  add_row(name, condition, (double)sqrtq(error) / size / DBL_EPSILON, bound);
  assert_int_equal(placido_band_inverse(&inverse, &band, NULL), PLACIDO_OK);
  for (int j = 0; j < count; j += 17) {
    memset(exact, 0, (size_t)count * sizeof *exact);
    exact[j] = 1;
    solve(&m, exact);
    for (int i = j; i < count && i < j + width; i++) {
      worst = fmaxq(worst, fabsq(placido_band_column(&inverse, j)[i - j] - exact[i]));
    }
  }
  snprintf(name, sizeof name, "inverse in the band, %d rows of %d", count, width);
  add_row(name, condition, (double)worst / smallest / DBL_EPSILON, 2 * bound);
  placido_band_free(&inverse);
  placido_band_free(&band);
  free(m.entries);
  free(exact);
  free(x);
}

static void bands(void **state) {
  (void)state;
  compare_band(200, 8, 10);
  compare_band(200, 8, 1e-4);
  compare_band(200, 13, 1e-10);
  compare_band(300, 60, 1e-7);
}

/* The same for small whole matrices: of Hilbert's, whose condition grows by 30 a row. */
static void dense_systems(void **state) {
  (void)state;
  for (int n = 3; n <= 9; n += 3) {
    struct matrix m = {n, n, calloc((size_t)(n * n), sizeof *m.entries)};
    double a[81], b[9], condition;
    quad exact[9], error = 0, trace = 0;
    for (int i = 0; i < n; i++) {
      for (int j = 0; j <= i; j++) {
        a[i * n + j] = 1 / (i + j + 1.0);
        *entry(&m, i, j) = a[i * n + j];
      }
      b[i] = i % 2 ? -1 : 1;
      exact[i] = b[i];
      trace += a[i * n + i];
    }
    factorise(&m);
    solve(&m, exact);
    assert_true(placido_dense_factor(a, n, n, 0));
    placido_dense_solve(a, n, n, b);
    for (int i = 0; i < n; i++) {
      error += (b[i] - exact[i]) * (b[i] - exact[i]);
    }
    condition = (double)trace * inverse_norm(&m);
    char name[64];
    snprintf(name, sizeof name, "Cholesky, Hilbert's matrix of %d", n);
    add_row(name, condition, (double)(sqrtq(error) / length_of(exact, n)) / DBL_EPSILON,
            0.5 * n * (3 * n + 1) * condition);
    free(m.entries);
  }
}

/* A transform of N samples is off by log2 N times η in the root mean square, η = u + γ4 (√2 + u) <
 * 7 u (Higham, theorem 24.2). Three of them, of source, PSF and product: the errors of source and
 * product pass the PSF's gain, at most the sum of its buckets, that of the PSF the source's. In
 * double the result is still rounded to float. */
static void convolutions(void **state) {
  (void)state;
  enum { WIDTH = 90, HEIGHT = 60, BUCKETS = 31 };
  static const char *const names[2] = {"convolution in float", "convolution in double"};
  double values[BUCKETS * BUCKETS], size = 0;
  float *source = noise_plane(WIDTH, HEIGHT, 5);
  placido_psf psf = noise_psf(values, BUCKETS, 8);
  for (int doubles = 0; doubles < 2; doubles++) {
    const placido_convolution how = {.doubles = doubles};
    float *found = convolved_plane(source, WIDTH, HEIGHT, &psf, &how);
    double error = 0, u = doubles ? DBL_EPSILON / 2 : FLT_EPSILON / 2.0;
    size = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
      quad sum = 0;
      int x = i % WIDTH, y = i / WIDTH;
      for (int k = 0; k < BUCKETS * BUCKETS; k++) {
        int from_x = x - (k % BUCKETS - BUCKETS / 2), from_y = y - (k / BUCKETS - BUCKETS / 2);
        if (from_x >= 0 && from_x < WIDTH && from_y >= 0 && from_y < HEIGHT) {
          sum += (quad)values[k] * (double)source[from_y * WIDTH + from_x];
        }
      }
      size += (double)(sum * sum);
      error += (double)((found[i] - sum) * (found[i] - sum));
    }
    size = sqrt(size);
    double bound = 7 * rounding_bound(source, WIDTH, HEIGHT, &psf, u) +
                   (doubles ? FLT_EPSILON / 2.0 * size : 0);
    add_row(names[doubles], 1, sqrt(error) / size / FLT_EPSILON, bound / size / FLT_EPSILON);
    free(found);
  }
  free(source);
}

/* Light is counted in whole units: only the quotient of a bucket and the whole is rounded, by u,
 * and the whole by 2 u more. */
static void light_is_kept(void **state) {
  (void)state;
  static const char *const eyes[] = {"normal", "keratoconus"};
  for (size_t e = 0; e < 2; e++) {
    for (int light = 0; light < 2; light++) {
      placido_surface *surface;
      placido_psf psf;
      const placido_eye eye = {.pupil_mm = 5, .correct = PLACIDO_CORRECT_FULL};
      const placido_optics optics = {.samples = 100,
                                     .light = light ? PLACIDO_LIGHT_COUNTED : PLACIDO_LIGHT_SPREAD};
      assert_int_equal(placido_phantom_eye(&surface, eyes[e], NULL), PLACIDO_OK);
      assert_int_equal(placido_psf_new(&psf, NULL, surface, &eye, &optics, NULL, NULL), PLACIDO_OK);
      quad sum = 0, share = (quad)psf.rays_landed / psf.rays_entered;
      for (int i = 0; i < psf.n * psf.n; i++) {
        sum += psf.values[i];
      }
      char name[64];
      snprintf(name, sizeof name, "sum of a PSF, %s, light %s", eyes[e],
               light ? "counted" : "spread");
      add_row(name, 1, (double)fabsq(sum / share - 1) / DBL_EPSILON, 1.5);
      placido_psf_free(&psf);
      placido_surface_free(surface);
    }
  }
}

static void every_error_is_within(void **state) {
  (void)state;
  assert_int_equal(stability_print("arithmetic: sums"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bands),
      cmocka_unit_test(dense_systems),
      cmocka_unit_test(convolutions),
      cmocka_unit_test(light_is_kept),
      cmocka_unit_test(every_error_is_within),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
