/* Layers in depth: levels stand where things are, and laid over each other in focus the layers are
 * the picture again. */
#include "base/memory.h"
#include "base/random.h"
#include "simulate/canvas.h"
#include "simulate/depth/layers.h"
#include "simulate/depth/levels.h"
#include "simulate/depth/overlay.h"
#include "tests/support/near.h"

#include <string.h>

enum { WIDTH = 40, HEIGHT = 30, PIXELS = WIDTH * HEIGHT };

/* A page at 3.03 D before a window: two levels, exactly there, and not one between. */
static void test_what_stands_apart_has_its_own_level(void **state) {
  (void)state;
  const float depth_D[] = {0, 3.03f, 0, 3.03f, 3.03f};
  placido_levels levels;
  placido_levels_choose(&levels, depth_D, 5, 3.03, 0.02, 16);
  assert_int_equal(levels.count, 2);
  assert_near(levels.vergence_D[0], 0, 0);
  assert_near(levels.vergence_D[1], 3.03, 1e-6);
  assert_false(levels.joined[0]);
  float nearer;
  assert_int_equal(placido_levels_find(&levels, 0, &nearer), 0);
  assert_near(nearer, 0, 0);
  assert_int_equal(placido_levels_find(&levels, (double)depth_D[1], &nearer), 1);
  assert_near(nearer, 0, 0);
}

/* A slope from 1 to 2 D: uniform in dioptres, one level in focus, no more than there may be, and
 * shares that give every vergence back as the mean of its levels'. */
static void test_a_slope_is_divided_evenly_about_the_focus(void **state) {
  (void)state;
  float depth_D[1001];
  for (int i = 0; i <= 1000; i++) {
    depth_D[i] = 1 + (float)i / 1000;
  }
  for (int most = 3; most <= 30; most += 9) {
    placido_levels levels;
    bool focused = false;
    placido_levels_choose(&levels, depth_D, 1001, 1.4, 0.04, most);
    assert_true(levels.count <= most);
    assert_true(levels.count >= (most < 26 ? most / 2 : 26));
    for (int i = 0; i + 1 < levels.count; i++) {
      double step = levels.vergence_D[i + 1] - levels.vergence_D[i];
      assert_true(step > 0 && step <= levels.step_D * 1.000001);
      assert_true(levels.joined[i]);
    }
    for (int i = 0; i < levels.count; i++) {
      focused = focused || fabs(levels.vergence_D[i] - 1.4) < 1e-9;
    }
    assert_true(focused);
    for (int i = 0; i <= 1000; i++) {
      float nearer;
      int level = placido_levels_find(&levels, (double)depth_D[i], &nearer);
      double mean = levels.vergence_D[level] * (1 - (double)nearer);
      mean += nearer > 0 ? levels.vergence_D[level + 1] * (double)nearer : 0;
      assert_near(mean, (double)depth_D[i], 1e-6);
    }
  }
}

/* One level is the least, and then it is everything; two are the ends. */
static void test_one_level_is_possible(void **state) {
  (void)state;
  const float depth_D[] = {0, 1, 3};
  placido_levels levels;
  placido_levels_choose(&levels, depth_D, 3, 0, 0.02, 1);
  assert_int_equal(levels.count, 1);
  assert_near(levels.vergence_D[0], 1.5, 1e-6);
  placido_levels_choose(&levels, depth_D, 3, 1, 3, 2);
  assert_int_equal(levels.count, 2);
  assert_near(levels.vergence_D[1], 3, 0);
  float same = 2.5f;
  placido_levels_choose(&levels, &same, 1, 0, 0.02, 8);
  assert_int_equal(levels.count, 1);
  assert_near(levels.vergence_D[0], 2.5, 0);
}

/* A scene of noise: a slope with a hole through which something far is seen, and a pole before. */
typedef struct setting {
  placido_scene scene;
  placido_facts facts;
  placido_plan_settings settings;
  placido_scene_canvas canvas;
  placido_view view;
} setting;

