/* Resampling: light is kept, straight ramps stay straight, odd sizes work. */
#include "simulate/resample.h"
#include "tests/support/near.h"

#include <math.h>
#include <string.h>

static placido_image empty(int width_px, int height_px, int planes) {
  placido_image image;
  assert_int_equal(placido_image_new(&image, width_px, height_px, planes, NULL), PLACIDO_OK);
  return image;
}

static const enum placido_resampling both[] = {PLACIDO_RESAMPLING_AREA,
                                               PLACIDO_RESAMPLING_BICUBIC};

/* Each target pixel is the mean of what it covers: 2.5 source pixels of a row 0, 1, 2, ... */
static void test_area_is_the_mean_of_what_is_covered(void **state) {
  (void)state;
  placido_image source = empty(10, 1, 1), target = empty(4, 1, 1);
  for (int i = 0; i < 10; i++) {
    source.data[i] = (float)i;
  }
  assert_int_equal(placido_resample(&target, &source, 0, 0, 2.5, PLACIDO_RESAMPLING_AREA, 1, NULL),
                   PLACIDO_OK);
  assert_near(target.data[0], (0 + 1 + 0.5 * 2) / 2.5, 1e-6);
  assert_near(target.data[1], (0.5 * 2 + 3 + 4) / 2.5, 1e-6);
  assert_near(target.data[3], (0.5 * 7 + 8 + 9) / 2.5, 1e-6);
  placido_image_free(&source);
  placido_image_free(&target);
}

/* A single bright pixel keeps its light, wherever it falls, at any step: area exactly, bicubic as
 * its weights are made to sum to 1 for each target pixel, to the ripple of the sampled cubic. */
static void test_light_is_kept(void **state) {
  (void)state;
  const double steps[] = {1.37, 2, 3.9, 0.4};
  for (int k = 0; k < 2; k++) {
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
      placido_image source = empty(61, 53, 1);
      int width = (int)ceil(61 / steps[i]), height = (int)ceil(53 / steps[i]);
      placido_image target = empty(width, height, 1);
      source.data[26 * 61 + 30] = 1;
      assert_int_equal(placido_resample(&target, &source, 0, 0, steps[i], both[k], 1, NULL),
                       PLACIDO_OK);
      double sum = 0;
      for (int p = 0; p < width * height; p++) {
        sum += target.data[p];
      }
      assert_near(sum * steps[i] * steps[i], 1, k == 0 ? 1e-6 : 0.02);
      placido_image_free(&source);
      placido_image_free(&target);
    }
  }
}

/* Away from the rim a ramp is a ramp: pixel i covers from left + i * step, so its middle has that
 * value. Source pixels are steps, not a slope: cut in the middle at both ends they are off by 1/8
 * over the step's length. */
static void test_ramps_stay_in_place(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    placido_image source = empty(101, 1, 1), target = empty(36, 1, 1);
    for (int i = 0; i < 101; i++) {
      source.data[i] = (float)(i + 0.5);
    }
    assert_int_equal(placido_resample(&target, &source, 0.3, 0, 2.75, both[k], 1, NULL),
                     PLACIDO_OK);
    for (int i = 3; i < 33; i++) {
      assert_near(target.data[i], 0.3 + (i + 0.5) * 2.75, k == 0 ? 0.125 / 2.75 + 1e-5 : 0.02);
    }
    placido_image_free(&source);
    placido_image_free(&target);
  }
}

/* A line pattern finer than the target cannot alias: a cosine of period 2.2 pixels over steps of 4
 * is grey within 2 % (bicubic) where taking every fourth pixel would swing from 0 to 1. */
static void test_bicubic_does_not_alias(void **state) {
  (void)state;
  const double pi = acos(-1);
  placido_image source = empty(400, 1, 1), target = empty(100, 1, 1);
  for (int i = 0; i < 400; i++) {
    source.data[i] = (float)(0.5 + 0.5 * cos(2 * pi * i / 2.2));
  }
  assert_int_equal(
    placido_resample(&target, &source, 0, 0, 4, PLACIDO_RESAMPLING_BICUBIC, 1, NULL), PLACIDO_OK);
  for (int i = 3; i < 97; i++) {
    assert_near(target.data[i], 0.5, 0.02);
  }
  placido_image_free(&source);
  placido_image_free(&target);
}

/* Even light stays even to the rim, for pictures of one pixel, one row, prime sides, in all planes,
 * also where the target reaches beyond the source. */
static void test_even_light_stays_even(void **state) {
  (void)state;
  const int sizes[][2] = {{1, 1}, {97, 1}, {1, 89}, {31, 17}};
  const double steps[] = {0.3, 1.9, 5.7, 40};
  for (size_t i = 0; i < 16; i++) {
    const int *size = sizes[i / 4];
    double step = steps[i % 4];
    placido_image source = empty(size[0], size[1], 3);
    placido_image target = empty(1 + (int)(size[0] / step), 1 + (int)(size[1] / step), 3);
    for (int p = 0; p < size[0] * size[1] * 3; p++) {
      source.data[p] = 0.7f;
    }
    for (int k = 0; k < 2; k++) {
      assert_int_equal(placido_resample(&target, &source, -0.4, 0.2, step, both[k], 2, NULL),
                       PLACIDO_OK);
      for (int p = 0; p < target.width_px * target.height_px * 3; p++) {
        assert_near(target.data[p], 0.7, 1e-6);
      }
    }
    placido_image_free(&source);
    placido_image_free(&target);
  }
}

static void test_threads_change_nothing(void **state) {
  (void)state;
  placido_image source = empty(127, 113, 3), one = empty(41, 37, 3), many = empty(41, 37, 3);
  for (int i = 0; i < 127 * 113 * 3; i++) {
    source.data[i] = (float)(i % 251) / 250;
  }
  for (int k = 0; k < 2; k++) {
    assert_int_equal(placido_resample(&one, &source, 0, 0, 3.1, both[k], 1, NULL), PLACIDO_OK);
    assert_int_equal(placido_resample(&many, &source, 0, 0, 3.1, both[k], 5, NULL), PLACIDO_OK);
    assert_memory_equal(one.data, many.data, 41 * 37 * 3 * sizeof(float));
  }
  placido_image_free(&source);
  placido_image_free(&one);
  placido_image_free(&many);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_area_is_the_mean_of_what_is_covered),
    cmocka_unit_test(test_light_is_kept),
    cmocka_unit_test(test_ramps_stay_in_place),
    cmocka_unit_test(test_bicubic_does_not_alias),
    cmocka_unit_test(test_even_light_stays_even),
    cmocka_unit_test(test_threads_change_nothing),
  };
  return cmocka_run_group_tests_name("simulate_resample", tests, NULL, NULL);
}
