/* Convolution: a delta changes no bit, light is conserved, and it is what the sum says. */
#include "eyes.h"
#include "simulate/convolve.h"
#include "simulate/fft.h"
#include "tests/support/near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Reproducible samples in 0..1. */
static float noise(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return (float)(*seed >> 8) / (1 << 24);
}

static placido_image noise_image(int width, int height, int planes) {
  placido_image image;
  unsigned seed = 7;
  assert_int_equal(placido_image_new(&image, width, height, planes, NULL), PLACIDO_OK);
  for (int i = 0; i < width * height * planes; i++) {
    image.data[i] = noise(&seed);
  }
  return image;
}

/* A picture without holes: through those light spreads otherwise. */
static placido_image opaque_image(int width, int height) {
  placido_image image = noise_image(width, height, 4);
  float *alpha = placido_image_plane(&image, 3);
  for (int i = 0; i < width * height; i++) {
    alpha[i] = 1;
  }
  return image;
}

static placido_psf noise_psf(double *values, int n) {
  unsigned seed = 3;
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

static placido_image convolved(const placido_image *image, const placido_psf *psf, int threads) {
  placido_image result;
  assert_int_equal(
    placido_image_new(&result, image->width_px, image->height_px, image->planes, NULL), PLACIDO_OK);
  assert_int_equal(placido_convolve(&result, image, psf, threads, NULL), PLACIDO_OK);
  return result;
}

static void test_delta_returns_the_image_bit_for_bit(void **state) {
  (void)state;
  static double values[257 * 257];
  placido_psf psf = {.n = 257, .bucket_arcmin = 0.5, .values = values};
  placido_scene scene = {.arcmin_per_px = 0.5, .image = opaque_image(101, 67)};
  placido_image seen;
  values[128 * 257 + 128] = 1;
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
  assert_memory_equal(seen.data, scene.image.data, 101 * 67 * 4 * sizeof(float));
  values[128 * 257 + 128] = 0;
  placido_image_free(&seen);
  placido_scene_free(&scene);
}

/* Light one bucket down and two to the right: the picture moves down and to the right. Once by the
 * plain shift, once (a second bucket with next to no light) by the transform. */
static void test_shifted_delta_moves_the_picture_where_it_points(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    double values[49] = {0};
    values[4 * 7 + 5] = 1;
    values[0] = k * 1e-12;
    placido_psf psf = {.n = 7, .bucket_arcmin = 0.5, .values = values};
    placido_image image = noise_image(20, 10, 1), moved = convolved(&image, &psf, 1);
    for (int y = 0; y < 10; y++) {
      for (int x = 0; x < 20; x++) {
        float from = y >= 1 && x >= 2 ? image.data[(y - 1) * 20 + x - 2] : 0;
        assert_near(moved.data[y * 20 + x], from, 1e-6);
      }
    }
    placido_image_free(&image);
    placido_image_free(&moved);
  }
}

static double brute_force(const placido_image *image, const placido_psf *psf, int x, int y) {
  double sum = 0;
  int half = psf->n / 2;
  for (int row = 0; row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      int from_x = x - (column - half), from_y = y - (row - half);
      if (from_x >= 0 && from_x < image->width_px && from_y >= 0 && from_y < image->height_px) {
        sum += psf->values[row * psf->n + column] * image->data[from_y * image->width_px + from_x];
      }
    }
  }
  return sum;
}

/* Larger and smaller than the PSF, so that any light that wraps around shows. */
static void test_transform_agrees_with_the_sum(void **state) {
  (void)state;
  static double values[31 * 31];
  const int sizes[][2] = {{50, 37}, {9, 40}, {5, 3}, {1, 1}};
  placido_psf psf = noise_psf(values, 31);
  for (int i = 0; i < 4; i++) {
    placido_image image = noise_image(sizes[i][0], sizes[i][1], 1);
    placido_image result = convolved(&image, &psf, 1);
    for (int y = 0; y < image.height_px; y++) {
      for (int x = 0; x < image.width_px; x++) {
        /* Single precision over transforms of a few thousand samples. */
        assert_near(result.data[y * image.width_px + x], brute_force(&image, &psf, x, y), 1e-6);
      }
    }
    placido_image_free(&image);
    placido_image_free(&result);
  }
}

/* With a margin as wide as half the PSF nothing leaves the picture. */
static void test_light_is_conserved_inside_a_dark_margin(void **state) {
  (void)state;
  static double values[31 * 31];
  placido_psf psf = noise_psf(values, 31);
  placido_image image = noise_image(80, 80, 1);
  double before = 0, after = 0;
  for (int i = 0; i < 80 * 80; i++) {
    bool margin = i % 80 < 15 || i % 80 >= 65 || i / 80 < 15 || i / 80 >= 65;
    image.data[i] = margin ? 0 : image.data[i];
  }
  placido_image result = convolved(&image, &psf, 1);
  for (int i = 0; i < 80 * 80; i++) {
    before += image.data[i];
    after += result.data[i];
  }
  assert_near(after / before, 1, 1e-6);
  placido_image_free(&image);
  placido_image_free(&result);
}

