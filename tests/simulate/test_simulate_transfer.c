/* Convolution of planes: what the sum says within a bound from the transforms' rounding, in tiles,
 * in sums of terms, and by any number of threads. */
#include "base/memory.h"
#include "simulate/convolve/layout.h"
#include "tests/simulate/planes.h"
#include "tests/support/near.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static const double float_unit = FLT_EPSILON / 2, double_unit = DBL_EPSILON / 2;
static const double half_a_step = 1.0 / 510; /* of a picture of 8 bits */

/* Root of the sum of squared differences from the direct sum; the result was rounded to float. */
static double root_error(const float *result, const float *source, int width, int height,
                         const placido_psf *psf) {
  double sum = 0;
  for (int y = 0; y < height; y++) {
    for (int x = 0; x < width; x++) {
      double error = (double)result[y * width + x] - direct_sum(source, width, height, psf, x, y);
      sum += error * error;
    }
  }
  return sqrt(sum);
}

static double root_of_squares(const float *plane, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += (double)plane[i] * (double)plane[i];
  }
  return sqrt(sum);
}

/* Prime sides, one row, one column, one pixel, a PSF wider than the plane in one or both ways, and
 * one of a single bucket's width less. */
static void test_result_is_the_sum_within_the_rounding_of_transforms(void **state) {
  (void)state;
  const int sizes[][3] = {{53, 47, 31}, {101, 3, 31}, {97, 1, 31}, {1, 89, 31}, {1, 1, 31},
                          {2, 2, 31},   {16, 15, 31}, {17, 16, 3}, {64, 64, 1}, {5, 61, 51}};
  static double values[51 * 51];
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    int width = sizes[i][0], height = sizes[i][1];
    placido_psf psf = noise_psf(values, sizes[i][2], 3);
    float *source = noise_plane(width, height, 7);
    for (int doubles = 0; doubles < 2; doubles++) {
      const placido_convolution how = {.doubles = doubles};
      float *result = convolved_plane(source, width, height, &psf, &how);
      double bound =
          rounding_bound(source, width, height, &psf, doubles ? double_unit : float_unit);
      double stored = float_unit * root_of_squares(result, width * height);
      double error = root_error(result, source, width, height, &psf);
      assert_true(error <= bound + stored);
      assert_true(bound < half_a_step);
      free(result);
    }
    free(source);
  }
}

/* What single precision costs, measured: less than a thousandth of a step of 8 bits. */
static void test_single_precision_is_far_below_what_a_picture_shows(void **state) {
  (void)state;
  static double values[129 * 129];
  const placido_convolution single = {.doubles = false}, exact = {.doubles = true};
  placido_psf psf = noise_psf(values, 129, 5);
  float *source = noise_plane(500, 250, 7);
  float *one = convolved_plane(source, 500, 250, &psf, &single);
  float *other = convolved_plane(source, 500, 250, &psf, &exact);
  double most = 0;
  for (int i = 0; i < 500 * 250; i++) {
    most = fmax(most, fabs((double)one[i] - (double)other[i]));
  }
  print_message("float against double: at most %.2g\n", most);
  assert_true(most > 0);
  assert_true(most < half_a_step / 1000);
  free(one);
  free(other);
  free(source);
}

/* A bright spot above and to the left of the middle, a dim one below: so are the ghosts. */
static void test_ghosts_stand_where_the_psf_has_them(void **state) {
  (void)state;
  double values[49] = {0};
  values[1 * 7 + 2] = 0.75;
  values[6 * 7 + 3] = 0.25;
  const placido_psf psf = {.n = 7, .bucket_arcmin = 0.5, .values = values};
  float *source = calloc(20 * 30, sizeof *source);
  assert_non_null(source);
  source[12 * 20 + 9] = 1;
  float *result = convolved_plane(source, 20, 30, &psf, NULL);
  for (int i = 0; i < 20 * 30; i++) {
    double expected = i == 10 * 20 + 8 ? 0.75 : i == 15 * 20 + 9 ? 0.25 : 0;
    assert_near(result[i], expected, 1e-6);
  }
  free(result);
  free(source);
}

static void test_light_is_kept_where_none_leaves(void **state) {
  (void)state;
  static double values[31 * 31];
  placido_psf psf = noise_psf(values, 31, 3);
  float *source = noise_plane(90, 70, 7);
  double before = 0, after = 0;
  for (int i = 0; i < 90 * 70; i++) {
    bool rim = i % 90 < 15 || i % 90 >= 75 || i / 90 < 15 || i / 90 >= 55;
    source[i] = rim ? 0 : source[i];
    before += (double)source[i];
  }
  float *result = convolved_plane(source, 90, 70, &psf, NULL);
  for (int i = 0; i < 90 * 70; i++) {
    after += (double)result[i];
  }
  assert_near(after / before, 1, 1e-6); /* the sum is one sample of the transform */
  free(result);
  free(source);
}

