/* Map figures: right size, one colour a class, honest about what data do not support, whole or
 * not at all. */
#include "base/memory.h"
#include "report/field.h"
#include "report/scale.h"
#include "tests/base/scratch.h"
#include "tests/report/fabricate.h"

#include <placido/image.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where the middle of the map stands in the picture, and how large it is; see map_picture.c. */
enum { MIDDLE_X = 389, MIDDLE_Y = 357 };
static const double px_per_mm = 526 / 9.0;

static double sphere_power(double x_mm, double y_mm) {
  (void)x_mm;
  (void)y_mm;
  return 43.27;
}

static double half_missing(double x_mm, double y_mm) {
  (void)y_mm;
  return x_mm > 0.05 ? NAN : 43.27;
}

static double nothing(double x_mm, double y_mm) {
  (void)x_mm;
  (void)y_mm;
  return NAN;
}

static double bowl(double x_mm, double y_mm) {
  return 1 + 2 * x_mm - y_mm + 0.5 * x_mm * x_mm - 0.25 * y_mm * y_mm + x_mm * y_mm;
}

static placido_frame draw(void **state, const placido_maps *maps, const char *name) {
  char *path = scratch_path(state, "map.png");
  placido_error err = {0};
  assert_int_equal(placido_figure_map(maps, placido_maps_find(name), path, &err), PLACIDO_OK);
  placido_frame picture = {0};
  assert_int_equal(placido_frame_load(&picture, path, &err), PLACIDO_OK);
  free(path);
  return picture;
}

/* The colour at a place of the map that no label, circle or tick covers. */
static unsigned colour_on_map(const placido_frame *picture, double radius_mm, double meridian_deg) {
  double angle = meridian_deg * acos(-1) / 180;
  return colour_at(picture, MIDDLE_X + (int)lround(px_per_mm * radius_mm * cos(angle)),
                   MIDDLE_Y - (int)lround(px_per_mm * radius_mm * sin(angle)));
}

static unsigned colour_of_value(const char *name, double value) {
  size_t count;
  const placido_map_kind *kind = &placido_map_kinds(&count)[placido_maps_find(name)];
  placido_scale scale = placido_scale_of_kind(kind, value, value);
  placido_rgb c = placido_scale_colour(&scale, placido_scale_class(&scale, value));
  return (unsigned)lround(255 * c.r) << 16 | (unsigned)lround(255 * c.g) << 8 |
         (unsigned)lround(255 * c.b);
}

static void a_sphere_has_one_colour(void **state) {
  placido_maps maps = fabricate_maps(sphere_power);
  placido_frame picture = draw(state, &maps, "axial");
  assert_int_equal(picture.width_px, 900);
  assert_int_equal(picture.height_px, 760);
  unsigned expected = colour_of_value("axial", 43.27);
  /* circles stand at 1.5, 2.5 and 3.5 mm, the centre's cross within 0.2 mm, their labels below
   * it */
  for (double radius = 0.5; radius < 4.3; radius += 0.1) {
    for (double meridian = 3; meridian < 240; meridian += 5) {
      if (fabs(fmod(radius, 1) - 0.5) > 0.05) {
        assert_int_equal(colour_on_map(&picture, radius, meridian), expected);
      }
    }
  }
  placido_frame_free(&picture);
  fabricate_maps_free(&maps);
}

static void what_data_do_not_support_is_grey(void **state) {
  placido_maps maps = fabricate_maps(half_missing);
  placido_frame picture = draw(state, &maps, "axial");
  unsigned expected = colour_of_value("axial", 43.27);
  for (double meridian = -60; meridian <= 60; meridian += 5) {
    unsigned missing = colour_on_map(&picture, 2, meridian);
    assert_int_equal(missing >> 16, missing & 255);
    assert_int_equal(colour_on_map(&picture, 2, meridian + 180), expected);
  }
  placido_frame_free(&picture);
  fabricate_maps_free(&maps);
}

static void a_map_without_a_value_is_still_a_picture(void **state) {
  placido_maps maps = fabricate_maps(nothing);
  placido_frame picture = draw(state, &maps, "elevation");
  unsigned missing = colour_on_map(&picture, 2, 45);
  assert_int_equal(missing >> 16, missing & 255);
  placido_frame_free(&picture);
  fabricate_maps_free(&maps);
}

