/* The figure of a PSF shows the part that holds the light, the right way up. */
#include "report/psf_view.h"
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

/* The plan's square in the picture; see figure_psf.c. */
enum { PLAN_LEFT = 764, PLAN_TOP = 78, PLAN_SIDE = 460 };

static void set(placido_psf *psf, int right, int up, double value) {
  int centre = psf->n / 2;
  psf->values[(size_t)(centre - up) * (size_t)psf->n + (size_t)(centre + right)] = value;
}

static void a_point_is_shown_with_five_minutes_around_it(void **state) {
  (void)state;
  placido_psf psf = fabricate_psf(257);
  placido_psf_view view;
  assert_int_equal(placido_psf_view_find(&view, &psf, NULL), PLACIDO_OK);
  assert_int_equal(view.half, 10); /* 10 buckets of half a minute */
  assert_true(view.tick_arcmin == 1);
  free(psf.values);
}

static void the_view_holds_ninety_nine_per_cent(void **state) {
  (void)state;
  placido_psf psf = fabricate_psf(257);
  set(&psf, 0, 0, 0.97);
  set(&psf, -40, 12, 0.02);
  set(&psf, 0, 100, 0.005);
  placido_psf_view view;
  assert_int_equal(placido_psf_view_find(&view, &psf, NULL), PLACIDO_OK);
  assert_int_equal(view.half, 40);
  set(&psf, 0, 100, 0.05);
  assert_int_equal(placido_psf_view_find(&view, &psf, NULL), PLACIDO_OK);
  assert_int_equal(view.half, 100);
  free(psf.values);
}

static void a_small_psf_is_shown_whole(void **state) {
  (void)state;
  placido_psf psf = fabricate_psf(5);
  placido_psf_view view;
  assert_int_equal(placido_psf_view_find(&view, &psf, NULL), PLACIDO_OK);
  assert_int_equal(view.half, 2);
  free(psf.values);
}

static void up_is_up_and_right_is_right(void **state) {
  char *path = scratch_path(state, "psf.png");
  placido_psf psf = fabricate_psf(257);
  set(&psf, 6, 3, 1); /* 3 minutes to the right, 1.5 up */
  assert_int_equal(placido_figure_psf(&psf, path, NULL), PLACIDO_OK);
  placido_frame picture = {0};
  assert_int_equal(placido_frame_load(&picture, path, NULL), PLACIDO_OK);
  assert_int_equal(picture.width_px, 1360);
  assert_int_equal(picture.height_px, 680);
  double bucket_px = PLAN_SIDE / 21.0;
  int x = (int)(PLAN_LEFT + bucket_px * 16.5), y = (int)(PLAN_TOP + bucket_px * 7.5);
  int mirror_x = (int)(PLAN_LEFT + bucket_px * 4.5), mirror_y = (int)(PLAN_TOP + bucket_px * 13.5);
  assert_true(colour_at(&picture, x, y) != 0xffffff);
  assert_int_equal(colour_at(&picture, mirror_x, y), 0xffffff);
  assert_int_equal(colour_at(&picture, x, mirror_y), 0xffffff);
  placido_frame_free(&picture);
  free(psf.values);
  free(path);
}

static void light_over_the_whole_field_is_drawn_in_blocks(void **state) {
  char *path = scratch_path(state, "psf.png");
  placido_psf psf = fabricate_psf(257);
  for (size_t k = 0; k < 257 * 257; k++) {
    psf.values[k] = 1.0 / (257 * 257);
  }
  assert_int_equal(placido_figure_psf(&psf, path, NULL), PLACIDO_OK);
  free(psf.values);
  free(path);
}

static void a_psf_without_light_is_refused(void **state) {
  char *path = scratch_path(state, "psf.png"), *folder = scratch_path(state, "");
  placido_psf psf = fabricate_psf(257), empty = {0};
  placido_error err = {0};
  set(&psf, 0, 0, 0);
  assert_int_equal(placido_figure_psf(&psf, path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "no light"));
  assert_int_equal(placido_figure_psf(&empty, path, &err), PLACIDO_INPUT);
  assert_int_equal(scratch_count(folder), 0);
  free(psf.values);
  free(folder);
  free(path);
}

static void an_unwritable_path_is_named(void **state) {
  char *path = scratch_path(state, "missing/psf.png");
  placido_psf psf = fabricate_psf(33);
  placido_error err = {0};
  assert_int_equal(placido_figure_psf(&psf, path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "psf.png"));
  free(psf.values);
  free(path);
}

#define SCRATCH_TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_point_is_shown_with_five_minutes_around_it),
      cmocka_unit_test(the_view_holds_ninety_nine_per_cent),
      cmocka_unit_test(a_small_psf_is_shown_whole),
      SCRATCH_TEST(up_is_up_and_right_is_right),
      SCRATCH_TEST(light_over_the_whole_field_is_drawn_in_blocks),
      SCRATCH_TEST(a_psf_without_light_is_refused),
      SCRATCH_TEST(an_unwritable_path_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