static void test_twice_one_plane_and_half_another_is_spread_likewise(void **state) {
  (void)state;
  static double values[31 * 31];
  placido_psf psf = noise_psf(values, 31, 3);
  float *a = noise_plane(60, 50, 1), *b = noise_plane(60, 50, 2), *sum = noise_plane(60, 50, 3);
  for (int i = 0; i < 60 * 50; i++) {
    sum[i] = 2 * a[i] + b[i] / 2;
  }
  float *spread_a = convolved_plane(a, 60, 50, &psf, NULL);
  float *spread_b = convolved_plane(b, 60, 50, &psf, NULL);
  float *spread_sum = convolved_plane(sum, 60, 50, &psf, NULL);
  double bound = 3 * rounding_bound(sum, 60, 50, &psf, float_unit);
  for (int i = 0; i < 60 * 50; i++) {
    assert_near(spread_sum[i], 2 * spread_a[i] + spread_b[i] / 2, bound);
  }
  free(a);
  free(b);
  free(sum);
  free(spread_a);
  free(spread_b);
  free(spread_sum);
}

/* Terms with PSFs of their own, one of them a mere shift: the sum is that of the terms alone. */
static void test_terms_add_up(void **state) {
  (void)state;
  static double wide[31 * 31], narrow[9 * 9];
  double shift[81] = {0};
  shift[2 * 9 + 7] = 0.5;
  const placido_psf psfs[] = {
      noise_psf(wide, 31, 1), {.n = 9, .values = shift}, noise_psf(narrow, 9, 2)};
  const placido_convolution cut = {.memory_MB = 0.02, .threads = 3};
  const placido_convolution *hows[] = {NULL, &cut};
  float *sources[] = {noise_plane(70, 64, 4), noise_plane(70, 64, 5), noise_plane(70, 64, 6)};
  for (int k = 0; k < 2; k++) {
    placido_convolver *convolver;
    placido_transfer *transfers[3];
    placido_convolution_term terms[3];
    float *result = noise_plane(70, 64, 9), *alone[3];
    assert_int_equal(placido_convolver_new(&convolver, 70, 64, 15, hows[k], NULL, NULL),
                     PLACIDO_OK);
    for (int i = 0; i < 3; i++) {
      assert_int_equal(placido_transfer_new(&transfers[i], convolver, &psfs[i], NULL), PLACIDO_OK);
      terms[i] = (placido_convolution_term){sources[i], transfers[i]};
      alone[i] = convolved_plane(sources[i], 70, 64, &psfs[i], NULL);
    }
    const placido_superposition plane = {result, terms, 3};
    assert_int_equal(placido_convolver_run(convolver, &plane, 1, NULL), PLACIDO_OK);
    for (int i = 0; i < 70 * 64; i++) {
      assert_near(result[i], (double)alone[0][i] + (double)alone[1][i] + (double)alone[2][i],
                  2e-6); /* the largest is near 2, in single precision */
    }
    for (int i = 0; i < 3; i++) {
      placido_transfer_free(transfers[i]);
      free(alone[i]);
    }
    free(result);
    placido_convolver_free(convolver);
  }
  for (int i = 0; i < 3; i++) {
    free(sources[i]);
  }
}

/* Any place of the light, and none at all: no sample is rounded, in tiles or not. */
static void test_light_in_one_bucket_shifts_exactly(void **state) {
  (void)state;
  static double values[41 * 41];
  const placido_convolution cut = {.memory_MB = 0.01};
  const int places[][2] = {{20, 20}, {0, 0}, {40, 3}, {21, 40}, {7, 20}};
  float *source = noise_plane(67, 13, 7);
  for (int k = 0; k < 10; k++) {
    int column = places[k / 2][0], row = places[k / 2][1];
    const placido_psf psf = {.n = 41, .bucket_arcmin = 0.5, .values = values};
    values[row * 41 + column] = 0.5;
    float *result = convolved_plane(source, 67, 13, &psf, k % 2 ? &cut : NULL);
    for (int i = 0; i < 67 * 13; i++) {
      int x = i % 67 - (column - 20), y = i / 67 - (row - 20);
      bool inside = x >= 0 && x < 67 && y >= 0 && y < 13;
      assert_true(result[i] == (inside ? 0.5f * source[y * 67 + x] : 0.0f));
    }
    values[row * 41 + column] = 0;
    free(result);
  }
  float *dark = convolved_plane(source, 67, 13, &(placido_psf){.n = 41, .values = values}, NULL);
  for (int i = 0; i < 67 * 13; i++) {
    assert_true(dark[i] == 0.0f);
  }
  free(dark);
  free(source);
}

