/* Object distance: what is out of focus is blurred by the disc of the pupil (closed form), and near
 * things hide far ones as rays have it (brute force over the pupil). The cornea is free of
 * aberrations, so that nothing else blurs. */
#include "eyes.h"
#include "simulate/effects/effect.h"
#include "simulate/models/accommodation.h"
#include "simulate/plan/run.h"
#include "tests/support/near.h"

#include "base/memory.h"

#include <placido/scene.h>

#include <stdbool.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double arcmin_per_D_mm = 3.4377467707849396; /* a milliradian in minutes of arc */
static const double apex_mm = 7.8, index_n = 1.3375, px_arcmin = 0.5;

/* Light as a function of the place, minutes of arc from the picture's middle. */
typedef double (*texture)(double x, double y);

static double vergence_of(double distance_m) { return isinf(distance_m) ? 0 : 1 / distance_m; }

/* An eye focused far away, whatever its age. */
static placido_eye eye_of(double pupil_mm, double age_years) {
  return (placido_eye){.pupil_mm = pupil_mm, .index = index_n, .age_years = age_years,
                       .retina_mm = apex_mm * index_n / (index_n - 1)};
}

static double middle_of(int pixel, int count) { return (pixel + 0.5 - 0.5 * count) * px_arcmin; }

/* A scene of one plane; `depth_D` may be NULL. */
static placido_scene scene_of(int width, int height, texture light, texture depth_D,
                              double distance_m) {
  placido_scene scene = {.arcmin_per_px = px_arcmin, .bits = 8};
  scene.conditions.distance_m = distance_m;
  assert_int_equal(placido_image_new(&scene.image, width, height, 1, NULL), PLACIDO_OK);
  size_t pixels = (size_t)width * (size_t)height;
  scene.depth_D = depth_D != NULL ? placido_memory_new(pixels, sizeof *scene.depth_D, NULL) : NULL;
  for (int i = 0; i < (int)pixels; i++) {
    double x = middle_of(i % width, width), y = middle_of(i / width, height);
    scene.image.data[i] = (float)light(x, y);
    if (depth_D != NULL) {
      scene.depth_D[i] = (float)depth_D(x, y);
    }
  }
  return scene;
}

