/* The canvas: a scene's picture at the PSF's scale, within its bleed. */
#include "simulate/canvas.h"
#include "base/memory.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

/* A picture whose samples all differ; to be freed with placido_scene_free. */
static placido_scene scene_of(int width, int height, int planes, int bleed) {
  placido_scene scene = {.name = "test", .arcmin_per_px = 0.5, .bleed_px = bleed, .bits = 8};
  assert_int_equal(placido_image_new(&scene.image, width, height, planes, NULL), PLACIDO_OK);
  for (int i = 0; i < width * height * planes; i++) {
    scene.image.data[i] = (float)(i % 97) / 97;
  }
  return scene;
}

static placido_scene_canvas canvas_of(const placido_scene *scene, double bucket_arcmin, int reach) {
  placido_scene_canvas canvas;
  placido_error err = {0};
  if (placido_scene_canvas_new(&canvas, scene, bucket_arcmin, reach, 1, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return canvas;
}

static void picture_that_fits_is_not_copied(void **state) {
  (void)state;
  placido_scene photograph = scene_of(20, 10, 3, 0), chart = scene_of(20, 10, 1, 4);
  placido_scene_canvas canvas = canvas_of(&photograph, 0.5, 100);
  assert_ptr_equal(canvas.image, &photograph.image);
  assert_null(canvas.own.data);
  assert_int_equal(canvas.bleed_px, 0);
  assert_false(canvas.holes);
  placido_scene_canvas_free(&canvas);
  canvas = canvas_of(&chart, 0.5, 4); /* its bleed is as wide as light reaches */
  assert_ptr_equal(canvas.image, &chart.image);
  assert_int_equal(canvas.bleed_px, 4);
  placido_scene_canvas_free(&canvas);
  placido_scene_free(&photograph);
  placido_scene_free(&chart);
}

static void bleed_reaches_as_far_as_light(void **state) {
  (void)state;
  placido_scene chart = scene_of(20, 10, 1, 4);
  placido_scene_canvas canvas = canvas_of(&chart, 0.5, 9);
  assert_int_equal(canvas.bleed_px, 9);
  assert_int_equal(canvas.image->width_px, 30);
  assert_int_equal(canvas.image->height_px, 20);
  for (int y = 0; y < 20; y++) {
    for (int x = 0; x < 30; x++) {
      int from_x = x < 5 ? 0 : x < 25 ? x - 5 : 19, from_y = y < 5 ? 0 : y < 15 ? y - 5 : 9;
      assert_true(canvas.image->data[y * 30 + x] == chart.image.data[from_y * 20 + from_x]);
    }
  }
  placido_scene_canvas_free(&canvas);
  placido_scene_free(&chart);
}

/* Two pixels a bucket: each is the mean of four. */
static void finer_pictures_are_brought_to_scale(void **state) {
  (void)state;
  placido_scene scene = scene_of(24, 16, 1, 4);
  placido_scene_canvas canvas = canvas_of(&scene, 1, 0);
  assert_int_equal(canvas.bleed_px, 2);
  assert_int_equal(canvas.image->width_px, 12);
  assert_int_equal(canvas.image->height_px, 8);
  for (int y = 0; y < 8; y++) {
    for (int x = 0; x < 12; x++) {
      const float *from = scene.image.data + 2 * y * 24 + 2 * x;
      double mean = ((double)from[0] + (double)from[1] + (double)from[24] + (double)from[25]) / 4;
      assert_near((double)canvas.image->data[y * 12 + x], mean, 1e-6); /* floats */
    }
  }
  placido_scene_canvas_free(&canvas);
  placido_scene_free(&scene);
}

static void colours_are_weighted_where_there_are_holes(void **state) {
  (void)state;
  placido_scene scene = scene_of(8, 6, 4, 0);
  float *alpha = placido_image_plane(&scene.image, 3);
  for (int i = 0; i < 48; i++) {
    alpha[i] = i == 11 ? 0.25f : i == 12 ? 0 : 1;
  }
  placido_scene_canvas canvas = canvas_of(&scene, 0.5, 0);
  assert_true(canvas.holes);
  for (int plane = 0; plane < 3; plane++) {
    const float *is = placido_image_plane(canvas.image, plane);
    const float *was = placido_image_plane(&scene.image, plane);
    assert_true(is[10] == was[10] && is[11] == was[11] * 0.25f && is[12] == 0);
  }
  placido_scene_canvas_unweigh(&canvas.own);
  for (int plane = 0; plane < 3; plane++) {
    const float *is = placido_image_plane(canvas.image, plane);
    const float *was = placido_image_plane(&scene.image, plane);
    assert_near((double)is[11], (double)was[11], 1e-6);
    assert_true(is[12] == 0); /* where there is nothing there is no colour */
  }
  placido_scene_canvas_free(&canvas);
  placido_scene_free(&scene);
}

static void wrong_scenes_are_refused_with_the_reason(void **state) {
  (void)state;
  static const struct {
    int planes, bleed, status;
    double arcmin_per_px;
    const char *says;
  } cases[] = {{2, 0, PLACIDO_INPUT, 0.5, "2 planes"},
               {1, -1, PLACIDO_INPUT, 0.5, "bleed of -1 px"},
               {1, 5, PLACIDO_INPUT, 0.5, "buckets"},
               {1, 0, PLACIDO_INPUT, 0, "0 arcmin per pixel"},
               {1, 0, PLACIDO_INPUT, 1e6, "buckets"},
               {1, 0, PLACIDO_QUALITY, 0.6, "too coarse"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    placido_scene scene = scene_of(10, 10, cases[i].planes, cases[i].bleed);
    placido_scene_canvas canvas;
    placido_error err = {0};
    scene.arcmin_per_px = cases[i].arcmin_per_px;
    scene.allow_coarse = cases[i].status == PLACIDO_INPUT;
    assert_int_equal(placido_scene_canvas_new(&canvas, &scene, 0.5, 3, 1, &err), cases[i].status);
    assert_non_null(strstr(err.text, cases[i].says));
    assert_null(canvas.own.data);
    placido_scene_free(&scene);
  }
}

static void every_failed_allocation_is_told(void **state) {
  (void)state;
  placido_scene scene = scene_of(24, 16, 4, 4);
  scene.image.data[3 * 24 * 16 + 5] = 0.5f;
  unsigned long count = 0;
  for (unsigned long n = 0; n <= count; n++) {
    placido_scene_canvas canvas;
    placido_memory_fail_at(n);
    int status = placido_scene_canvas_new(&canvas, &scene, 1, 9, 1, NULL);
    unsigned long made = placido_memory_fail_at(0);
    count = n == 0 ? made : count;
    assert_int_equal(status, n == 0 ? PLACIDO_OK : PLACIDO_MEMORY);
    placido_scene_canvas_free(&canvas);
  }
  assert_true(count >= 3); /* the weighted, the resampled and the widened one */
  placido_scene_free(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(picture_that_fits_is_not_copied),
    cmocka_unit_test(bleed_reaches_as_far_as_light),
    cmocka_unit_test(finer_pictures_are_brought_to_scale),
    cmocka_unit_test(colours_are_weighted_where_there_are_holes),
    cmocka_unit_test(wrong_scenes_are_refused_with_the_reason),
    cmocka_unit_test(every_failed_allocation_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
