/* The facts of a scene are what looking at every sample by itself finds. */
#include "simulate/effects/facts.h"

#include <math.h>
#include <string.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

static placido_scene scene_of(int width_px, int height_px, int planes) {
  placido_scene scene = {.arcmin_per_px = 0.5, .conditions = {.distance_m = INFINITY}};
  uint32_t state = 12345;
  assert_int_equal(placido_image_new(&scene.image, width_px, height_px, planes, NULL), PLACIDO_OK);
  for (size_t i = 0; i < (size_t)width_px * (size_t)height_px * (size_t)planes; i++) {
    state = state * 1664525u + 1013904223u;
    scene.image.data[i] = (float)(state >> 8) / 16777216.0f;
  }
  return scene;
}

static double sample(const placido_scene *scene, int plane, int x, int y) {
  return (double)placido_image_plane(&scene->image, plane)[y * scene->image.width_px + x];
}

/* The largest step right or down from anywhere. */
static double step_of(const placido_scene *scene, int plane) {
  const placido_image *image = &scene->image;
  double most = 0;
  for (int y = 0; y < image->height_px; y++) {
    for (int x = 0; x < image->width_px; x++) {
      double here = sample(scene, plane, x, y);
      if (x + 1 < image->width_px) {
        most = fmax(most, fabs(sample(scene, plane, x + 1, y) - here));
      }
      if (y + 1 < image->height_px) {
        most = fmax(most, fabs(sample(scene, plane, x, y + 1) - here));
      }
    }
  }
  return most;
}

static void check_planes(const placido_scene *scene, const placido_facts *facts) {
  const placido_image *image = &scene->image;
  for (int plane = 0; plane < facts->planes; plane++) {
    double least = INFINITY, most = -INFINITY;
    for (int y = 0; y < image->height_px; y++) {
      for (int x = 0; x < image->width_px; x++) {
        least = fmin(least, sample(scene, plane, x, y));
        most = fmax(most, sample(scene, plane, x, y));
      }
    }
    assert_true(facts->darkest[plane] == least && facts->brightest[plane] == most);
    assert_true(fabs(facts->step[plane] - step_of(scene, plane)) < 1e-7); /* float differences */
  }
}

/* Cell (column, row) by asking every sample whether it is inside. */
static void check_cell(const placido_scene *scene, const placido_facts *facts, int column,
                       int row) {
  const double side_px = facts->cell_arcmin / scene->arcmin_per_px;
  const int cell = row * facts->columns + column, planes = facts->planes;
  double sums[3] = {0}, least = INFINITY, most = -INFINITY;
  long count = 0;
  for (int y = 0; y < scene->image.height_px; y++) {
    for (int x = 0; x < scene->image.width_px; x++) {
      if ((int)(x / side_px) != column || (int)(y / side_px) != row) {
        continue;
      }
      count++;
      for (int plane = 0; plane < planes; plane++) {
        double value = sample(scene, plane, x, y);
        sums[plane] += value;
        least = fmin(least, value);
        most = fmax(most, value);
      }
    }
  }
  double luminance = planes == 1 ? sums[0] : 0.2126 * sums[0] + 0.7152 * sums[1] + 0.0722 * sums[2];
  assert_true(count > 0);
  assert_true((double)facts->least[cell] == least && (double)facts->most[cell] == most);
  /* sums of floats: a few hundred roundings of 6e-8 */
  assert_true(fabs((double)facts->luminance[cell] - luminance / (double)count) < 1e-5);
  for (int plane = 0; plane < planes; plane++) {
    assert_true(fabs((double)facts->light[plane][cell] - sums[plane] / (double)count) < 1e-5);
  }
}

static void check_all(int width_px, int height_px, int planes) {
  placido_scene scene = scene_of(width_px, height_px, planes);
  placido_facts facts;
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_int_equal(facts.planes, planes);
  check_planes(&scene, &facts);
  assert_true(facts.columns <= PLACIDO_FACTS_SIDE && facts.rows <= PLACIDO_FACTS_SIDE);
  for (int row = 0; row < facts.rows; row++) {
    for (int column = 0; column < facts.columns; column++) {
      check_cell(&scene, &facts, column, row);
    }
  }
  placido_image_free(&scene.image);
}

