/* The figure of an image's quality shows what it is given. */
#include "report/report.h"
#include "tests/base/scratch.h"
#include "tests/report/fabricate.h"

#include <placido/image.h>
#include <placido/quality.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#define SCRATCH_TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)

enum { WIDTH = 1360, HEIGHT = 1060, HALF = WIDTH / 2 }; /* see figure_quality.c */

static const unsigned blue = 0x0072b2, green = 0x009e73; /* along 0 and 90 degrees */
static const unsigned orange = 0xd55e00;

/* Pixels of a colour in a rectangle, and their mean place from the top. */
static long find_colour(const char *path, unsigned colour, int left, int right, int top,
                        int bottom, double *mean_y) {
  placido_frame picture = {0};
  long found = 0;
  double sum = 0;
  assert_int_equal(placido_frame_load(&picture, path, NULL), PLACIDO_OK);
  assert_int_equal(picture.width_px, WIDTH);
  assert_int_equal(picture.height_px, HEIGHT);
  for (int y = top; y < bottom; y++) {
    for (int x = left; x < right; x++) {
      if (colour_at(&picture, x, y) == colour) {
        found++;
        sum += y;
      }
    }
  }
  placido_frame_free(&picture);
  *mean_y = found > 0 ? sum / (double)found : 0;
  return found;
}

/* An image that is wider than high blurs upright gratings more: 0 degrees is low, 90 high. */
static void contrast_falls_along_the_wider_blur(void **state) {
  char *path = scratch_path(state, "quality.png");
  placido_psf psf = fabricate_psf(65);
  int middle = 65 / 2;
  psf.values[middle * 65 + middle - 1] = 0.5;
  psf.values[middle * 65 + middle + 1] = 0.5;
  psf.values[middle * 65 + middle] = 0.5;
  psf.values[(middle - 1) * 65 + middle] = psf.values[(middle + 1) * 65 + middle] = 0.2;
  assert_int_equal(placido_figure_quality(&psf, NULL, path, NULL), PLACIDO_OK);
  double across, along;
  assert_true(find_colour(path, blue, HALF + 64, HALF + 440, 90, 480, &across) > 50);
  assert_true(find_colour(path, green, HALF + 64, HALF + 440, 90, 480, &along) > 30);
  assert_true(across > along + 50);
  free(psf.values);
  free(path);
}

/* The curve through focus stands where its lenses and values are. */
static void focus_is_drawn_where_it_is(void **state) {
  char *path = scratch_path(state, "quality.png");
  placido_psf psf = fabricate_psf(65);
  double lens[3] = {-1, 0, 1}, low[3] = {0.1, 0.1, 0.1}, high[3] = {0.9, 0.9, 0.9};
  double low_y, high_y;
  placido_focus_curve curve = {
      .count = 3, .lens_D = lens, .peak = high, .visual_strehl = low, .mtf_area = high};
  assert_int_equal(placido_figure_quality(&psf, &curve, path, NULL), PLACIDO_OK);
  assert_true(find_colour(path, blue, HALF + 64, HALF + 440, 560, HEIGHT, &low_y) > 100);
  curve.visual_strehl = high;
  curve.peak = low;
  assert_int_equal(placido_figure_quality(&psf, &curve, path, NULL), PLACIDO_OK);
  assert_true(find_colour(path, orange, HALF + 64, HALF + 440, 560, HEIGHT, &high_y) > 50);
  assert_true(high_y > low_y - 3 && high_y < low_y + 3);
  free(psf.values);
  free(path);
}

static void a_psf_without_light_is_refused(void **state) {
  char *path = scratch_path(state, "quality.png"), *folder = scratch_path(state, "");
  placido_psf psf = fabricate_psf(65);
  placido_error err = {0};
  psf.values[65 * 65 / 2] = 0;
  assert_int_equal(placido_figure_quality(&psf, NULL, path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "no light"));
  assert_int_equal(scratch_count(folder), 0);
  free(psf.values);
  free(folder);
  free(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      SCRATCH_TEST(contrast_falls_along_the_wider_blur),
      SCRATCH_TEST(focus_is_drawn_where_it_is),
      SCRATCH_TEST(a_psf_without_light_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
