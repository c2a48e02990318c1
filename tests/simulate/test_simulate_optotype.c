/* Optotypes and charts in ETDRS lines: areas known in closed form, pixels by brute force. */
#include "simulate/charts/logmar.h"
#include "simulate/charts/optotype.h"
#include "tests/support/near.h"

#include <placido/scene.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>

static placido_image white(int width_px, int height_px, int planes) {
  placido_image image;
  assert_int_equal(placido_image_new(&image, width_px, height_px, planes, NULL), PLACIDO_OK);
  for (int i = 0; i < width_px * height_px * planes; i++) {
    image.data[i] = 1;
  }
  return image;
}

static double ink_of(const placido_image *image) {
  double ink = 0;
  for (int i = 0; i < image->width_px * image->height_px; i++) {
    ink += 1 - (double)image->data[i];
  }
  return ink;
}

/* Strokes squared, summed by hand from bars, rings and the strips of the diagonals. */
static double area_of(enum placido_optotype kind, int which) {
  const double pi = acos(-1), ring = 4 * pi; /* radii 3/2 and 5/2 */
  /* The gap: from the inner circle to the outer, y from -1/2 to 1/2. */
  const double gap = 0.5 * sqrt(6) + 6.25 * asin(0.2) - 0.5 * sqrt(2) - 2.25 * asin(1 / 3.0);
  const double k = sqrt(2), v = sqrt(29) / 5; /* level widths of the strokes of K and V */
  const double sloan[] = {ring - gap,
                          12.5 + pi * 6.25 / 2 - (4.5 + pi * 2.25 / 2),
                          13,
                          5 + 6.5 * k - 0.75 * k * k,
                          15 - 2 * 0.25 / 3 / 2,
                          ring,
                          12.5 + pi,
                          6 + 3 * pi,
                          15 - 2.5 * (2.5 - v) * (2.5 - v),
                          15 - 2 * 0.25 / 3 / 2};
  return kind == PLACIDO_OPTOTYPE_E         ? 17
         : kind == PLACIDO_OPTOTYPE_LANDOLT ? ring - gap
                                            : sloan[which];
}

/* Wherever it stands and however small: 0.77' is a third of a pixel's stroke. Pixels are single
 * precision, 6e-8 each. */
static void test_areas_are_exact_at_any_size_and_place(void **state) {
  (void)state;
  const struct {
    double size, x, y, scale;
  } rows[] = {{10, 15.013, 14.987, 0.1}, {5, 14.2, 15.9, 0.5}, {0.77, 15.3, 15.1, 0.5},
              {7.3, 15.77, 14.1, 0.37}};
  for (int kind = PLACIDO_OPTOTYPE_E; kind <= PLACIDO_OPTOTYPE_SLOAN; kind++) {
    for (int which = 0; which < placido_optotype_count(kind); which++) {
      for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        int side = (int)(30 / rows[i].scale);
        placido_image image = white(side, side, 1);
        placido_optotype_draw(&image, kind, which, rows[i].size, rows[i].x, rows[i].y,
                              rows[i].scale);
        double stroke_px = rows[i].size / 5 / rows[i].scale;
        double area_px = area_of(kind, which) * stroke_px * stroke_px;
        assert_near(ink_of(&image), area_px, 1e-6 * area_px + 1e-6);
        placido_image_free(&image);
      }
    }
  }
}

/* Whether a point, in strokes from the middle, lies on a Landolt C with its gap to the right. */
static bool on_landolt(double x, double y) {
  double r = hypot(x, y);
  return r >= 1.5 && r <= 2.5 && !(x > 0 && fabs(y) < 0.5);
}

/* Every pixel against 400 × 400 points: those miss an edge by at most half of a point's strip. */
static void test_pixels_of_a_landolt_c_are_what_points_say(void **state) {
  (void)state;
  enum { points = 400, side = 14 };
  const double stroke_px = 2.13, x_px = 6.9, y_px = 7.2;
  placido_image image = white(side, side, 1);
  placido_optotype_draw(&image, PLACIDO_OPTOTYPE_LANDOLT, 0, 5 * stroke_px, x_px, y_px, 1);
  for (int i = 0; i < side * side; i++) {
    int inside = 0;
    for (int k = 0; k < points * points; k++) {
      double x = i % side + (k % points + 0.5) / points, y = i / side + (k / points + 0.5) / points;
      inside += on_landolt((x - x_px) / stroke_px, (y - y_px) / stroke_px);
    }
    assert_near(1 - (double)image.data[i], inside / (double)(points * points), 2.0 / points);
  }
  placido_image_free(&image);
}

