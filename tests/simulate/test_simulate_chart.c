/* Charts: sizes of the letters, exact coverage, what this build does not draw. */
#include "simulate/charts/chart.h"
#include "simulate/charts/paint.h"
#include "tests/support/near.h"

#include <placido/simulate.h>

#include <math.h>
#include <string.h>

static placido_image drawn(const char *name, double arcmin_per_px) {
  placido_image image;
  const placido_chart *chart = placido_chart_find(name);
  assert_non_null(chart);
  assert_int_equal(placido_chart_new(&image, chart, NULL, arcmin_per_px, NULL), PLACIDO_OK);
  return image;
}

static float at(const placido_image *image, double x_px, double y_px) {
  return image->data[(size_t)y_px * (size_t)image->width_px + (size_t)x_px];
}

/* A letter that subtends 5' is 10 px high at half a minute, its strokes 2 px. */
static void test_20_20_e_is_10_px_high_at_half_a_minute(void **state) {
  (void)state;
  placido_image image = drawn("tumbling-e", 0.5);
  size_t count;
  const placido_e_line *lines = placido_e_lines(&count), *line = NULL;
  for (size_t i = 0; i < count; i++) {
    line = lines[i].denominator == 20 ? &lines[i] : line;
  }
  assert_non_null(line);
  int left = (int)(line->left_arcmin * 2), top = (int)(line->top_arcmin * 2);
  assert_int_equal(line->directions[0], 'l'); /* its back is on the right: columns 8 and 9 */
  int black = 0;
  for (int y = top - 5; y < top + 15; y++) {
    black += at(&image, left + 9, y) == 0;
    assert_true(at(&image, left + 9, y) == 0 || at(&image, left + 9, y) == 1);
  }
  assert_int_equal(black, 10);
  const char *arms = "##..##..##";
  for (int y = 0; y < 10; y++) {
    assert_true(at(&image, left, top + y) == (arms[y] == '#' ? 0.0f : 1.0f));
  }
  placido_image_free(&image);
}

/* Each line's denominators are heights: 5' × denominator / 20. */
static void test_lines_run_from_20_160_to_20_10(void **state) {
  (void)state;
  size_t count;
  const placido_e_line *lines = placido_e_lines(&count);
  assert_int_equal(count, 5);
  assert_int_equal(lines[0].denominator, 160);
  assert_int_equal(lines[4].denominator, 10);
  for (size_t i = 0; i < count; i++) {
    assert_true(lines[i].height_arcmin == lines[i].denominator * 0.25);
    for (const char *all = "rlud"; *all != '\0'; all++) {
      assert_non_null(strchr(lines[i].directions, *all));
    }
  }
}

/* The ink of an E is 17 of its 25 units, whatever the scale; 0.37' falls on no whole pixels. */
static void test_coverage_is_exact_at_any_scale(void **state) {
  (void)state;
  const double scales[] = {0.5, 0.37, 1.1};
  double ink[3];
  for (int k = 0; k < 3; k++) {
    placido_image image = drawn("tumbling-e", scales[k]);
    ink[k] = 0;
    for (int i = 0; i < image.width_px * image.height_px; i++) {
      assert_true(image.data[i] >= 0 && image.data[i] <= 1);
      ink[k] += (1 - (double)image.data[i]) * scales[k] * scales[k];
    }
    placido_image_free(&image);
  }
  assert_near(ink[1] / ink[0], 1, 1e-6); /* samples are single precision */
  assert_near(ink[2] / ink[0], 1, 1e-6);
}