static void set(setting *s, int planes, double bucket_arcmin, int layers) {
  memset(s, 0, sizeof *s);
  s->scene.arcmin_per_px = 0.5;
  assert_int_equal(placido_image_new(&s->scene.image, WIDTH, HEIGHT, planes, NULL), PLACIDO_OK);
  s->scene.depth_D = placido_memory_new(PIXELS, sizeof *s->scene.depth_D, NULL);
  for (int i = 0; i < PIXELS * planes; i++) {
    float light = (float)placido_random_uniform(7, 0, (unsigned)i, 0, 1);
    s->scene.image.data[i] = i / PIXELS == 3 ? 1 : light;
  }
  for (int i = 0; i < PIXELS; i++) {
    int x = i % WIDTH, y = i / WIDTH;
    bool hole = x > 20 && x < 30 && y > 5 && y < 20, pole = x == 10 || x == 11;
    s->scene.depth_D[i] = pole ? 4 : hole ? 0 : 1 + (float)x / WIDTH;
  }
  s->facts = (placido_facts){.planes = planes, .nearest_D = 4};
  s->settings = (placido_plan_settings){.layers = layers, .bucket_arcmin = bucket_arcmin};
  assert_int_equal(placido_scene_canvas_new(&s->canvas, &s->scene, bucket_arcmin, 0, 1, NULL),
                   PLACIDO_OK);
  s->view = (placido_view){.scene = &s->scene, .facts = &s->facts, .settings = &s->settings,
                           .eye.pupil_mm = 4, .threads = 2, .canvas = *s->canvas.image};
}

static void take_down(setting *s) {
  for (int i = 0; i < s->view.layer_count; i++) {
    placido_image_free(&s->view.layers[i].light);
    placido_memory_free(s->view.layers[i].cover);
  }
  placido_memory_free(s->view.layers);
  placido_scene_canvas_free(&s->canvas);
  placido_scene_free(&s->scene);
}

/* All layers of the view but the nearest `without`, in focus. Free with placido_image_free. */
static placido_image lay(const placido_view *view, int without) {
  placido_image seen;
  placido_overlay overlay;
  const placido_image *canvas = &view->canvas;
  assert_int_equal(placido_image_new(&seen, canvas->width_px, canvas->height_px,
                                     view->layers[0].light.planes, NULL), PLACIDO_OK);
  assert_int_equal(placido_overlay_new(&overlay, canvas, 1, 1, NULL), PLACIDO_OK);
  for (int i = view->layer_count - 1 - without; i >= 0; i--) {
    const placido_layer *layer = &view->layers[i];
    placido_image cover = {canvas->width_px, canvas->height_px, 1, layer->cover};
    cover.planes = layer->cover != NULL;
    placido_overlay_add(&overlay, &seen, &layer->light, &cover);
  }
  placido_overlay_free(&overlay);
  return seen;
}

static void test_layers_in_focus_are_the_picture(void **state) {
  (void)state;
  const int rows[][2] = {{1, 64}, {3, 64}, {3, 3}, {4, 7}, {3, 1}}; /* planes, layers */
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    setting s;
    set(&s, rows[k][0], 0.5, rows[k][1]);
    assert_int_equal(placido_layers_fill(&s.view, 1.5, NULL), PLACIDO_OK);
    assert_true(s.view.layer_count <= rows[k][1]);
    for (int i = 1; i < s.view.layer_count; i++) {
      assert_true(s.view.layers[i].defocus_D < s.view.layers[i - 1].defocus_D);
    }
    placido_image seen = lay(&s.view, 0);
    for (int i = 0; i < PIXELS * seen.planes; i++) {
      assert_near((double)seen.data[i], (double)s.scene.image.data[i], 1e-6);
    }
    placido_image_free(&seen);
    take_down(&s);
  }
}

/* Coarser buckets mix colours and covers alike: an even scene stays even. */
static void test_an_even_scene_stays_even_at_any_scale(void **state) {
  (void)state;
  setting s;
  set(&s, 1, 0.75, 16);
  for (int i = 0; i < PIXELS; i++) {
    s.scene.image.data[i] = 0.6f;
  }
  assert_int_equal(placido_layers_fill(&s.view, 0, NULL), PLACIDO_OK);
  size_t pixels = (size_t)s.view.canvas.width_px * (size_t)s.view.canvas.height_px;
  assert_true(pixels < PIXELS / 2);
  for (int i = 0; i < s.view.layer_count; i++) {
    assert_int_equal(s.view.layers[i].light.width_px, s.view.canvas.width_px);
  }
  placido_image seen = lay(&s.view, 0);
  for (size_t i = 0; i < pixels; i++) {
    assert_near((double)seen.data[i], 0.6, 1e-6);
  }
  placido_image_free(&seen);
  take_down(&s);
}