/* 5' at half a minute a pixel: ten pixels, strokes and gaps of two, and not a grey one. */
static void test_20_20_e_falls_on_whole_pixels(void **state) {
  (void)state;
  for (int which = 0; which < 4; which++) {
    placido_image image = white(12, 12, 1);
    placido_optotype_draw(&image, PLACIDO_OPTOTYPE_E, which, 5, 3, 3, 0.5);
    int black = 0;
    for (int i = 0; i < 144; i++) {
      assert_true(image.data[i] == 0 || image.data[i] == 1);
      black += image.data[i] == 0;
    }
    assert_int_equal(black, 68); /* 17 strokes of 2 by 2 */
    /* The gaps open where the arms point: right, up, left, down. */
    static const int open_x[] = {10, 4, 1, 4}, open_y[] = {4, 1, 4, 10};
    assert_true(image.data[open_y[which] * 12 + open_x[which]] == 1);
    placido_image_free(&image);
  }
}

/* Gaps at right, up right, up ... : the pixel there is white, the one across black. */
static void test_landolt_gaps_turn_counterclockwise(void **state) {
  (void)state;
  const double pi = acos(-1);
  for (int which = 0; which < 8; which++) {
    placido_image image = white(60, 60, 1);
    placido_optotype_draw(&image, PLACIDO_OPTOTYPE_LANDOLT, which, 50, 30, 30, 1);
    double c = cos(which * pi / 4), s = sin(which * pi / 4);
    int gap = (int)(30 - 20 * s) * 60 + (int)(30 + 20 * c);
    int across = (int)(30 + 20 * s) * 60 + (int)(30 - 20 * c);
    assert_true(image.data[gap] == 1);
    assert_true(image.data[across] == 0);
    placido_image_free(&image);
  }
}

/* What lies outside is cut off and what is inside does not change: a letter in four tiles. Wide
 * pictures are drawn in pieces of 1,024 columns, which must not show either. */
static void test_parts_of_a_letter_fit_together(void **state) {
  (void)state;
  enum { side = 1100 };
  placido_image whole = white(2 * side, 300, 1), part = white(side, 150, 3);
  placido_optotype_draw(&whole, PLACIDO_OPTOTYPE_SLOAN, 7, 260, 1024.3, 150, 1);
  for (int tile = 0; tile < 4; tile++) {
    int left = tile % 2 * side, top = tile / 2 * 150;
    for (int i = 0; i < side * 150 * 3; i++) {
      part.data[i] = 1;
    }
    placido_optotype_draw(&part, PLACIDO_OPTOTYPE_SLOAN, 7, 260, 1024.3 - left, 150 - top, 1);
    for (int plane = 0; plane < 3; plane++) {
      const float *samples = placido_image_plane(&part, plane);
      for (int i = 0; i < side * 150; i++) {
        int at = (top + i / side) * 2 * side + left + i % side;
        assert_near(samples[i], whole.data[at], 1e-6);
      }
    }
  }
  placido_image_free(&whole);
  placido_image_free(&part);
}

static void test_names_and_counts(void **state) {
  (void)state;
  assert_int_equal(placido_optotype_count(PLACIDO_OPTOTYPE_E), 4);
  assert_int_equal(placido_optotype_count(PLACIDO_OPTOTYPE_LANDOLT), 8);
  assert_int_equal(placido_optotype_count(PLACIDO_OPTOTYPE_SLOAN), 10);
  char letters[11] = "";
  for (int i = 0; i < 10; i++) {
    letters[i] = placido_optotype_name(PLACIDO_OPTOTYPE_SLOAN, i)[0];
  }
  assert_string_equal(letters, "CDHKNORSVZ");
  assert_string_equal(placido_optotype_name(PLACIDO_OPTOTYPE_E, -1), "down");
}

/* Bailey and Lovie: letters a letter apart, lines as far apart as the lower one is high, every line
 * 10^0.1 smaller; 20/20 is 5'. */
