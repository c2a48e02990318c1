/* Resampling, blurring and undistorting do what their words say, and leave their source alone. */
#include "base/cv/cv.h"
#include "base/memory.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static placido_image make(int width_px, int height_px, int planes) {
  placido_image image;
  assert_int_equal(placido_image_new(&image, width_px, height_px, planes, NULL), PLACIDO_OK);
  return image;
}

/* A plane that grows by `step` a column, plus the plane's number. */
static placido_image ramp(int width_px, int height_px, int planes, float step) {
  placido_image image = make(width_px, height_px, planes);
  for (int i = 0; i < width_px * height_px * planes; i++) {
    image.data[i] = (float)(i % width_px) * step + (float)(i / (width_px * height_px));
  }
  return image;
}

static void area_sampling_keeps_the_mean(void **state) {
  (void)state;
  placido_image source = ramp(12, 9, 3, 0.25f), target = make(4, 3, 3);
  assert_int_equal(placido_cv_resize(&target, &source, PLACIDO_CV_AREA, NULL), PLACIDO_OK);
  for (int plane = 0; plane < 3; plane++) {
    for (int i = 0; i < 12; i++) {
      /* Each bucket of 3 x 3 has its middle column's value. */
      float expected = (float)((i % 4) * 3 + 1) * 0.25f + (float)plane;
      assert_float_equal(placido_image_plane(&target, plane)[i], expected, 1e-5);
    }
  }
  placido_image_free(&source);
  placido_image_free(&target);
}

static void planes_must_be_equal_in_number(void **state) {
  (void)state;
  placido_image source = make(4, 4, 3), target = make(4, 4, 1);
  placido_error err;
  assert_int_equal(placido_cv_resize(&target, &source, PLACIDO_CV_LINEAR, &err), PLACIDO_INPUT);
  placido_image_free(&source);
  placido_image_free(&target);
}

static void remapping_takes_what_the_map_points_at(void **state) {
  (void)state;
  placido_image source = ramp(16, 8, 2, 0.5f), target = make(3, 1, 2);
  const float map_x[] = {3.5f, 10, -9}, map_y[] = {4, 2, 4};
  assert_int_equal(
      placido_cv_remap(&target, &source, map_x, map_y, PLACIDO_CV_LINEAR, -1, NULL), PLACIDO_OK);
  assert_float_equal(target.data[0], 1.75, 1e-6);
  assert_float_equal(target.data[1], 5, 1e-6);
  assert_float_equal(target.data[2], -1, 0);
  assert_float_equal(target.data[3], 2.75, 1e-6); /* the second plane */
  placido_image_free(&source);
  placido_image_free(&target);
}

static void a_blurred_point_is_a_gaussian_that_sums_to_one(void **state) {
  (void)state;
  placido_image image = make(41, 41, 1);
  image.data[20 * 41 + 20] = 1;
  assert_int_equal(placido_cv_blur(&image, 2, 3, NULL), PLACIDO_OK);
  double sum = 0, moment_x = 0, moment_y = 0;
  for (int y = 0; y < 41; y++) {
    for (int x = 0; x < 41; x++) {
      double value = (double)image.data[y * 41 + x];
      sum += value;
      moment_x += value * (x - 20) * (x - 20);
      moment_y += value * (y - 20) * (y - 20);
    }
  }
  assert_float_equal(sum, 1, 1e-4);
  /* The kernel ends at 4 sigma: 0.2 % of the second moment lies beyond. */
  assert_float_equal(sqrt(moment_x), 2, 0.01);
  assert_float_equal(sqrt(moment_y), 3, 0.01);
  placido_image_free(&image);
}

/* OpenCV's distortion model (k1 k2 p1 p2 k3) applied to normalised coordinates. */
static void distort(double out[2], const double in[2], const double d[5]) {
  double x = in[0], y = in[1], r2 = x * x + y * y;
  double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  out[0] = x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x);
  out[1] = y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y;
}

static void undistorting_inverts_the_distortion(void **state) {
  (void)state;
  const double focal_px[2] = {2000, 2010}, principal_px[2] = {640.5, 512.25};
  const double distortion[5] = {-0.2, 0.05, 0.001, -0.002, 0.01};
  double points[121][2], image_uv[121][2], found[121][2], bent[2];
  for (int i = 0; i < 121; i++) {
    points[i][0] = (i % 11 - 5) * 0.06;
    points[i][1] = (i / 11 - 5) * 0.05;
    distort(bent, points[i], distortion);
    image_uv[i][0] = bent[0] * focal_px[0] + principal_px[0];
    image_uv[i][1] = bent[1] * focal_px[1] + principal_px[1];
  }
  assert_int_equal(placido_cv_undistort(&found[0][0], &image_uv[0][0], 121, focal_px,
                                        principal_px, distortion, NULL),
                   PLACIDO_OK);
  for (int i = 0; i < 121; i++) {
    /* 1e-9 of the focal length is 2e-6 px: a thousandth of what any edge is found to. */
    assert_float_equal(found[i][0], points[i][0], 1e-9);
    assert_float_equal(found[i][1], points[i][1], 1e-9);
  }
  assert_int_equal(
      placido_cv_undistort(NULL, NULL, 0, focal_px, principal_px, distortion, NULL), PLACIDO_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(area_sampling_keeps_the_mean),
      cmocka_unit_test(planes_must_be_equal_in_number),
      cmocka_unit_test(remapping_takes_what_the_map_points_at),
      cmocka_unit_test(a_blurred_point_is_a_gaussian_that_sums_to_one),
      cmocka_unit_test(undistorting_inverts_the_distortion),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