static void test_colours_are_alike_and_alpha_stays(void **state) {
  (void)state;
  static double values[31 * 31];
  placido_psf psf = noise_psf(values, 31);
  placido_image image = noise_image(40, 30, 4);
  size_t plane = 40 * 30;
  memcpy(placido_image_plane(&image, 1), image.data, plane * sizeof(float));
  memcpy(placido_image_plane(&image, 2), image.data, plane * sizeof(float));
  placido_image one = convolved(&image, &psf, 1), two = convolved(&image, &psf, 2);
  for (int colour = 1; colour < 3; colour++) {
    assert_memory_equal(placido_image_plane(&one, colour), one.data, plane * sizeof(float));
  }
  assert_memory_equal(placido_image_plane(&one, 3), placido_image_plane(&image, 3),
                      plane * sizeof(float));
  assert_memory_equal(one.data, two.data, 4 * plane * sizeof(float)); /* threads */
  placido_image_free(&image);
  placido_image_free(&one);
  placido_image_free(&two);
}

/* White as far as the PSF reaches is white through any PSF; alpha is cut with the rest. */
static void test_bleed_spreads_into_the_picture_and_is_cut(void **state) {
  (void)state;
  static double values[31 * 31];
  placido_psf psf = noise_psf(values, 31);
  placido_scene scene = {.arcmin_per_px = 0.5, .bleed_px = 15, .image = opaque_image(50, 40)};
  placido_image seen, whole = convolved(&scene.image, &psf, 1);
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
  assert_int_equal(seen.width_px, 20);
  assert_int_equal(seen.height_px, 10);
  for (int plane = 0; plane < 4; plane++) {
    for (int y = 0; y < 10; y++) {
      assert_memory_equal(placido_image_plane(&seen, plane) + y * 20,
                          placido_image_plane(&whole, plane) + (y + 15) * 50 + 15,
                          20 * sizeof(float));
    }
  }
  placido_image_free(&seen);
  for (int i = 0; i < 50 * 40; i++) {
    scene.image.data[i] = 1;
  }
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < 20 * 10; i++) {
    assert_near(seen.data[i], 1, 1e-5); /* single precision over a few thousand samples */
  }
  placido_image_free(&seen);
  placido_image_free(&whole);
  placido_scene_free(&scene);
}

/* A PSF that has grown reaches farther than the bleed: what stands at its rim goes on. */
static void test_bleed_goes_on_as_far_as_the_light(void **state) {
  (void)state;
  static double values[61 * 61];
  placido_psf psf = noise_psf(values, 61);
  placido_scene scene = {.arcmin_per_px = 0.5, .bleed_px = 15, .image = opaque_image(50, 40)};
  placido_image seen;
  for (int i = 0; i < 4 * 50 * 40; i++) {
    scene.image.data[i] = 1;
  }
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
  assert_int_equal(seen.width_px, 20);
  assert_int_equal(seen.height_px, 10);
  for (int i = 0; i < 4 * 20 * 10; i++) {
    assert_near(seen.data[i], 1, 1e-5); /* single precision over a few thousand samples */
  }
  placido_image_free(&seen);
  placido_scene_free(&scene);
}

static void test_bleed_without_a_picture_is_refused(void **state) {
  (void)state;
  double values[1] = {1};
  placido_psf psf = {.n = 1, .bucket_arcmin = 0.5, .values = values};
  placido_scene scene = {.arcmin_per_px = 0.5, .bleed_px = 20, .image = noise_image(40, 60, 1)};
  placido_image seen;
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_INPUT);
  scene.bleed_px = -1;
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_INPUT);
  assert_null(seen.data);
  placido_scene_free(&scene);
}

static void test_good_lengths_have_small_factors_and_are_even(void **state) {
  (void)state;
  assert_int_equal(placido_fft_good_length(768), 768);
  assert_int_equal(placido_fft_good_length(721), 750);
  assert_int_equal(placido_fft_good_length(11), 12);
  assert_int_equal(placido_fft_good_length(1), 2);
}

/* Lengths that FFTW was measured to be quick with. */
static void test_fast_lengths_have_many_factors_of_two(void **state) {
  (void)state;
  const int asked[] = {1, 2, 250 + 128, 500 + 128, 2160 + 128, 3840 + 128, 4096};
  const int expected[] = {2, 2, 384, 640, 2560, 4096, 4096};
  for (int i = 0; i < 7; i++) {
    assert_int_equal(placido_fft_fast_length(asked[i]), expected[i]);
  }
  for (int length = 1; length < 3000; length++) {
    int fast = placido_fft_fast_length(length);
    assert_in_range(fast, length, 2 * length);
    assert_int_equal(placido_fft_good_length(fast), fast);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_delta_returns_the_image_bit_for_bit),
    cmocka_unit_test(test_shifted_delta_moves_the_picture_where_it_points),
    cmocka_unit_test(test_transform_agrees_with_the_sum),
    cmocka_unit_test(test_light_is_conserved_inside_a_dark_margin),
    cmocka_unit_test(test_colours_are_alike_and_alpha_stays),
    cmocka_unit_test(test_bleed_spreads_into_the_picture_and_is_cut),
    cmocka_unit_test(test_bleed_goes_on_as_far_as_the_light),
    cmocka_unit_test(test_bleed_without_a_picture_is_refused),
    cmocka_unit_test(test_good_lengths_have_small_factors_and_are_even),
    cmocka_unit_test(test_fast_lengths_have_many_factors_of_two),
  };
  return cmocka_run_group_tests_name("simulate_convolve", tests, NULL, NULL);
}