static void every_kind_can_be_drawn(void **state) {
  placido_maps maps = fabricate_maps(bowl);
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  for (size_t k = 0; k < count; k++) {
    placido_frame picture = draw(state, &maps, kinds[k].name);
    placido_frame_free(&picture);
  }
  fabricate_maps_free(&maps);
}

/* A cubic convolution of degree 2 precision reproduces a quadratic but for float rounding. */
static void a_quadratic_is_interpolated_exactly(void **state) {
  (void)state;
  placido_maps maps = fabricate_maps(bowl);
  placido_map_field field;
  assert_int_equal(placido_map_field_new(&field, &maps, maps.values[0], 333, NULL), PLACIDO_OK);
  for (int j = 60; j < 270; j += 7) {
    for (int i = 60; i < 270; i += 7) {
      double x = -4.5 + 9 * (i + 0.5) / 333, y = 4.5 - 9 * (j + 0.5) / 333;
      assert_true(fabs((double)field.values[j * 333 + i] - bowl(x, y)) < 1e-5);
    }
  }
  assert_true(isnan(field.values[0]));
  placido_map_field_free(&field);
  fabricate_maps_free(&maps);
}

static void error_bars_need_a_fit(void **state) {
  placido_maps maps = fabricate_maps(sphere_power);
  char *path = scratch_path(state, "sigma.png"), *folder = scratch_path(state, "");
  placido_error err = {0};
  assert_int_equal(placido_figure_sigma(&maps, "sigma_z", path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "sigma_z"));
  assert_int_equal(placido_figure_sigma(&maps, "sigma_q", path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "sigma_q"));
  assert_int_equal(scratch_count(folder), 0);
  maps.sigma_z_um = maps.values[0];
  assert_int_equal(placido_figure_sigma(&maps, "sigma_z", path, &err), PLACIDO_OK);
  assert_int_equal(scratch_count(folder), 1);
  fabricate_maps_free(&maps);
  free(folder);
  free(path);
}

static void a_kind_that_is_not_there_is_refused(void **state) {
  placido_maps maps = fabricate_maps(sphere_power);
  char *path = scratch_path(state, "map.png");
  placido_error err = {0};
  assert_int_equal(placido_figure_map(&maps, -1, path, &err), PLACIDO_INPUT);
  assert_int_equal(placido_figure_map(&maps, 1000, path, &err), PLACIDO_INPUT);
  fabricate_maps_free(&maps);
  free(path);
}

static void an_unwritable_path_is_named(void **state) {
  placido_maps maps = fabricate_maps(sphere_power);
  char *path = scratch_path(state, "missing/map.png"), *folder = scratch_path(state, "");
  placido_error err = {0};
  assert_int_equal(placido_figure_map(&maps, 0, path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "map.png"));
  assert_int_equal(scratch_count(folder), 0);
  fabricate_maps_free(&maps);
  free(folder);
  free(path);
}

static void a_figure_without_memory_leaves_nothing(void **state) {
  placido_maps maps = fabricate_maps(sphere_power);
  char *path = scratch_path(state, "map.png"), *folder = scratch_path(state, "");
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status != PLACIDO_OK && n < 100; n++) {
    placido_memory_fail_at(n);
    status = placido_figure_map(&maps, 0, path, NULL);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK || status == PLACIDO_MEMORY);
    assert_int_equal(scratch_count(folder), status == PLACIDO_OK);
  }
  assert_int_equal(status, PLACIDO_OK);
  fabricate_maps_free(&maps);
  free(folder);
  free(path);
}

#define SCRATCH_TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)

int main(void) {
  const struct CMUnitTest tests[] = {
      SCRATCH_TEST(a_sphere_has_one_colour),
      SCRATCH_TEST(what_data_do_not_support_is_grey),
      SCRATCH_TEST(a_map_without_a_value_is_still_a_picture),
      SCRATCH_TEST(every_kind_can_be_drawn),
      SCRATCH_TEST(a_quadratic_is_interpolated_exactly),
      SCRATCH_TEST(error_bars_need_a_fit),
      SCRATCH_TEST(a_kind_that_is_not_there_is_refused),
      SCRATCH_TEST(an_unwritable_path_is_named),
      SCRATCH_TEST(a_figure_without_memory_leaves_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