/* Sizes around the lengths of vectors, of groups of rows and of strips of columns. */
static void every_sample_counts(void **state) {
  (void)state;
  check_all(97, 61, 3);
  check_all(1061, 30, 3);
  check_all(31, 77, 1);
  check_all(1, 1, 1);
  check_all(2, 40, 3);
  check_all(16, 5, 1);
}

/* The last column has no right neighbour: not the next row's first. */
static void rows_do_not_run_into_each_other(void **state) {
  (void)state;
  placido_scene scene = scene_of(40, 24, 1);
  placido_facts facts;
  for (int i = 0; i < 40 * 24; i++) {
    scene.image.data[i] = (float)(i % 40) / 39.0f;
  }
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(fabs(facts.step[0] - 1 / 39.0) < 1e-6);
  placido_image_free(&scene.image);
}

static void colour_is_the_largest_difference_of_planes(void **state) {
  (void)state;
  placido_scene scene = scene_of(50, 30, 3);
  placido_facts facts;
  for (int plane = 0; plane < 3; plane++) {
    for (int i = 0; i < 50 * 30; i++) {
      placido_image_plane(&scene.image, plane)[i] = 0.5f;
    }
  }
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(facts.colour == 0);
  placido_image_plane(&scene.image, 2)[77] = 0.75f;
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(facts.colour == 0.25);
  placido_image_free(&scene.image);
}

static void what_is_seen_is_without_bleed(void **state) {
  (void)state;
  placido_scene scene = scene_of(140, 100, 1);
  placido_facts facts;
  scene.bleed_px = 10;
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(fabs(facts.width_deg - 1) < 1e-12 && fabs(facts.height_deg - 80.0 / 120) < 1e-12);
  placido_image_free(&scene.image);
}

static void distance_and_depth_are_vergences(void **state) {
  (void)state;
  placido_scene scene = scene_of(20, 10, 1);
  placido_facts facts;
  float depth_D[200];
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(facts.focus_D == 0 && facts.nearest_D == 0 && facts.farthest_D == 0);
  scene.conditions.distance_m = 0.5;
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(facts.focus_D == 2 && facts.nearest_D == 2 && facts.farthest_D == 2);
  for (int i = 0; i < 200; i++) {
    depth_D[i] = 1 + 0.01f * (float)i;
  }
  scene.depth_D = depth_D;
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(facts.focus_D == 2 && facts.farthest_D == 1);
  assert_true(fabs(facts.nearest_D - 2.99) < 1e-6);
  placido_image_free(&scene.image);
}

/* A transparent pixel: at its rim what shows through may be as dark as can be. */
static void holes_may_be_the_largest_step(void **state) {
  (void)state;
  placido_scene scene = scene_of(30, 30, 4);
  placido_facts facts;
  for (int i = 0; i < 30 * 30; i++) {
    for (int plane = 0; plane < 4; plane++) {
      placido_image_plane(&scene.image, plane)[i] = plane == 3 ? 1 : 0.6f;
    }
  }
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(facts.planes == 3 && facts.step[1] == 0);
  placido_image_plane(&scene.image, 3)[444] = 0.5f;
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  assert_true(facts.step[1] == facts.brightest[1] && facts.brightest[1] == (double)0.6f);
  placido_image_free(&scene.image);
}

static void no_picture_is_refused(void **state) {
  (void)state;
  placido_scene scene = {.name = "empty", .arcmin_per_px = 0.5};
  placido_facts facts;
  placido_error err;
  assert_int_equal(placido_facts_find(&facts, &scene, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "empty"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_sample_counts),
    cmocka_unit_test(rows_do_not_run_into_each_other),
    cmocka_unit_test(colour_is_the_largest_difference_of_planes),
    cmocka_unit_test(what_is_seen_is_without_bleed),
    cmocka_unit_test(distance_and_depth_are_vergences),
    cmocka_unit_test(holes_may_be_the_largest_step),
    cmocka_unit_test(no_picture_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
