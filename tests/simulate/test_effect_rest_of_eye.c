/* The rest of the eye against brute force: the light of every pixel traced through Navarro's
 * surfaces by skew rays (skew.c); and what it answers against the search that it stands for. */
#include "bins.h"
#include "eyes.h"
#include "simulate/effects/effect.h"
#include "simulate/ocular/navarro.h"
#include "simulate/plan/run.h"
#include "simulate/wavefront.h"
#include "skew.h"
#include "tests/support/near.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

enum { SIDE = 60, SQUARE = 8, ACROSS = 90, BIN = 2, BINS = SIDE / BIN };

static const double axis_deg[2] = {0, 0};
static const double arcmin_per_px = 0.5;
static const double arcmin_rad = 3.14159265358979323846 / 10800;
static const double radius_mm = 7.72, q = -0.2;

/* A bright square on black, at a distance. */
static placido_scene square_at(double distance_m) {
  placido_scene scene = {.name = "square", .arcmin_per_px = arcmin_per_px, .bits = 8};
  scene.conditions.luminance_cd_m2 = NAN;
  scene.conditions.distance_m = distance_m;
  assert_int_equal(placido_image_new(&scene.image, SIDE, SIDE, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < SIDE * SIDE; i++) {
    int x = i % SIDE - (SIDE - SQUARE) / 2, y = i / SIDE - (SIDE - SQUARE) / 2;
    scene.image.data[i] = x >= 0 && x < SQUARE && y >= 0 && y < SQUARE;
  }
  return scene;
}

static placido_facts facts_of(const placido_scene *scene) {
  placido_facts facts;
  assert_int_equal(placido_facts_find(&facts, scene, NULL), PLACIDO_OK);
  return facts;
}

/* The square through an eye: rays from a point as near as the eye accommodates, or far away, over
 * the pupil; each is seen where the chief ray of another direction would land. */
static void see_by_skew_rays(double binned[BINS * BINS], const skew_eye *eye,
                             const placido_eye *settled, double focus_D, const double offset[2]) {
  static double seen[SIDE * SIDE];
  const double step = 1e-4, cell = settled->pupil_mm / ACROSS;
  const double middle[2] = {settled->pupil_x_mm, settled->pupil_y_mm};
  /* angles are those at the cornea, from which distances are measured, not at the pupil */
  const double axis[2] = {0, 0}, aside[2] = {step / (1 + 3.05e-3 * focus_D), 0};
  double chief[3], other[3], t[3], path;
  assert_true(skew_land(eye, axis, middle, chief, t, &path));
  assert_true(skew_land(eye, aside, middle, other, t, &path));
  double scale_mm = hypot(other[0] - chief[0], other[1] - chief[1]) / step;
  double far_mm = focus_D > 0 ? 1000 / focus_D + 3.05 : INFINITY;
  memset(seen, 0, sizeof seen);
  for (int i = 0; i < ACROSS * ACROSS; i++) {
    double x = (i % ACROSS + 0.5) * cell - settled->pupil_mm / 2;
    double y = (i / ACROSS + 0.5) * cell - settled->pupil_mm / 2;
    const double entry[2] = {middle[0] + x, middle[1] + y};
    const double tangent[2] = {-x / far_mm, -y / far_mm};
    double landing[3];
    if (hypot(x, y) > settled->pupil_mm / 2 ||
        !skew_land(eye, tangent, entry, landing, t, &path)) {
      continue;
    }
    double right = (landing[0] - chief[0]) / scale_mm / arcmin_rad - offset[0];
    double down = (landing[1] - chief[1]) / scale_mm / arcmin_rad - offset[1];
    for (int k = 0; k < SQUARE * SQUARE; k++) { /* a pixel's light comes from its middle */
      double column = (SIDE - SQUARE) / 2 + k % SQUARE + 0.5 + right / arcmin_per_px;
      double row = (SIDE - SQUARE) / 2 + k / SQUARE + 0.5 + down / arcmin_per_px;
      if (column >= 0 && row >= 0 && column < SIDE && row < SIDE) {
        seen[(int)row * SIDE + (int)column] += 1;
      }
    }
  }
  bin_up(binned, seen, SIDE, BIN);
  double all = 0;
  for (int i = 0; i < BINS * BINS; i++) {
    all += binned[i];
  }
  for (int i = 0; i < BINS * BINS; i++) {
    binned[i] /= all / (SQUARE * SQUARE);
  }
}

/* As the program has it, with the effect or without. */
static void see_by_view(double binned[BINS * BINS], const placido_surface *surface,
                        const placido_scene *scene, const placido_eye *eye, bool with) {
  static const placido_effect *const effects[] = {&placido_effect_rest_of_eye};
  static double seen[SIDE * SIDE];
  const placido_plan_settings settings = {.pupil_samples = 200, .wavelengths = 1, .layers = 1,
                                          .nodes = 1, .bucket_arcmin = arcmin_per_px,
                                          .buckets = 65};
  const placido_facts facts = facts_of(scene);
  placido_image image;
  placido_error err = {0};
  const placido_run run = {.surface = surface, .scene = scene, .facts = &facts,
                           .settings = &settings, .eye = eye, .open = PLACIDO_CORRECT_SPHERE,
                           .effects = effects, .count = with, .threads = 1};
  if (placido_view_run(&image, NULL, &run, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  for (int i = 0; i < SIDE * SIDE; i++) {
    seen[i] = (double)image.data[i];
  }
  bin_up(binned, seen, SIDE, BIN);
  placido_image_free(&image);
}

static void test_brute_force(void **state) {
  (void)state;
  static double truth[BINS * BINS], seen[BINS * BINS], alone[BINS * BINS];
  placido_surface *surface = conic(radius_mm, q);
  placido_eye eye = settled_eye(surface, (placido_eye){.pupil_mm = 5, .pupil_x_mm = 0.4,
                                                  .pupil_y_mm = -0.3});
  eye.age_years = 30;
  for (int i = 0; i < 2; i++) {
    double focus_D = 5 * i; /* a lens that accommodates so much has hardly any aberration left */
    placido_scene scene = square_at(i == 0 ? INFINITY : 1 / focus_D);
    placido_ocular whole = {.whole = true, .accommodation_D = focus_D};
    placido_eye found;
    double offset[2];
    assert_int_equal(placido_ocular_focus(&found, &whole, surface, &eye, PLACIDO_CORRECT_SPHERE,
                                          NULL), PLACIDO_OK);
    assert_int_equal(placido_ocular_fixation(offset, surface, &found, &whole, NULL), PLACIDO_OK);
    placido_navarro media = placido_navarro_at(focus_D, 555);
    const double index[4] = {media.surfaces[0].before, media.surfaces[0].behind,
                             media.surfaces[1].behind, media.surfaces[2].behind};
    skew_eye other = skew_navarro(radius_mm, q, focus_D, index, found.retina_mm);
    see_by_view(seen, surface, &scene, &eye, true);
    see_by_view(alone, surface, &scene, &eye, false);
    see_by_skew_rays(truth, &other, &found, focus_D, offset);
    assert_true(misplaced(seen, truth, BINS * BINS) < 0.01); /* 6,000 rays in bins of a minute */
    assert_true(misplaced(alone, truth, BINS * BINS) > 0.1);
    placido_image_free(&scene.image);
  }
  placido_surface_free(surface);
}

/* Rays as the planner's sketch has them. */
static void sketch(placido_sketch_rays *rays, const placido_surface *surface,
                   const placido_eye *eye) {
  double x[PLACIDO_SKETCH_RAYS], y[PLACIDO_SKETCH_RAYS], weight[PLACIDO_SKETCH_RAYS], offset[2];
  const placido_ocular alone = {0};
  placido_disc_quadrature(x, y, weight, PLACIDO_SKETCH_RINGS);
  rays->count = PLACIDO_SKETCH_RAYS;
  for (int i = 0; i < rays->count; i++) {
    rays->x_mm[i] = (float)(eye->pupil_mm / 2 * x[i]);
    rays->y_mm[i] = (float)(eye->pupil_mm / 2 * y[i]);
    rays->weight[i] = (float)weight[i];
  }
  assert_int_equal(placido_ocular_fixation(offset, surface, eye, &alone, NULL), PLACIDO_OK);
  placido_ocular_angles(rays->angle_x, rays->angle_y, rays->x_mm, rays->y_mm, rays->count, surface,
                        eye, &alone, axis_deg, offset);
}

/* Root mean square of what the whole eye's search turns the rays by, and of how much of that the
 * strokes miss. */
static void compare(double *turned, double *missed, const placido_surface *surface,
                    const placido_eye *eye, enum placido_correct open,
                    const placido_sketch_rays *rays, const placido_strokes *strokes) {
  placido_ocular whole = {.whole = true};
  float x[PLACIDO_SKETCH_RAYS], y[PLACIDO_SKETCH_RAYS];
  placido_eye found;
  double offset[2];
  assert_int_equal(placido_ocular_focus(&found, &whole, surface, eye, open, NULL), PLACIDO_OK);
  assert_int_equal(placido_ocular_fixation(offset, surface, &found, &whole, NULL), PLACIDO_OK);
  placido_ocular_angles(x, y, rays->x_mm, rays->y_mm, rays->count, surface, &found, &whole,
                        axis_deg, offset);
  *turned = *missed = 0;
  for (int i = 0; i < rays->count; i++) {
    double u = (double)(x[i] - rays->angle_x[i]), v = (double)(y[i] - rays->angle_y[i]);
    *turned += (double)rays->weight[i] * (u * u + v * v);
    u -= (double)strokes->angle_x[i];
    v -= (double)strokes->angle_y[i];
    *missed += (double)rays->weight[i] * (u * u + v * v);
  }
  *turned = sqrt(*turned);
  *missed = sqrt(*missed);
}

static double spread_of(const placido_sketch_rays *rays) {
  double sum = 0;
  for (int i = 0; i < rays->count; i++) {
    double x = (double)rays->angle_x[i], y = (double)rays->angle_y[i];
    sum += (double)rays->weight[i] * (x * x + y * y);
  }
  return sqrt(sum);
}

static void test_answer(void **state) {
  (void)state;
  placido_surface *surfaces[] = {conic(7.72, -0.26), toric(7.8, 7.5, -0.2, 20), conic(7.4, 0),
                                 cone(0.02, 1.1, 0, -1), keratoconus(0)};
  const enum placido_correct opens[] = {PLACIDO_CORRECT_FULL, PLACIDO_CORRECT_SPHERE,
                                        PLACIDO_CORRECT_NONE};
  for (int i = 0; i < 5 * 3 * 3; i++) {
    const placido_surface *surface = surfaces[i / 9];
    enum placido_correct open = opens[i % 3];
    placido_eye eye = settled_eye(surface, (placido_eye){.pupil_mm = 2 + 2 * (i / 3 % 3),
                                                    .correct = open});
    const placido_scene scene = {.conditions = {.distance_m = INFINITY}};
    const placido_facts facts = {.planes = 1};
    placido_sketch_rays rays;
    placido_strokes strokes = {0};
    placido_answer answer = {.strokes = &strokes};
    sketch(&rays, surface, &eye);
    const placido_question question = {.surface = surface, .scene = &scene, .facts = &facts,
                                       .eye = &eye, .open = open, .rays = &rays,
                                       .bucket_arcmin = 0.5, .tolerance = 0.01};
    placido_effect_rest_of_eye.ask(&question, &answer);
    assert_true(answer.applies && strokes.turns && answer.cost_ms > 0);
    assert_non_null(strstr(answer.reason, "mm pupil"));
    double turned, missed;
    compare(&turned, &missed, surface, &eye, open, &rays, &strokes);
    /* a few steps with a hundred rays stand for a search with thousands; where 20' of astigmatism
     * are left, the best place on its lines is anywhere */
    assert_true(missed < 0.65 * turned + 0.03 * spread_of(&rays) + 0.001);
  }
  for (int i = 0; i < 5; i++) {
    placido_surface_free(surfaces[i]);
  }
}

/* The lens accommodates as far as its age lets it, and no farther than the model goes. */
static void test_accommodation(void **state) {
  (void)state;
  placido_surface *surface = conic(radius_mm, q);
  placido_eye eye = settled_eye(surface, (placido_eye){.pupil_mm = 3});
  const struct { double age_years, focus_D, expected_D; } cases[] = {
    {35, 0, 0}, {35, 3, 3}, {35, 9, 8}, {65, 3, 0}, {50, 3, 3}, {50, 4, 3.5}, {10, 14, 10},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    placido_facts facts = {.planes = 1, .focus_D = cases[i].focus_D};
    placido_view view = {.surface = surface, .facts = &facts, .eye = eye,
                         .open = PLACIDO_CORRECT_SPHERE};
    view.eye.age_years = cases[i].age_years;
    assert_int_equal(placido_effect_rest_of_eye.apply(NULL, &view, NULL), PLACIDO_OK);
    assert_true(view.ocular.whole && !view.ocular.curved);
    assert_near(view.ocular.accommodation_D, cases[i].expected_D, 1e-12);
    /* the retina of a whole eye, where this lens focuses light from so near */
    assert_near(view.eye.retina_mm, 23.9, 0.5);
  }
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_brute_force),
    cmocka_unit_test(test_answer),
    cmocka_unit_test(test_accommodation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