/* 16,384 pixels wide, with the least memory: places far apart against the direct sum. */
static void test_long_planes_are_right_everywhere(void **state) {
  (void)state;
  static double values[257 * 257];
  placido_psf psf = noise_psf(values, 257, 11);
  const placido_convolution hows[] = {{.memory_MB = 0}, {.memory_MB = 0.1, .threads = 2}};
  float *source = noise_plane(16384, 5, 7);
  double bound = rounding_bound(source, 16384, 5, &psf, float_unit);
  for (int k = 0; k < 2; k++) {
    float *result = convolved_plane(source, 16384, 5, &psf, &hows[k]);
    for (int x = 0; x < 16384; x += x < 300 || x > 16000 ? 13 : 467) {
      for (int y = 0; y < 5; y++) {
        assert_near(result[y * 16384 + x], direct_sum(source, 16384, 5, &psf, x, y),
                    bound + float_unit);
      }
    }
    free(result);
  }
  free(source);
}

static void test_tiles_give_what_the_whole_gives(void **state) {
  (void)state;
  static double values[31 * 31];
  const int sizes[][2] = {{301, 203}, {97, 500}, {700, 1}};
  placido_psf psf = noise_psf(values, 31, 3);
  for (int i = 0; i < 3; i++) {
    int width = sizes[i][0], height = sizes[i][1];
    float *source = noise_plane(width, height, 7);
    double bound = 2 * rounding_bound(source, width, height, &psf, float_unit);
    float *whole = convolved_plane(source, width, height, &psf, NULL);
    for (int knob = 0; knob < 9; knob++) {
      const placido_convolution how = {.memory_MB = knob < 6 ? 0.002 * pow(3, knob) : 0.02,
                                       .size_px = knob < 6 ? 0 : 50 << (2 * (knob - 6))};
      float *tiled = convolved_plane(source, width, height, &psf, &how);
      for (int k = 0; k < width * height; k++) {
        assert_near(tiled[k], whole[k], bound);
      }
      free(tiled);
    }
    free(whole);
    free(source);
  }
}

/* Every sample is in exactly one tile, and what it needs of the source is in the tile, too. */
static void test_tiles_cover_the_plane_and_fit_into_the_memory(void **state) {
  (void)state;
  const int cases[][3] = {{3840, 2160, 128}, {16384, 16384, 128}, {16384, 1, 128},    {1, 9000, 40},
                          {500, 250, 128},   {100, 100, 4000},    {65536, 65536, 500}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    for (double bytes = 1e6; bytes < 1e12; bytes *= 4) {
      int width = cases[i][0], height = cases[i][1], reach = cases[i][2];
      int least = i % 2 ? 1000 : 0;
      placido_layout layout = placido_layout_find(width, height, reach, bytes, least, 4);
      assert_true(layout.x.padded >= least && layout.y.padded >= least);
      const placido_axis *axes[] = {&layout.x, &layout.y};
      if (bytes >= 4e7) {
        assert_true(4.0 * layout.x.padded * layout.y.padded <= bytes);
      }
      for (int a = 0; a < 2; a++) {
        int next = 0, length = a == 0 ? width : height;
        int far = reach < length ? reach : length - 1;
        for (int k = 0; k < axes[a]->tiles; k++) {
          placido_stretch s = placido_axis_stretch(axes[a], k);
          int left = s.first > far ? s.first - far : 0;
          int right = s.first + s.count + far < length ? s.first + s.count + far : length;
          assert_int_equal(s.first, next);
          assert_true(s.count > 0 && s.used > 0 && s.at >= 0);
          assert_true(s.from <= left && s.from + s.used >= right);
          assert_true(s.at + s.used <= axes[a]->padded);
          assert_int_equal(s.lead - s.at, s.first - s.from);
          next += s.count;
        }
        assert_int_equal(next, length);
      }
    }
  }
}

static void test_threads_change_no_bit(void **state) {
  (void)state;
  static double values[31 * 31];
  placido_psf psf = noise_psf(values, 31, 3);
  float *source = noise_plane(300, 200, 7), *one = NULL;
  for (int threads = 1; threads <= 7; threads += 2) {
    const placido_convolution how = {.memory_MB = 0.05, .threads = threads};
    float *result = convolved_plane(source, 300, 200, &psf, &how);
    if (one != NULL) {
      assert_memory_equal(result, one, 300 * 200 * sizeof *one);
    }
    free(one);
    one = result;
  }
  free(one);
  free(source);
}