/* The scene through this effect and no other. */
static placido_image see(const placido_scene *scene, double pupil_mm, double age_years,
                         int layers) {
  const placido_effect *effects[] = {&placido_effect_object_distance};
  placido_surface *surface = conic(apex_mm, -1 / (index_n * index_n));
  placido_plan_settings settings = {.pupil_samples = 101, .wavelengths = 1, .layers = layers,
                                    .nodes = 1, .bucket_arcmin = px_arcmin, .buckets = 65};
  placido_eye eye = eye_of(pupil_mm, age_years);
  placido_facts facts;
  placido_error err = {0};
  placido_image seen;
  assert_int_equal(placido_facts_find(&facts, scene, &err), PLACIDO_OK);
  const placido_run run = {.surface = surface, .scene = scene, .facts = &facts,
                           .settings = &settings, .eye = &eye, .effects = effects, .count = 1,
                           .threads = 2};
  if (placido_view_run(&seen, NULL, &run, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  placido_surface_free(surface);
  return seen;
}

/* What the effect answers about a scene. */
static placido_answer ask(placido_scene *scene, double age_years, placido_strokes *strokes) {
  placido_facts facts;
  placido_eye eye = eye_of(4, age_years);
  placido_answer answer = {.strokes = strokes};
  *strokes = (placido_strokes){0};
  assert_int_equal(placido_facts_find(&facts, scene, NULL), PLACIDO_OK);
  const placido_question question = {.scene = scene, .facts = &facts, .eye = &eye,
                                     .bucket_arcmin = px_arcmin, .tolerance = 0.01};
  placido_effect_object_distance.ask(&question, &answer);
  return answer;
}

static void test_amplitudes_are_hofstetters(void **state) {
  (void)state;
  assert_near(placido_accommodation_amplitude_D(10), 15.5, 1e-12);
  assert_near(placido_accommodation_amplitude_D(35), 8, 1e-12);
  assert_near(placido_accommodation_amplitude_D(0), 8, 1e-12); /* the age that is not given */
  assert_near(placido_accommodation_amplitude_D(60), 0.5, 1e-12);
  assert_near(placido_accommodation_amplitude_D(65), 0, 0);
  assert_near(placido_accommodation_response_D(3, 35), 3, 0);
  assert_near(placido_accommodation_response_D(3, 55), 2, 1e-12);
}

static void test_a_monitor_is_for_the_young(void **state) {
  (void)state;
  placido_scene scene;
  placido_strokes strokes;
  assert_int_equal(placido_scene_load(&scene, "monitor", 1, NULL, NULL), PLACIDO_OK);
  placido_answer answer = ask(&scene, 35, &strokes);
  assert_false(answer.applies);
  assert_non_null(strstr(answer.reason, "0.6 m"));
  answer = ask(&scene, 65, &strokes);
  assert_true(answer.applies);
  assert_near(strokes.defocus_D, -1 / 0.6, 1e-9);
  assert_non_null(strstr(answer.reason, "at 65 years"));
  placido_scene_free(&scene);
}

static void test_far_scenes_have_nothing_to_do(void **state) {
  (void)state;
  placido_scene scene;
  placido_strokes strokes;
  assert_int_equal(placido_scene_load(&scene, "building", 2, NULL, NULL), PLACIDO_OK);
  placido_answer answer = ask(&scene, 80, &strokes);
  assert_false(answer.applies);
  assert_non_null(strstr(answer.reason, "far"));
  placido_scene_free(&scene);
}

/* Whoever looks at the page has the window out of focus; an old eye has the page. */
static void test_a_page_before_a_window_is_for_nobody(void **state) {
  (void)state;
  placido_scene scene;
  placido_strokes strokes;
  assert_int_equal(placido_scene_load(&scene, "page", 1, NULL, NULL), PLACIDO_OK);
  placido_answer answer = ask(&scene, 35, &strokes);
  assert_true(answer.applies);
  assert_near(strokes.defocus_D, 1 / 0.33, 1e-6);
  assert_non_null(strstr(answer.reason, "which the eye can"));
  answer = ask(&scene, 70, &strokes);
  assert_near(strokes.defocus_D, -1 / 0.33, 0.11); /* the lower end of the page, which leans */
  placido_scene_free(&scene);
}

static double edge(double x, double y) {
  (void)y;
  return x < 0 ? 0.1 : 0.9;
}

/* The part of a disc of radius 1 to the left of u. */
static double disc_left_of(double u) {
  u = fmin(fmax(u, -1), 1);
  return 0.5 + (u * sqrt(1 - u * u) + asin(u)) / pi;
}

/* An edge through a disc of 3.438' x pupil x dioptres. A bucket of 0.5' cuts the disc's rim: over
 * 11' that is worth 0.5 %. */
static void test_an_edge_is_blurred_by_the_disc_of_the_pupil(void **state) {
  (void)state;
  const struct {
    double pupil_mm, age_years, distance_m;
  } rows[] = {{4, 65, 0.6}, {3, 60, 0.5}, {4, 50, 0.2}, {4, 35, 0.5}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    const int width = 120, height = 60;
    placido_scene scene = scene_of(width, height, edge, NULL, rows[k].distance_m);
    placido_image seen = see(&scene, rows[k].pupil_mm, rows[k].age_years, 8);
    double short_D = fmax(vergence_of(rows[k].distance_m) - fmax(18.5 - 0.3 * rows[k].age_years, 0),
                          0);
    double radius = 0.5 * arcmin_per_D_mm * rows[k].pupil_mm * short_D;
    for (int x = 26; x < width - 26; x++) {
      double u = middle_of(x, width);
      double share = radius > 0 ? disc_left_of(u / radius) : u > 0;
      assert_near((double)seen.data[height / 2 * width + x], 0.1 + 0.8 * share, 0.005);
    }
    placido_image_free(&seen);
    placido_scene_free(&scene);
  }
}

/* A near half-plane to the left, with stripes across its edge and along it; the far plane has
 * others, which go on behind it as they are at its rim. */
static double near_light(double x, double y) {
  return 0.45 + 0.2 * cos(2 * pi * x / 9) + 0.2 * cos(2 * pi * y / 7);
}

static double far_light(double x, double y) {
  return 0.5 + 0.25 * cos(2 * pi * fmax(x, 0) / 8) + 0.2 * cos(2 * pi * y / 6 + 1);
}

static double half_light(double x, double y) { return x < 0 ? near_light(x, y) : far_light(x, y); }

static double half_depth_D(double x, double y) {
  (void)y;
  return x < 0 ? 1.2 : 0.2;
}

/* A ray from (x, y) on the retina through a point of the pupil passes the near plane or meets it,
 * and then reaches the far one. */
static double look_past_the_edge(double x, double y, const double pupil_mm[2], double focus_D) {
  double near_by = arcmin_per_D_mm * (focus_D - half_depth_D(-1, 0));
  double far_by = arcmin_per_D_mm * (focus_D - half_depth_D(1, 0));
  double near_x = x + near_by * pupil_mm[0];
  return near_x < 0 ? near_light(near_x, y + near_by * pupil_mm[1])
                    : far_light(x + far_by * pupil_mm[0], y + far_by * pupil_mm[1]);
}

/* A slanted plane: from 0.5 D at the left rim of 100' to 1.5 D at the right one. */
static const double slope_D = 0.01, slope_middle_D = 1;

static double slant_light(double x, double y) {
  return 0.5 + 0.25 * cos(2 * pi * x / 7 + 2 * sin(y / 9)) + 0.2 * cos(2 * pi * y / 5);
}

static double slant_depth_D(double x, double y) {
  (void)y;
  return slope_middle_D + slope_D * x;
}

/* Where a ray meets it: at X where x + k p (focus - depth(X)) = X. */
static double look_at_the_slant(double x, double y, const double pupil_mm[2], double focus_D) {
  double k = arcmin_per_D_mm;
  double at = (x + k * pupil_mm[0] * (focus_D - slope_middle_D)) / (1 + k * pupil_mm[0] * slope_D);
  return slant_light(at, y + k * pupil_mm[1] * (focus_D - slant_depth_D(at, y)));
}

/* The mean over the pupil and over the pixel of what rays meet. */
static double brute_force(double (*look)(double x, double y, const double pupil_mm[2],
                                         double focus_D),
                          double x, double y, double pupil_mm, double focus_D) {
  enum { ACROSS = 48, WITHIN = 2 };
  double sum = 0, count = 0;
  for (int i = 0; i < ACROSS * ACROSS * WITHIN * WITHIN; i++) {
    int place = i / (WITHIN * WITHIN), within = i % (WITHIN * WITHIN);
    double at[2] = {((place % ACROSS + 0.5) / ACROSS - 0.5) * pupil_mm,
                    ((place / ACROSS + 0.5) / ACROSS - 0.5) * pupil_mm};
    if (hypot(at[0], at[1]) < pupil_mm / 2) {
      sum += look(x + ((within % WITHIN + 0.5) / WITHIN - 0.5) * px_arcmin,
                  y + ((within / WITHIN + 0.5) / WITHIN - 0.5) * px_arcmin, at, focus_D);
      count++;
    }
  }
  return sum / count;
}

/* Some rows across the middle, away from the picture's rim, against rays. */
static double worst_of(const placido_image *seen,
                       double (*look)(double x, double y, const double pupil_mm[2], double focus_D),
                       double pupil_mm, double focus_D) {
  double worst = 0;
  for (int y = seen->height_px / 2 - 6; y < seen->height_px / 2 + 6; y += 5) {
    for (int x = 24; x < seen->width_px - 24; x++) {
      double expected = brute_force(look, middle_of(x, seen->width_px),
                                    middle_of(y, seen->height_px), pupil_mm, focus_D);
      worst = fmax(worst, fabs(expected - seen->data[y * seen->width_px + x]));
    }
  }
  return worst;
}

/* Focused near the far plane shines past the sharp edge, also what is behind it; focused far the
 * near one becomes a veil. Pixels of 0.5' hold stripes of 6' to 0.5 %, twice. */
static void test_near_things_hide_far_ones_as_rays_have_it(void **state) {
  (void)state;
  const double distances_m[] = {1 / 1.2, 1 / 0.2};
  for (int k = 0; k < 2; k++) {
    placido_scene scene = scene_of(140, 70, half_light, half_depth_D, distances_m[k]);
    placido_image seen = see(&scene, 3, 35, 8);
    assert_true(worst_of(&seen, look_past_the_edge, 3, 1 / distances_m[k]) < 0.015);
    placido_image_free(&seen);
    placido_scene_free(&scene);
  }
}

/* Layers mix two discs for one between: with 0.05 D between layers that is all but nothing. */
static void test_a_slanted_plane_has_no_seams(void **state) {
  (void)state;
  const double focus_D = 1.1;
  placido_scene scene = scene_of(200, 70, slant_light, slant_depth_D, 1 / focus_D);
  placido_image seen = see(&scene, 3, 35, 20);
  assert_true(worst_of(&seen, look_at_the_slant, 3, focus_D) < 0.012);
  placido_image_free(&seen);
  placido_scene_free(&scene);
}

static double even_light(double x, double y) {
  (void)x;
  (void)y;
  return 0.7;
}

/* However many layers: what is even stays even, at every edge and slant. */
static void test_an_even_scene_stays_even(void **state) {
  (void)state;
  const texture depths[] = {half_depth_D, slant_depth_D};
  for (int k = 0; k < 2; k++) {
    placido_scene scene = scene_of(140, 70, even_light, depths[k], 1);
    placido_image seen = see(&scene, 3, 35, 12);
    for (int y = 20; y < 50; y++) {
      for (int x = 20; x < 120; x++) {
        assert_near((double)seen.data[y * 140 + x], 0.7, 1e-5);
      }
    }
    placido_image_free(&seen);
    placido_scene_free(&scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_amplitudes_are_hofstetters),
    cmocka_unit_test(test_a_monitor_is_for_the_young),
    cmocka_unit_test(test_far_scenes_have_nothing_to_do),
    cmocka_unit_test(test_a_page_before_a_window_is_for_nobody),
    cmocka_unit_test(test_an_edge_is_blurred_by_the_disc_of_the_pupil),
    cmocka_unit_test(test_near_things_hide_far_ones_as_rays_have_it),
    cmocka_unit_test(test_a_slanted_plane_has_no_seams),
    cmocka_unit_test(test_an_even_scene_stays_even),
  };
  return cmocka_run_group_tests_name("effect_object_distance", tests, NULL, NULL);
}
