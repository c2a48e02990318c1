/* Plans for eyes as no clinic sees them: whatever the cornea and the pupil, what is seen is light,
 * or the refusal says why. */
#include "tests/simulate/eyes.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"
#include "tests/support/near.h"

#include "base/memory.h"

#include <placido/plan.h>

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { WIDTH = 24, HEIGHT = 16 };

/* An edge between dark and white, and a bright point. */
static placido_scene edge_scene(void) {
  placido_scene scene = {.name = "edge",
                         .arcmin_per_px = 0.5,
                         .conditions = {.luminance_cd_m2 = 100,
                                        .distance_m = INFINITY,
                                        .spectrum = PLACIDO_SPECTRUM_EQUAL_ENERGY,
                                        .wavelength_nm = NAN,
                                        .tolerance = 0.05}};
  assert_int_equal(placido_image_new(&scene.image, WIDTH, HEIGHT, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    scene.image.data[i] = i % WIDTH < WIDTH / 2 ? 0 : 1;
  }
  scene.image.data[5 * WIDTH + 5] = 1;
  return scene;
}

static placido_surface *needle(void) { return cone(0.002, 0.03, 0.3, 0.2); }
static placido_surface *advanced(void) { return cone(0.12, 0.9, 0.3, -0.9); }
static placido_surface *edged(void) { return ridged(PLACIDO_EYE_INDEX, 0.03, 0.3, 30); }
static placido_surface *perfect(void) {
  return conic(7.8, -1 / (PLACIDO_EYE_INDEX * PLACIDO_EYE_INDEX));
}
static placido_surface *steep(void) { return conic(5, 0); }
static placido_surface *low(void) { return conic(12, 0.5); }
static placido_surface *lowest(void) { return conic(40, 0); }
static placido_surface *bent(void) { return toric(6.5, 5.5, -0.2, 179.9999); }

static const struct {
  const char *name;
  placido_surface *(*cornea)(void);
} eyes[] = {{"perfect", perfect},       {"R 5 mm", steep},   {"R 12 mm, Q 0.5", low},
            {"R 40 mm", lowest},        {"9 D toric", bent}, {"a needle", needle},
            {"an advanced cone", advanced}, {"an edge", edged},  {"a plane", flat}};

enum { EYES = sizeof eyes / sizeof *eyes };

/* What a plan promises of its numbers. */
static void check_verdicts(const placido_plan *plan) {
  size_t count;
  const placido_verdict *verdicts = placido_plan_verdicts(plan, &count);
  const placido_plan_settings *settings = placido_plan_settings_of(plan);
  for (size_t i = 0; i < count; i++) {
    assert_true(verdicts[i].bound >= 0 && isfinite(verdicts[i].bound));
    assert_true(verdicts[i].cost_ms >= 0 && isfinite(verdicts[i].cost_ms));
    assert_true(strlen(verdicts[i].reason) > 0);
  }
  assert_true(isfinite(settings->bound) && isfinite(settings->cost_ms));
}

static double sum_of(const placido_psf *psf, double *least) {
  double sum = 0;
  *least = INFINITY;
  for (int i = 0; i < psf->n * psf->n; i++) {
    sum += psf->values[i];
    *least = fmin(*least, psf->values[i]);
  }
  return sum;
}

/* Light lies between dark and the scene's brightest, as a spread sums to at most 1. Beyond that it
 * is rounding alone: five transforms in single precision for a spread by waves and three for the
 * picture, each epsilon log2 of at most 4096 squared samples, of a plane whose root of the sum of
 * squares is below that of all its samples being white. */
static void look(const char *name, const placido_surface *surface, const placido_eye *eye) {
  placido_scene scene = edge_scene();
  placido_plan *plan = NULL;
  placido_image seen = {0};
  placido_psf psf = {0};
  placido_error err = {0};
  int status = placido_plan_new(&plan, surface, eye, &scene, NULL, NULL, &err);
  if (status == PLACIDO_OK) {
    check_verdicts(plan);
    status = placido_plan_run(&seen, &psf, plan, &err);
  }
  if (status != PLACIDO_OK) {
    bool asked = status == PLACIDO_INPUT; /* buckets that the pupil cannot fill */
    case_refused(status, asked ? PLACIDO_INPUT : PLACIDO_QUALITY, &err,
                 asked ? "choose wider ones" : "", "%s, pupil %g mm at %g mm", name,
                 eye->pupil_mm, eye->pupil_x_mm);
  } else {
    double least, beyond = 0, sum = sum_of(&psf, &least);
    size_t count = (size_t)seen.width_px * (size_t)seen.height_px * (size_t)seen.planes;
    assert_int_equal(count_spoilt(seen.data, count), 0);
    assert_true(isfinite(psf.strehl_g) && isfinite(psf.outside));
    for (size_t i = 0; i < count; i++) {
      beyond = fmax(beyond, fmax(-(double)seen.data[i], (double)seen.data[i] - 1));
    }
    beyond = fmax(beyond, fmax(-least, sum - 1));
    case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, fmax(beyond, 0), NULL,
                                   8 * 24 * FLT_EPSILON * sqrt((double)WIDTH * HEIGHT)},
                 "%s, pupil %g mm at %g mm", name, eye->pupil_mm, eye->pupil_x_mm);
  }
  placido_image_free(&seen);
  placido_psf_free(&psf);
  placido_plan_free(plan);
  placido_scene_free(&scene);
}