static void test_polygon_covers_its_area(void **state) {
  (void)state;
  placido_image image;
  assert_int_equal(placido_image_new(&image, 8, 6, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < 48; i++) {
    image.data[i] = 1;
  }
  placido_corner triangle[3] = {{0.5, 0.5}, {3.5, 0.5}, {0.5, 2.5}};
  placido_paint_polygon(&image, 0.5, triangle, 3);
  double ink = 0;
  for (int i = 0; i < 48; i++) {
    ink += 1 - (double)image.data[i];
  }
  assert_near(ink, 12, 1e-5); /* 3' × 2' / 2 in pixels of half a minute */
  /* In the corner at (0.5, 2.5)' the slanted side falls from 1 to 1/3 of the pixel's height. */
  assert_near(image.data[8 * 4 + 1], 1 - 2.0 / 3, 1e-6);
  assert_near(image.data[8 + 1], 0, 1e-6);
  placido_image_free(&image);
}

/* The default PSF reaches 128 buckets to a side: that much white around the chart, and a margin of
 * 12' of the chart's own. */
static void test_bleed_and_margin_are_white(void **state) {
  (void)state;
  size_t count;
  const placido_chart *charts = placido_chart_table(&count);
  for (size_t k = 0; k < count; k++) {
    placido_scene scene;
    assert_int_equal(placido_scene_load(&scene, charts[k].name, 0, NULL, NULL), PLACIDO_OK);
    assert_int_equal(scene.bleed_px, 128);
    const placido_image *image = &scene.image;
    int rim = charts[k].planes == 1 ? 128 + 24 : 0; /* coloured pictures have no white */
    for (int y = 0; y < image->height_px; y++) {
      for (int x = 0; x < image->width_px; x++) {
        bool margin =
          x < rim || y < rim || x >= image->width_px - rim || y >= image->height_px - rim;
        assert_true(!margin || at(image, x, y) == 1);
      }
    }
    placido_scene_free(&scene);
  }
}

/* Even light over a disc, sum 1. */
static placido_psf disc_psf(double *values, double radius_arcmin) {
  int inside = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < 257 * 257; i++) {
      bool in = hypot(i % 257 - 128, i / 257 - 128) * 0.5 <= radius_arcmin;
      inside += pass == 0 && in;
      values[i] = pass == 1 && in ? 1.0 / inside : 0;
    }
  }
  return (placido_psf){.n = 257, .bucket_arcmin = 0.5, .values = values};
}

/* What is seen is the chart alone, 280' × 210' and 210' × 210', and through a blur that does not
 * reach from its edge to its figures the edge is white all around. 1e-3 is far below an 8-bit step
 * and above the transform's rounding. */
static void test_seen_chart_has_no_dark_rim(void **state) {
  (void)state;
  static const struct {
    const char *name;
    int width_px, height_px;
  } rows[] = {{"tumbling-e", 560, 420}, {"fan", 420, 420}};
  static double values[257 * 257];
  placido_psf psf = disc_psf(values, 12);
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    placido_scene scene;
    placido_image seen;
    assert_int_equal(placido_scene_load(&scene, rows[k].name, 0, NULL, NULL), PLACIDO_OK);
    assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
    assert_int_equal(seen.width_px, rows[k].width_px);
    assert_int_equal(seen.height_px, rows[k].height_px);
    double darkest = 1;
    for (int y = 0; y < seen.height_px; y++) {
      for (int x = 0; x < seen.width_px; x++) {
        bool edge = x == 0 || y == 0 || x == seen.width_px - 1 || y == seen.height_px - 1;
        darkest = fmin(darkest, at(&seen, x, y));
        assert_true(!edge || fabs(1 - (double)at(&seen, x, y)) < 1e-3);
      }
    }
    assert_true(darkest < 0.9); /* the figures are there, blurred */
    placido_image_free(&seen);
    placido_scene_free(&scene);
  }
}

static void test_unknown_charts_name_the_known(void **state) {
  (void)state;
  placido_scene scene;
  placido_error err = {0};
  assert_int_equal(placido_scene_load(&scene, "snellen", 0, NULL, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "snellen"));
  assert_non_null(strstr(err.text, "tumbling-e, fan, sloan, landolt"));
  assert_null(scene.image.data);
}

