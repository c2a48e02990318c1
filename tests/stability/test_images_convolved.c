/* Planes of any shape spread by point spread functions of any shape, in float and in double: what
 * the transforms leave is rounding, whatever the light and wherever it is.
 *
 * The bound of every row is rounding_bound of planes.h: epsilon log2 N for each of three
 * transforms, as a norm of all errors together. The largest of the errors, and their sum over the
 * root of their number (Cauchy and Schwarz), are no larger. */
#include "tests/simulate/planes.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"
#include "tests/support/near.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { WIDE = 129, SIDE = 16384 };

static const struct {
  int width, height;
} sizes[] = {{1, 1}, {1, 13}, {13, 1}, {97, 89}, {SIDE, 1}, {1, SIDE}, {8191, 2}};

enum { SIZES = sizeof sizes / sizeof *sizes };

/* Noise; all light in one corner but a trace; a needle on a wide veil. */
enum kernel { NOISE, CORNER, NEEDLE, KERNELS };

static const char *const kernel_names[KERNELS] = {"noise", "a corner", "needle and veil"};

static placido_psf kernel_of(double *values, int n, enum kernel kernel) {
  placido_psf psf = noise_psf(values, n, 5);
  if (kernel == CORNER) {
    memset(values, 0, (size_t)n * (size_t)n * sizeof *values);
    values[0] = 1 - 1e-6;
    values[n * n / 2] = 1e-6;
  } else if (kernel == NEEDLE) {
    for (int i = 0; i < n * n; i++) {
      values[i] = 0.1 / (n * n);
    }
    values[n * n / 2] += 0.9;
  }
  return psf;
}

static double epsilon_of(bool doubles) { return doubles ? DBL_EPSILON : FLT_EPSILON; }

/* Planes are of floats: what double precision finds is rounded once more, at most half a unit of
 * every sample, and of these none is larger than the light that meets it. */
static double bound_of(const float *source, int width, int height, const placido_psf *psf,
                       bool doubles) {
  double squares = 0, gain = 0;
  for (int i = 0; i < width * height; i++) {
    squares += (double)source[i] * (double)source[i];
  }
  for (int i = 0; i < psf->n * psf->n; i++) {
    gain += fabs(psf->values[i]);
  }
  return rounding_bound(source, width, height, psf, epsilon_of(doubles)) +
         0.5 * FLT_EPSILON * gain * sqrt(squares);
}

/* Root of the sum of squared errors against the sum written out, over every `step`-th sample. */
static double error_of(const float *found, const float *source, int width, int height,
                       const placido_psf *psf, int step) {
  double squares = 0;
  for (int i = 0; i < width * height; i += step) {
    double off = (double)found[i] - direct_sum(source, width, height, psf, i % width, i / width);
    squares += off * off;
  }
  return sqrt(squares);
}

static void results_are_the_sum_written_out(void **state) {
  (void)state;
  static double values[WIDE * WIDE];
  for (int doubles = 0; doubles < 2; doubles++) {
    const placido_convolution how = {.doubles = doubles};
    for (int k = 0; k < KERNELS; k++) {
      for (int i = 0; i < SIZES; i++) {
        const int width = sizes[i].width, height = sizes[i].height;
        const int n = k == NOISE && width * height > 200 ? 31 : WIDE; /* wider than most planes */
        placido_psf psf = kernel_of(values, n, (enum kernel)k);
        float *source = noise_plane(width, height, 7);
        float *found = convolved_plane(source, width, height, &psf, &how);
        double error = error_of(found, source, width, height, &psf, 1 + width * height / 900);
        case_bounded(&(struct bounded){1, epsilon_of(doubles), NULL, error, NULL,
                                       bound_of(source, width, height, &psf, doubles)},
                     "%s, %d by %d, %s", kernel_names[k], width, height,
                     doubles ? "double" : "float");
        free(source);
        free(found);
      }
    }
  }
}