#ifdef __SANITIZE_ADDRESS__
enum { PUPILS = 1 };
#else
enum { PUPILS = 3 };
#endif

static void any_eye_sees_light(void **state) {
  (void)state;
  const double pupils_mm[] = {4, 0.3, 8};
  for (int i = 0; i < EYES; i++) {
    placido_surface *surface = eyes[i].cornea();
    for (int k = 0; k < PUPILS; k++) {
      const placido_eye eye = {.pupil_mm = pupils_mm[k], .correct = PLACIDO_CORRECT_FULL};
      look(eyes[i].name, surface, &eye);
    }
    placido_surface_free(surface);
  }
}

static void any_pupil_sees_light(void **state) {
  (void)state;
  const struct {
    double pupil_mm, x_mm;
  } pupils[] = {{0.1, 0}, {4, 1.5}, {3, 3}, {9, 0}, {9.1, 0}, {12, 0}};
  placido_surface *surface = conic(7.8, -0.26);
  for (int i = 0; i < 6; i++) {
    const placido_eye eye = {.pupil_mm = pupils[i].pupil_mm,
                             .pupil_x_mm = pupils[i].x_mm,
                             .correct = PLACIDO_CORRECT_FULL};
    look("R 7.8 mm, Q -0.26", surface, &eye);
  }
  placido_surface_free(surface);
}

/* Distances from which nothing comes: what stands there would be blurred by anything. */
static void depths_that_are_none_are_refused(void **state) {
  (void)state;
  const float bad_D[] = {NAN, INFINITY, -INFINITY, -3, 101, 1e30f};
  placido_surface *surface = conic(7.8, -0.26);
  const placido_eye eye = {.pupil_mm = 4};
  for (int i = 0; i < 6; i++) {
    placido_scene scene = edge_scene();
    placido_plan *plan;
    placido_error err = {0};
    scene.depth_D = placido_memory_new((size_t)WIDTH * HEIGHT, sizeof *scene.depth_D, NULL);
    assert_non_null(scene.depth_D);
    scene.depth_D[4 * WIDTH + 9] = bad_D[i];
    int status = placido_plan_new(&plan, surface, &eye, &scene, NULL, NULL, &err);
    case_refused(status, PLACIDO_INPUT, &err, "pixel (9, 4) has a vergence of", "depth of %g D",
                 (double)bad_D[i]);
    assert_null(plan);
    placido_scene_free(&scene);
  }
  placido_surface_free(surface);
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Optics: plans"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(any_eye_sees_light),
                                     cmocka_unit_test(any_pupil_sees_light),
                                     cmocka_unit_test(depths_that_are_none_are_refused),
                                     cmocka_unit_test(the_table_is_good)};
  return cmocka_run_group_tests_name("stability_optics_plans", tests, NULL, NULL);
}
