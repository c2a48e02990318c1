/* The figures of the accuracy test and of the wavefront: they show what they are given. */
#include "report/iso.h"
#include "report/reduce.h"
#include "tests/base/scratch.h"
#include "tests/report/fabricate.h"

#include "base/file.h"
#include "base/memory.h"

#include <placido/image.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SCRATCH_TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)

#define BLUE 0x0072b2u /* of Okabe and Ito: the bars, and the inner zone's marks */

/* How many pixels of a part of a picture have a colour, and their mean height from the top. */
static long find_colour(const char *path, unsigned colour, int left, int right, double *mean_y) {
  placido_frame picture = {0};
  long found = 0;
  double sum = 0;
  assert_int_equal(placido_frame_load(&picture, path, NULL), PLACIDO_OK);
  for (int y = 0; y < picture.height_px; y++) {
    for (int x = left; x < right && x < picture.width_px; x++) {
      if (colour_at(&picture, x, y) == colour) {
        found++;
        sum += y;
      }
    }
  }
  placido_frame_free(&picture);
  *mean_y = found > 0 ? sum / (double)found : (double)NAN;
  return found;
}

static placido_surface *cornea(double tilt_um) {
  placido_surface *surface = NULL;
  placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, -0.56, 7.8, -0.56, 0, 0, 0}},
      {.kind = PLACIDO_PART_ZERNIKE, .as.zernike = {.radius_mm = 3}}};
  parts[1].as.zernike.coefficients_um[9] = tilt_um;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, parts, 2, NULL, NULL), PLACIDO_OK);
  return surface;
}

/* A term that is positive stands above the axis, one that is negative below. */
static void bars_point_where_the_terms_do(void **state) {
  char *path = scratch_path(state, "w.png");
  double height[2];
  for (int k = 0; k < 2; k++) {
    placido_surface *surface = cornea(k == 0 ? 1 : -1);
    const placido_eye eye = {.pupil_mm = 6};
    placido_wavefront w;
    assert_int_equal(placido_wavefront_new(&w, surface, &eye, NULL, NULL, NULL), PLACIDO_OK);
    assert_int_equal(placido_figure_wavefront(&w, NULL, path, NULL), PLACIDO_OK);
    assert_true(find_colour(path, BLUE, 800, 1400, &height[k]) > 100);
    assert_true((w.coefficients_um[9] > 0) == (k == 0)); /* more sag, a shorter path in the eye */
    placido_wavefront_free(&w);
    placido_surface_free(surface);
  }
  assert_true(height[0] < height[1] - 50);
  free(path);
}

static placido_iso_result fabricate_result(double mean_D) {
  placido_iso_result result = {.object = "sphere 7.8 mm", .image = "", .passed = true};
  for (int k = 0; k < PLACIDO_ISO_ZONES; k++) {
    result.zones[k] = (placido_iso_zone){.inner_mm = 1,
                                         .outer_mm = 3,
                                         .points = 100,
                                         .covered = 1,
                                         .axial_mean_D = k == 0 ? mean_D : NAN,
                                         .axial_2sd_D = k == 0 ? 0.05 : NAN,
                                         .elevation_mean_um = NAN,
                                         .elevation_2sd_um = NAN};
  }
  return result;
}

static void a_zone_stands_at_its_mean(void **state) {
  char *path = scratch_path(state, "iso.png");
  double high, low;
  placido_iso_result result = fabricate_result(0.2);
  assert_int_equal(placido_figure_iso(&result, 1, path, NULL), PLACIDO_OK);
  assert_true(find_colour(path, BLUE, 100, 560, &high) > 20);
  result = fabricate_result(-0.2);
  assert_int_equal(placido_figure_iso(&result, 1, path, NULL), PLACIDO_OK);
  assert_true(find_colour(path, BLUE, 100, 560, &low) > 20);
  assert_true(high < low - 100);
  placido_error err = {0};
  assert_int_equal(placido_figure_iso(&result, 0, path, &err), PLACIDO_INPUT);
  free(path);
}

static void the_page_tells_what_failed(void **state) {
  char *folder = scratch_path(state, ""), *path = scratch_path(state, "iso.png");
  char *page = scratch_path(state, "iso-check.html"), *text;
  size_t size;
  placido_iso_result results[2] = {fabricate_result(0.2), {.object = "<ball>"}};
  results[0].checks[0] = (placido_iso_check){"axial power", "D", 0.25, 0.1, false};
  results[0].check_count = 1;
  strcpy(results[1].failure, "no mires");
  const placido_iso_report report = {"cone", "placido", "today", "own targets", results, 2};
  assert_int_equal(placido_figure_iso(results, 2, path, NULL), PLACIDO_OK);
  assert_int_equal(placido_report_iso_write(&report, folder, "iso.png", NULL), PLACIDO_OK);
  assert_int_equal(placido_file_read(&text, &size, page, 0, NULL), PLACIDO_OK);
  assert_non_null(strstr(text, "<strong>missed</strong>"));
  assert_non_null(strstr(text, "own targets"));
  assert_non_null(strstr(text, "&lt;ball&gt;</th><td colspan=\"7\">not measured: no mires"));
  placido_memory_free(text);
  free(page);
  free(path);
  free(folder);
}

static void few_colours_are_kept_as_they_are(void **state) {
  (void)state;
  placido_canvas canvas;
  placido_reduced reduced;
  assert_int_equal(placido_canvas_new(&canvas, 40, 10, NULL), PLACIDO_OK);
  placido_canvas_ink(&canvas, (placido_rgb){1, 0, 0});
  cairo_rectangle(canvas.cr, 0, 0, 20, 10);
  cairo_fill(canvas.cr);
  assert_int_equal(placido_reduce(&reduced, &canvas, NULL), PLACIDO_OK);
  assert_int_equal(reduced.count, 2);
  const uint8_t *left = reduced.colours[reduced.indices[0]];
  const uint8_t *right = reduced.colours[reduced.indices[39]];
  assert_true(left[0] == 255 && left[1] == 0 && left[2] == 0);
  assert_true(right[0] == 255 && right[1] == 255 && right[2] == 255);
  placido_reduced_free(&reduced);
  placido_canvas_free(&canvas);
}

/* A colour cube of 32 steps a side: the nearest of 256 colours would be some 12 of 255 off. */
static void a_photograph_keeps_its_colours(void **state) {
  (void)state;
  placido_canvas canvas;
  placido_reduced reduced;
  assert_int_equal(placido_canvas_new(&canvas, 256, 128, NULL), PLACIDO_OK);
  for (int k = 0; k < 32 * 32 * 32; k++) {
    placido_canvas_ink(&canvas, (placido_rgb){k % 32 / 31.0, k / 32 % 32 / 31.0, k / 1024 / 31.0});
    cairo_rectangle(canvas.cr, k % 256, k / 256, 1, 1);
    cairo_fill(canvas.cr);
  }
  assert_int_equal(placido_reduce(&reduced, &canvas, NULL), PLACIDO_OK);
  assert_int_equal(reduced.count, 0);
  placido_reduced_free(&reduced);
  placido_canvas_free(&canvas);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(few_colours_are_kept_as_they_are),
      cmocka_unit_test(a_photograph_keeps_its_colours),
      SCRATCH_TEST(bars_point_where_the_terms_do),
      SCRATCH_TEST(a_zone_stands_at_its_mean),
      SCRATCH_TEST(the_page_tells_what_failed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