/* Dark stays dark to the bit; saturated light of 1e12 whites rounds as light of 1 does. */
static void dark_and_saturated_planes(void **state) {
  (void)state;
  enum { W = 61, H = 53 };
  static double values[WIDE * WIDE];
  placido_psf psf = kernel_of(values, WIDE, NEEDLE);
  float *plane = calloc((size_t)W * H, sizeof *plane);
  assert_non_null(plane);
  float *found = convolved_plane(plane, W, H, &psf, NULL);
  double most = 0;
  for (int i = 0; i < W * H; i++) {
    most = fmax(most, fabs((double)found[i]));
  }
  case_bounded(&(struct bounded){1, 0, NULL, most, NULL, 0}, "all black");
  free(found);
  for (int i = 0; i < W * H; i++) {
    plane[i] = 1e12f;
  }
  found = convolved_plane(plane, W, H, &psf, NULL);
  assert_int_equal(count_spoilt(found, (size_t)W * H), 0);
  case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, error_of(found, plane, W, H, &psf, 7), NULL,
                                 bound_of(plane, W, H, &psf, false)},
               "all saturated, 1e12 of white");
  free(found);
  free(plane);
}

/* Noise in the middle of a plane, moved by (dx, dy): so far from the rim that no light leaves. */
static float *island(int side, int margin, int dx, int dy) {
  float *plane = calloc((size_t)side * (size_t)side, sizeof *plane);
  float *noise = noise_plane(side, side, 3);
  assert_non_null(plane);
  for (int y = margin; y < side - margin; y++) {
    for (int x = margin; x < side - margin; x++) {
      plane[(y + dy) * side + x + dx] = noise[y * side + x];
    }
  }
  free(noise);
  return plane;
}

static double sum_of(const float *plane, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += (double)plane[i];
  }
  return sum;
}

/* No light is lost or made: |sum of errors| <= root of their number times their norm. */
static void light_is_kept(void **state) {
  (void)state;
  enum { S = 211, MARGIN = 70 };
  static double values[WIDE * WIDE];
  for (int k = 0; k < KERNELS; k++) {
    placido_psf psf = kernel_of(values, WIDE, (enum kernel)k);
    float *source = island(S, MARGIN, 0, 0);
    float *found = convolved_plane(source, S, S, &psf, NULL);
    double all = sum_of(source, S * S), least = INFINITY;
    for (int i = 0; i < S * S; i++) {
      least = fmin(least, (double)found[i]);
    }
    double bound = bound_of(source, S, S, &psf, false);
    case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, fabs(sum_of(found, S * S) - all), NULL,
                                   S * bound},
                 "light kept, %s", kernel_names[k]);
    case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, fmax(-least, 0), NULL, bound},
                 "light below 0, %s", kernel_names[k]);
    free(source);
    free(found);
  }
}

/* A moved plane has a moved result, each with its own rounding. */
static void shifts_go_through(void **state) {
  (void)state;
  enum { S = 173, MARGIN = 76, DX = 11, DY = -7 };
  static double values[WIDE * WIDE];
  for (int k = 0; k < KERNELS; k++) {
    placido_psf psf = kernel_of(values, WIDE, (enum kernel)k);
    float *here = island(S, MARGIN, 0, 0), *there = island(S, MARGIN, DX, DY);
    float *one = convolved_plane(here, S, S, &psf, NULL);
    float *other = convolved_plane(there, S, S, &psf, NULL);
    double squares = 0;
    for (int y = 7; y < S; y++) {
      for (int x = 0; x < S - DX; x++) {
        double off = (double)other[(y + DY) * S + x + DX] - (double)one[y * S + x];
        squares += off * off;
      }
    }
    case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, sqrt(squares), NULL,
                                   2 * bound_of(here, S, S, &psf, false)},
                 "shift, %s", kernel_names[k]);
    free(here);
    free(there);
    free(one);
    free(other);
  }
}

