#include "chromatic.h"

#include "eyes.h"
#include "simulate/eye.h"
#include "simulate/plan/run.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

enum { ACROSS_PUPIL = 160 };

static const double cornea_mm = 7.8;

placido_scene dark_scene(int width_px, int height_px, int planes, enum placido_spectrum spectrum) {
  placido_scene scene = {.name = "test", .arcmin_per_px = sample_arcmin, .bits = 8};
  scene.conditions = (placido_conditions){.luminance_cd_m2 = NAN,
                                          .distance_m = INFINITY,
                                          .spectrum = spectrum,
                                          .wavelength_nm = NAN,
                                          .tolerance = 0.01};
  assert_int_equal(placido_image_new(&scene.image, width_px, height_px, planes, NULL), PLACIDO_OK);
  return scene;
}

/* Its retina is where a cornea without spherical aberration has its focus. */
static placido_eye perfect_eye(const placido_eye *eye) {
  const double index = PLACIDO_EYE_INDEX;
  placido_eye settled = *eye;
  settled.index = index;
  settled.retina_mm = index * cornea_mm / (index - 1);
  return settled;
}

placido_image seen_with(const placido_scene *scene, const placido_eye *eye,
                        const placido_effect *const *effects, size_t count, int wavelengths,
                        int nodes, int buckets) {
  placido_surface *cornea = conic(cornea_mm, -1 / (PLACIDO_EYE_INDEX * PLACIDO_EYE_INDEX));
  const placido_eye perfect = perfect_eye(eye);
  const placido_plan_settings settings = {.pupil_samples = ACROSS_PUPIL,
                                          .wavelengths = wavelengths,
                                          .layers = 1,
                                          .nodes = nodes,
                                          .bucket_arcmin = sample_arcmin,
                                          .buckets = buckets,
                                          .doubles = true};
  placido_facts facts;
  placido_image seen;
  placido_error error = {0};
  assert_int_equal(placido_facts_find(&facts, scene, NULL), PLACIDO_OK);
  const placido_run run = {.surface = cornea,
                           .scene = scene,
                           .facts = &facts,
                           .settings = &settings,
                           .eye = &perfect,
                           .effects = effects,
                           .count = count,
                           .threads = 1};
  if (placido_view_run(&seen, NULL, &run, &error) != PLACIDO_OK) {
    fail_msg("%s", error.text);
  }
  placido_surface_free(cornea);
  return seen;
}

placido_answer asked(const placido_effect *effect, const placido_scene *scene,
                     const placido_eye *eye, placido_strokes *strokes) {
  const placido_eye perfect = perfect_eye(eye);
  placido_facts facts;
  memset(strokes, 0, sizeof *strokes);
  placido_answer answer = {.strokes = strokes};
  assert_int_equal(placido_facts_find(&facts, scene, NULL), PLACIDO_OK);
  const placido_question question = {.scene = scene,
                                     .facts = &facts,
                                     .eye = &perfect,
                                     .bucket_arcmin = sample_arcmin,
                                     .tolerance = scene->conditions.tolerance};
  effect->ask(&question, &answer);
  assert_true(strlen(answer.reason) > 0 && strlen(answer.reason) + 1 < sizeof answer.reason);
  return answer;
}

double thibos_D(double wavelength_nm) {
  return 633.46 / (wavelength_nm - 214.102) - 633.46 / (555 - 214.102);
}

double tabled_efficiency(double wavelength_nm) {
  enum { FIRST_NM = 380, STEP_NM = 10, COUNT = 41 };
  static const double table[COUNT] = {
    0.0000, 0.0001, 0.0004, 0.0012, 0.0040, 0.0116, 0.0230, 0.0380, 0.0600, 0.0910, 0.1390,
    0.2080, 0.3230, 0.5030, 0.7100, 0.8620, 0.9540, 0.9950, 0.9950, 0.9520, 0.8700, 0.7570,
    0.6310, 0.5030, 0.3810, 0.2650, 0.1750, 0.1070, 0.0610, 0.0320, 0.0170, 0.0082, 0.0041,
    0.0021, 0.0010, 0.0005, 0.0002, 0.0001, 0.0001, 0.0000, 0.0000};
  double place = fmin(fmax((wavelength_nm - FIRST_NM) / STEP_NM, 0), COUNT - 1);
  int below = (int)fmin(floor(place), COUNT - 2);
  return table[below] + (place - below) * (table[below + 1] - table[below]);
}