static void test_lines_are_laid_out_as_etdrs(void **state) {
  (void)state;
  placido_chart_lines lines = placido_logmar_usual();
  assert_int_equal(placido_logmar_count(&lines), 14);
  placido_logmar_line above = placido_logmar_place(&lines, PLACIDO_OPTOTYPE_SLOAN, 0);
  assert_near(above.height_arcmin, 50, 1e-9);
  for (int i = 1; i < 14; i++) {
    placido_logmar_line line = placido_logmar_place(&lines, PLACIDO_OPTOTYPE_SLOAN, i);
    assert_near(line.height_arcmin, above.height_arcmin * pow(10, -0.1), 1e-9);
    assert_near(line.pitch_arcmin, 2 * line.height_arcmin, 1e-12);
    assert_near(line.top_arcmin, above.top_arcmin + above.height_arcmin + line.height_arcmin, 1e-9);
    assert_near(line.left_arcmin + 4.5 * line.height_arcmin,
                above.left_arcmin + 4.5 * above.height_arcmin, 1e-9); /* one axis */
    above = line;
  }
  assert_near(placido_logmar_place(&lines, PLACIDO_OPTOTYPE_E, 10).height_arcmin, 5, 1e-9);
  /* ETDRS chart 1 begins N C K Z O. */
  placido_logmar_line first = placido_logmar_place(&lines, PLACIDO_OPTOTYPE_SLOAN, 0);
  const int expected[] = {4, 0, 3, 9, 5};
  assert_memory_equal(first.letters, expected, sizeof expected);
}

/* Ink of the letters of a line on the chart itself, cut out of it. */
static void test_chart_letters_have_their_areas(void **state) {
  (void)state;
  placido_chart_lines lines = {0.3, 0.1, 4};
  placido_image image;
  const placido_chart *chart = placido_chart_find("landolt");
  assert_int_equal(placido_chart_new(&image, chart, &lines, 0.25, NULL), PLACIDO_OK);
  for (int i = 0; i < 3; i++) {
    placido_logmar_line line = placido_logmar_place(&lines, PLACIDO_OPTOTYPE_LANDOLT, i);
    double gap = line.height_arcmin / 2, ink = 0;
    for (int y = 0; y < image.height_px; y++) {
      for (int x = 0; x < image.width_px; x++) {
        double dx = (x + 0.5) * 0.25 - line.left_arcmin, dy = (y + 0.5) * 0.25 - line.top_arcmin;
        bool near_x = dx > -gap && dx < 9.5 * line.height_arcmin;
        ink += near_x && dy > -0.3 && dy < line.height_arcmin + 0.3
                 ? 1 - (double)image.data[(size_t)y * (size_t)image.width_px + (size_t)x]
                 : 0;
      }
    }
    double stroke_px = line.height_arcmin / 5 / 0.25;
    assert_near(ink, 5 * area_of(PLACIDO_OPTOTYPE_LANDOLT, 0) * stroke_px * stroke_px, 1e-3);
    for (int k = 0; k < PLACIDO_LOGMAR_LETTERS; k++) {
      assert_int_equal(line.letters[k] % 2, 0); /* four directions */
    }
  }
  placido_image_free(&image);
}

static void test_lines_out_of_range_are_refused(void **state) {
  (void)state;
  static const placido_chart_lines rows[] = {
    {-0.3, 1, 8}, {2.5, 0, 8}, {0, -1.5, 8}, {NAN, 0, 8}, {1, -0.3, 6}};
  placido_scene scene;
  placido_error err = {0};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    assert_int_equal(placido_scene_draw(&scene, "sloan", &rows[i], 0.5, &err), PLACIDO_INPUT);
    assert_null(scene.image.data);
  }
  assert_non_null(strstr(err.text, "expected 4 or 8"));
  const placido_chart_lines fine = {0, 0, 8}, huge = {2, 1, 8};
  assert_int_equal(placido_scene_draw(&scene, "fan", &fine, 0.5, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "sloan, landolt and e-lines"));
  assert_int_equal(placido_scene_draw(&scene, "sloan", &huge, 0.05, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "too many"));
  assert_int_equal(placido_scene_draw(&scene, "sloan", &fine, 0.05, &err), PLACIDO_OK);
  placido_scene_free(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_areas_are_exact_at_any_size_and_place),
    cmocka_unit_test(test_pixels_of_a_landolt_c_are_what_points_say),
    cmocka_unit_test(test_20_20_e_falls_on_whole_pixels),
    cmocka_unit_test(test_landolt_gaps_turn_counterclockwise),
    cmocka_unit_test(test_parts_of_a_letter_fit_together),
    cmocka_unit_test(test_names_and_counts),
    cmocka_unit_test(test_lines_are_laid_out_as_etdrs),
    cmocka_unit_test(test_chart_letters_have_their_areas),
    cmocka_unit_test(test_lines_out_of_range_are_refused),
  };
  return cmocka_run_group_tests_name("simulate_optotype", tests, NULL, NULL);
}