/* Twice the light is twice the result to the bit, as doubling is exact; sums add up to rounding. */
static void results_are_linear(void **state) {
  (void)state;
  enum { W = 89, H = 31 };
  static double values[WIDE * WIDE];
  placido_psf psf = kernel_of(values, WIDE, NOISE);
  float *a = noise_plane(W, H, 1), *b = noise_plane(W, H, 2), *both = noise_plane(W, H, 3);
  float *twice = noise_plane(W, H, 4);
  for (int i = 0; i < W * H; i++) {
    b[i] = floorf(b[i] * 1024) / 1024; /* so that the sum is exact */
    a[i] = floorf(a[i] * 1024) / 1024;
    both[i] = a[i] + b[i];
    twice[i] = 2 * a[i];
  }
  float *of_a = convolved_plane(a, W, H, &psf, NULL), *of_b = convolved_plane(b, W, H, &psf, NULL);
  float *of_both = convolved_plane(both, W, H, &psf, NULL);
  float *of_twice = convolved_plane(twice, W, H, &psf, NULL);
  double worst = 0, squares = 0;
  for (int i = 0; i < W * H; i++) {
    worst = fmax(worst, fabs((double)of_twice[i] - 2 * (double)of_a[i]));
    double off = (double)of_both[i] - (double)of_a[i] - (double)of_b[i];
    squares += off * off;
  }
  case_bounded(&(struct bounded){1, 0, NULL, worst, NULL, 0}, "twice the light");
  case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, sqrt(squares), NULL,
                                 bound_of(a, W, H, &psf, false) + bound_of(b, W, H, &psf, false) +
                                   bound_of(both, W, H, &psf, false)},
               "sum of two planes");
  float *planes[] = {a, b, both, twice, of_a, of_b, of_both, of_twice};
  for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) {
    free(planes[i]);
  }
}

/* One bucket is no sum at all: the plane moves, and where it leaves nothing comes in. */
static void one_bucket_moves_the_plane(void **state) {
  (void)state;
  static double values[WIDE * WIDE];
  for (int i = 0; i < SIZES; i++) {
    const int width = sizes[i].width, height = sizes[i].height, half = WIDE / 2;
    memset(values, 0, sizeof values);
    values[(half + 2) * WIDE + half - 3] = 0.5;
    const placido_psf psf = {.n = WIDE, .bucket_arcmin = 0.5, .values = values};
    float *source = noise_plane(width, height, 7);
    float *found = convolved_plane(source, width, height, &psf, NULL);
    double worst = 0;
    for (int y = 0; y < height; y++) {
      for (int x = 0; x < width; x++) {
        bool within = x + 3 < width && y >= 2;
        double right = within ? 0.5 * (double)source[(y - 2) * width + x + 3] : 0;
        worst = fmax(worst, fabs((double)found[y * width + x] - right));
      }
    }
    case_bounded(&(struct bounded){1, 0, NULL, worst, NULL, 0}, "one bucket aside, %d by %d", width,
                 height);
    free(source);
    free(found);
  }
}

static void psfs_that_are_none_are_refused(void **state) {
  (void)state;
  const double bad[] = {NAN, INFINITY, -INFINITY};
  placido_convolver *convolver;
  assert_int_equal(placido_convolver_new(&convolver, 8, 8, 1, NULL, NULL, NULL), PLACIDO_OK);
  for (int i = 0; i < 3; i++) {
    double values[9] = {0, 0, 0, 0, 1, 0, 0, bad[i], 0};
    const placido_psf psf = {.n = 3, .bucket_arcmin = 0.5, .values = values};
    placido_transfer *transfer;
    placido_error err = {0};
    int status = placido_transfer_new(&transfer, convolver, &psf, &err);
    case_refused(status, PLACIDO_INPUT, &err, "bucket 1 of row 2", "%g in a PSF", bad[i]);
    assert_null(transfer);
  }
  placido_convolver_free(convolver);
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Images: convolution"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(results_are_the_sum_written_out), cmocka_unit_test(dark_and_saturated_planes),
    cmocka_unit_test(light_is_kept),                   cmocka_unit_test(shifts_go_through),
    cmocka_unit_test(results_are_linear),              cmocka_unit_test(one_bucket_moves_the_plane),
    cmocka_unit_test(psfs_that_are_none_are_refused),  cmocka_unit_test(the_table_is_good)};
  return cmocka_run_group_tests_name("stability_images_convolved", tests, NULL, NULL);
}
