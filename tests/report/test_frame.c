/* Pictures of frames: means over areas, every format, and the mires where they were found. */
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

static placido_frame load(const char *path) {
  placido_frame picture = {0};
  assert_int_equal(placido_frame_load(&picture, path, NULL), PLACIDO_OK);
  return picture;
}

static void a_smaller_picture_has_the_mean_of_areas(void **state) {
  char *path = scratch_path(state, "frame.png");
  placido_frame frame = fabricate_frame(6, 4, PLACIDO_MONO8);
  for (int k = 0; k < 6; k++) { /* columns 0, 50, 100 ... */
    for (int y = 0; y < 4; y++) {
      frame.data[(size_t)y * frame.stride_bytes + (size_t)k] = (uint8_t)(50 * k);
    }
  }
  assert_int_equal(placido_figure_frame(&frame, 3, path, NULL), PLACIDO_OK);
  placido_frame picture = load(path);
  assert_int_equal(picture.width_px, 3);
  assert_int_equal(picture.height_px, 2);
  assert_int_equal(colour_at(&picture, 0, 0), 0x191919); /* (0 + 50) / 2 */
  assert_int_equal(colour_at(&picture, 2, 1), 0xe1e1e1); /* (200 + 250) / 2 */
  placido_frame_free(&picture);
  placido_frame_free(&frame);
  free(path);
}

static void no_frame_is_made_larger(void **state) {
  char *path = scratch_path(state, "frame.png");
  placido_frame frame = fabricate_frame(6, 4, PLACIDO_MONO8);
  assert_int_equal(placido_figure_frame(&frame, 600, path, NULL), PLACIDO_OK);
  placido_frame picture = load(path);
  assert_int_equal(picture.width_px, 6);
  placido_frame_free(&picture);
  placido_frame_free(&frame);
  free(path);
}

static void every_format_shows_its_brightness(void **state) {
  char *path = scratch_path(state, "frame.png");
  placido_frame deep = fabricate_frame(2, 2, PLACIDO_MONO16);
  deep.bits = 12;
  uint16_t half = 2048;
  memcpy(deep.data, &half, sizeof half);
  assert_int_equal(placido_figure_frame(&deep, 2, path, NULL), PLACIDO_OK);
  placido_frame picture = load(path);
  assert_int_equal(colour_at(&picture, 0, 0), 0x808080);
  assert_int_equal(colour_at(&picture, 1, 1), 0);
  placido_frame colour = fabricate_frame(2, 2, PLACIDO_RGB8);
  memcpy(colour.data, "\xff\x80\x01", 3);
  assert_int_equal(placido_figure_frame(&colour, 2, path, NULL), PLACIDO_OK);
  placido_frame_free(&picture);
  picture = load(path);
  assert_int_equal(colour_at(&picture, 0, 0), 0xff8001);
  placido_frame_free(&picture);
  placido_frame_free(&deep);
  placido_frame_free(&colour);
  free(path);
}

static void an_empty_frame_is_refused(void **state) {
  char *path = scratch_path(state, "frame.png");
  placido_frame frame = {0};
  placido_mires mires = {0};
  placido_error err = {0};
  assert_int_equal(placido_figure_frame(&frame, 600, path, &err), PLACIDO_INPUT);
  assert_int_equal(placido_figure_mires(&frame, &mires, 0.01, path, &err), PLACIDO_INPUT);
  free(path);
}

static unsigned blue_less_red(unsigned colour) { return 0x100 + (colour & 255) - (colour >> 16); }

static void points_stand_where_they_were_found(void **state) {
  char *path = scratch_path(state, "mires.png");
  placido_frame frame = fabricate_frame(1280, 1024, PLACIDO_MONO8);
  placido_mires mires = fabricate_mires(640, 500, 40, 10);
  assert_int_equal(placido_figure_mires(&frame, &mires, 0.01, path, NULL), PLACIDO_OK);
  placido_frame picture = load(path);
  assert_int_equal(picture.width_px, 1280); /* one pixel a pixel, the legend below */
  assert_in_range(picture.height_px, 1025, 1150);
  for (size_t k = 180 * 5; k < mires.count; k += 7) { /* outside the numbers' meridian's crowd */
    const placido_mire_point *p = &mires.points[k];
    unsigned colour = colour_at(&picture, (int)lround(p->u_px), (int)lround(p->v_px));
    if (p->used && p->meridian_deg > 20 && p->meridian_deg < 340) {
      assert_true(p->edge % 2 == 0 ? blue_less_red(colour) > 0x140 : blue_less_red(colour) < 0xc0);
    }
  }
  placido_frame_free(&picture);
  placido_frame_free(&frame);
  free(mires.points);
  free(path);
}

static void a_photograph_is_cut_to_the_mires(void **state) {
  char *path = scratch_path(state, "mires.png");
  placido_frame frame = fabricate_frame(3000, 4000, PLACIDO_RGB8);
  placido_mires mires = fabricate_mires(1500, 2100, 10, 20);
  assert_int_equal(placido_figure_mires(&frame, &mires, 0.03, path, NULL), PLACIDO_OK);
  placido_frame picture = load(path);
  assert_in_range(picture.width_px, 800, 1400);
  assert_in_range(picture.height_px, 800, 1600);
  placido_frame_free(&picture);
  placido_frame_free(&frame);
  free(mires.points);
  free(path);
}

static void no_mires_and_no_scale_are_still_a_picture(void **state) {
  char *path = scratch_path(state, "mires.png");
  placido_frame frame = fabricate_frame(320, 200, PLACIDO_MONO16);
  placido_mires mires = {0};
  assert_int_equal(placido_figure_mires(&frame, &mires, NAN, path, NULL), PLACIDO_OK);
  assert_int_equal(placido_figure_mires(&frame, &mires, 0, path, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  free(path);
}

static void an_unwritable_path_is_named(void **state) {
  char *path = scratch_path(state, "missing/mires.png"), *folder = scratch_path(state, "");
  placido_frame frame = fabricate_frame(64, 64, PLACIDO_MONO8);
  placido_mires mires = fabricate_mires(32, 32, 4, 5);
  placido_error err = {0};
  assert_int_equal(placido_figure_mires(&frame, &mires, 0.01, path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "mires.png"));
  err.text[0] = '\0';
  assert_int_equal(placido_figure_frame(&frame, 64, path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "mires.png"));
  assert_int_equal(scratch_count(folder), 0);
  placido_frame_free(&frame);
  free(mires.points);
  free(folder);
  free(path);
}

#define SCRATCH_TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)

int main(void) {
  const struct CMUnitTest tests[] = {
      SCRATCH_TEST(a_smaller_picture_has_the_mean_of_areas),
      SCRATCH_TEST(no_frame_is_made_larger),
      SCRATCH_TEST(every_format_shows_its_brightness),
      SCRATCH_TEST(an_empty_frame_is_refused),
      SCRATCH_TEST(points_stand_where_they_were_found),
      SCRATCH_TEST(a_photograph_is_cut_to_the_mires),
      SCRATCH_TEST(no_mires_and_no_scale_are_still_a_picture),
      SCRATCH_TEST(an_unwritable_path_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