/* A star's light is the same whatever the pixel: a magnitude 0.5 star against a sky of 0.03 white.
 * Of 2.54e-6 lx × 10^-0.2 over 0.005 cd/m² and (pi / 10,800)² per square minute of arc. */
static void test_stars_keep_their_light_at_any_scale(void **state) {
  (void)state;
  const double arcmin = acos(-1) / 10800;
  const double light = 2.54e-6 * pow(10, -0.2) / (0.005 * arcmin * arcmin);
  const double scales[] = {0.5, 0.3, 0.11};
  for (int k = 0; k < 3; k++) {
    placido_image image = drawn("stars", scales[k]);
    const float *green = placido_image_plane(&image, 1);
    double sum = 0;
    for (int y = (int)(109 / scales[k]); y < (int)(111 / scales[k]); y++) {
      for (int x = (int)(149 / scales[k]); x < (int)(151 / scales[k]); x++) {
        sum += (green[y * image.width_px + x] - 0.032) * scales[k] * scales[k];
      }
    }
    assert_near(sum / light, 1, 1e-3); /* the sky that it covers */
    placido_image_free(&image);
  }
}

/* Windows, text and headlights: in colour, with what they are told about light and distance. */
static void test_pictures_say_how_they_are_lit(void **state) {
  (void)state;
  placido_scene scene;
  assert_int_equal(placido_scene_draw(&scene, "monitor", NULL, 0, NULL), PLACIDO_OK);
  assert_int_equal(scene.image.planes, 3);
  assert_true(scene.conditions.distance_m == 0.6);
  placido_scene_free(&scene);
  assert_int_equal(placido_scene_draw(&scene, "street", NULL, 0, NULL), PLACIDO_OK);
  assert_true(scene.conditions.luminance_cd_m2 == 3);
  float brightest = 0;
  for (int i = 0; i < scene.image.width_px * scene.image.height_px * 3; i++) {
    brightest = fmaxf(brightest, scene.image.data[i]);
  }
  assert_true(brightest == 3300); /* of white: a headlight */
  /* The picture's rim goes on outwards: no dark comes in from there. */
  size_t width = (size_t)scene.image.width_px, bleed = (size_t)scene.bleed_px;
  assert_true(scene.image.data[0] == scene.image.data[bleed * width + bleed]);
  assert_true(scene.image.data[0] > 0);
  placido_scene_free(&scene);
  assert_int_equal(placido_scene_draw(&scene, "fan", NULL, 0, NULL), PLACIDO_OK);
  assert_true(scene.conditions.luminance_cd_m2 == 160 && isinf(scene.conditions.distance_m));
  assert_null(scene.depth_D);
  placido_scene_free(&scene);
}

static void test_chart_scales_are_bounded(void **state) {
  (void)state;
  placido_image image;
  const placido_chart *chart = placido_chart_find("fan");
  assert_int_equal(placido_chart_new(&image, chart, NULL, 1e-9, NULL), PLACIDO_INPUT);
  assert_int_equal(placido_chart_new(&image, chart, NULL, NAN, NULL), PLACIDO_INPUT);
  assert_null(placido_chart_find("no such chart"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_20_20_e_is_10_px_high_at_half_a_minute),
    cmocka_unit_test(test_lines_run_from_20_160_to_20_10),
    cmocka_unit_test(test_coverage_is_exact_at_any_scale),
    cmocka_unit_test(test_polygon_covers_its_area),
    cmocka_unit_test(test_bleed_and_margin_are_white),
    cmocka_unit_test(test_seen_chart_has_no_dark_rim),
    cmocka_unit_test(test_unknown_charts_name_the_known),
    cmocka_unit_test(test_stars_keep_their_light_at_any_scale),
    cmocka_unit_test(test_pictures_say_how_they_are_lit),
    cmocka_unit_test(test_chart_scales_are_bounded),
  };
  return cmocka_run_group_tests_name("simulate_chart", tests, NULL, NULL);
}