static void test_what_does_not_fit_is_refused(void **state) {
  (void)state;
  double values[25] = {0};
  const placido_psf psf = {.n = 5, .values = values}, even = {.n = 4, .values = values};
  const placido_convolution bad[] = {
      {.memory_MB = -1}, {.memory_MB = NAN}, {.threads = -1},
      {.threads = 257},  {.size_px = -1},    {.size_px = 16385}};
  placido_convolver *convolver;
  placido_transfer *transfer;
  const int sizes[][3] = {{0, 5, 1}, {5, 65537, 1}, {5, 5, -1}, {5, 5, 65537}};
  for (int i = 0; i < 4; i++) {
    assert_int_equal(
        placido_convolver_new(&convolver, sizes[i][0], sizes[i][1], sizes[i][2], NULL, NULL, NULL),
        PLACIDO_INPUT);
  }
  for (int i = 0; i < 6; i++) {
    assert_int_equal(placido_convolver_new(&convolver, 9, 9, 1, &bad[i], NULL, NULL),
                     PLACIDO_INPUT);
    assert_null(convolver);
  }
  assert_int_equal(placido_convolver_new(&convolver, 9, 9, 1, NULL, NULL, NULL), PLACIDO_OK);
  values[0] = 1;
  assert_int_equal(placido_psf_reach(&psf), 2);
  assert_int_equal(placido_transfer_new(&transfer, convolver, &psf, NULL), PLACIDO_INPUT);
  assert_int_equal(placido_transfer_new(&transfer, convolver, &even, NULL), PLACIDO_INPUT);
  values[0] = 0;
  values[12] = NAN;
  assert_int_equal(placido_transfer_new(&transfer, convolver, &psf, NULL), PLACIDO_INPUT);
  assert_null(transfer);
  placido_convolver_free(convolver);
  placido_convolver_free(NULL);
  placido_transfer_free(NULL);
}

/* Whichever allocation fails, it is said, and nothing is lost (the sanitizer sees leaks). */
static void test_lack_of_memory_is_reported(void **state) {
  (void)state;
  double values[9] = {0, 0.5, 0, 0, 0.5};
  const placido_psf psf = {.n = 3, .values = values};
  const placido_convolution how = {.threads = 2, .memory_MB = 0.001};
  float source[200] = {0}, target[200];
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status != PLACIDO_OK; n++) {
    placido_convolver *convolver;
    placido_transfer *transfer = NULL;
    assert_in_range(n, 1, 20);
    placido_memory_fail_at(n);
    status = placido_convolver_new(&convolver, 100, 2, 1, &how, NULL, NULL);
    if (status == PLACIDO_OK) {
      status = placido_transfer_new(&transfer, convolver, &psf, NULL);
    }
    if (status == PLACIDO_OK) {
      const placido_convolution_term term = {source, transfer};
      const placido_superposition plane = {target, &term, 1};
      status = placido_convolver_run(convolver, &plane, 1, NULL);
    }
    placido_transfer_free(transfer);
    placido_convolver_free(convolver);
    assert_true(status == PLACIDO_OK || status == PLACIDO_MEMORY);
    assert_true(n > 1 || status == PLACIDO_MEMORY);
  }
  placido_memory_fail_at(0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_result_is_the_sum_within_the_rounding_of_transforms),
      cmocka_unit_test(test_single_precision_is_far_below_what_a_picture_shows),
      cmocka_unit_test(test_ghosts_stand_where_the_psf_has_them),
      cmocka_unit_test(test_light_is_kept_where_none_leaves),
      cmocka_unit_test(test_twice_one_plane_and_half_another_is_spread_likewise),
      cmocka_unit_test(test_terms_add_up),
      cmocka_unit_test(test_light_in_one_bucket_shifts_exactly),
      cmocka_unit_test(test_long_planes_are_right_everywhere),
      cmocka_unit_test(test_tiles_give_what_the_whole_gives),
      cmocka_unit_test(test_tiles_cover_the_plane_and_fit_into_the_memory),
      cmocka_unit_test(test_threads_change_no_bit),
      cmocka_unit_test(test_what_does_not_fit_is_refused),
      cmocka_unit_test(test_lack_of_memory_is_reported),
  };
  return cmocka_run_group_tests_name("simulate_transfer", tests, NULL, NULL);
}