/* Behind the pole the slope goes on with the light of the nearest pixel that shows. */
static void test_what_is_hidden_is_continued_from_its_rim(void **state) {
  (void)state;
  setting s;
  set(&s, 1, 0.5, 64);
  assert_int_equal(placido_layers_fill(&s.view, 0, NULL), PLACIDO_OK);
  placido_image seen = lay(&s.view, 1); /* all but the pole */
  for (int y = 0; y < HEIGHT; y++) {
    const float *from = s.scene.image.data + y * WIDTH, *to = seen.data + y * WIDTH;
    assert_near((double)to[10], (double)from[9], 1e-6);
    assert_near((double)to[11], (double)from[12], 1e-6);
  }
  placido_image_free(&seen);
  take_down(&s);
}

static void test_one_distance_needs_no_cover(void **state) {
  (void)state;
  setting s;
  set(&s, 3, 0.5, 64);
  s.facts.nearest_D = s.facts.farthest_D = 1.5;
  assert_int_equal(placido_layers_fill(&s.view, 1.5, NULL), PLACIDO_OK);
  assert_int_equal(s.view.layer_count, 0);
  assert_int_equal(placido_layers_fill(&s.view, 0.5, NULL), PLACIDO_OK);
  assert_int_equal(s.view.layer_count, 1);
  assert_null(s.view.layers[0].cover);
  assert_near(s.view.layers[0].defocus_D, -1, 1e-12);
  take_down(&s);
}

/* Of a whole cover `core` is spread nearby and the rest strays: it is whole nevertheless. And two
 * halves of one surface leave nothing open, nor do they take more than there is. */
static void test_a_whole_cover_leaves_nothing_open(void **state) {
  (void)state;
  float covers[3] = {0.9f, 0.45f, 0.63f}, near_light[3] = {0.18f, 0.09f, 0.14f},
        far_light[3] = {0.9f, 0.9f, 0.9f}, sums[3] = {0, 0, 0};
  placido_image seen = {3, 1, 1, sums}, cover = {3, 1, 1, covers}, light = {3, 1, 1, near_light},
                far = {3, 1, 1, far_light}, all = {0};
  placido_overlay overlay;
  assert_int_equal(placido_overlay_new(&overlay, &seen, 1, 0.9, NULL), PLACIDO_OK);
  placido_overlay_add(&overlay, &seen, &light, &cover);
  placido_overlay_add(&overlay, &seen, &light, &cover);
  placido_overlay_add(&overlay, &seen, &far, &all);
  assert_near((double)sums[0], 0.18, 1e-6);
  assert_near((double)sums[1], 0.18, 1e-6);
  assert_near((double)sums[2], 0.14 * (1 + 0.3 / 0.7), 1e-6);
  placido_overlay_free(&overlay);
}

static void test_no_allocation_is_unchecked(void **state) {
  (void)state;
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status != PLACIDO_OK; n++) {
    setting s;
    set(&s, 3, 0.75, 6);
    placido_memory_fail_at(n);
    status = placido_layers_fill(&s.view, 1, NULL);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK || status == PLACIDO_MEMORY);
    assert_true(status == PLACIDO_MEMORY || n > 10);
    take_down(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_what_stands_apart_has_its_own_level),
    cmocka_unit_test(test_a_slope_is_divided_evenly_about_the_focus),
    cmocka_unit_test(test_one_level_is_possible),
    cmocka_unit_test(test_layers_in_focus_are_the_picture),
    cmocka_unit_test(test_an_even_scene_stays_even_at_any_scale),
    cmocka_unit_test(test_what_is_hidden_is_continued_from_its_rim),
    cmocka_unit_test(test_one_distance_needs_no_cover),
    cmocka_unit_test(test_a_whole_cover_leaves_nothing_open),
    cmocka_unit_test(test_no_allocation_is_unchecked),
  };
  return cmocka_run_group_tests_name("simulate_layers", tests, NULL, NULL);
}
