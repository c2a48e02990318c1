/* A view handed from effect to effect. */
#include "eyes.h"
#include "simulate/plan/run.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

/* What an effect keeps is released whatever happens, and a failure is passed on. */
typedef struct trail {
  int prepared, applied, released;
} trail;

static trail trails[2];
static int failing;

static int keep(void **state, placido_view *view, placido_error *err) {
  int at = view->seen.data == NULL && trails[0].prepared == 0 ? 0 : 1;
  trails[at].prepared++;
  *state = &trails[at];
  return failing == at ? placido_error_set(err, PLACIDO_SYSTEM, "effect %d", at) : PLACIDO_OK;
}

static int walk(void *state, placido_view *view, placido_error *err) {
  trail *mine = state;
  (void)err;
  mine->applied++;
  assert_true((view->seen.data != NULL) == (mine == &trails[1])); /* spread before the last stage */
  return PLACIDO_OK;
}

static void let_go(void *state) {
  trail *mine = state;
  if (mine != NULL) {
    mine->released++;
  }
}

static void effects_act_in_their_order(void **state) {
  (void)state;
  const placido_effect early = {.name = "early", .stage = PLACIDO_STAGE_EYE, .prepare = keep,
                                .apply = walk, .release = let_go};
  const placido_effect late = {.name = "late", .stage = PLACIDO_STAGE_IMAGE, .prepare = keep,
                               .apply = walk, .release = let_go};
  const placido_effect *const both[] = {&early, &late};
  placido_surface *surface = conic(7.8, -0.26);
  const placido_eye eye = {.pupil_mm = 4, .index = PLACIDO_EYE_INDEX, .retina_mm = 30.9};
  const placido_plan_settings settings = {
    .pupil_samples = 32, .nodes = 1, .bucket_arcmin = 1, .buckets = 15};
  placido_scene scene = {.name = "grey", .arcmin_per_px = 1, .bits = 8};
  const placido_run run = {.surface = surface, .scene = &scene, .settings = &settings, .eye = &eye,
                           .effects = both, .count = 2, .threads = 1};
  assert_int_equal(placido_image_new(&scene.image, 9, 7, 1, NULL), PLACIDO_OK);
  for (failing = 2; failing >= 0; failing--) {
    placido_image seen;
    placido_error err = {0};
    memset(trails, 0, sizeof trails);
    int status = placido_view_run(&seen, NULL, &run, &err);
    assert_int_equal(status, failing == 2 ? PLACIDO_OK : PLACIDO_SYSTEM);
    assert_int_equal(trails[0].applied, failing > 0);
    assert_int_equal(trails[1].prepared, failing > 0);
    assert_int_equal(trails[1].applied, failing > 1);
    assert_true(trails[0].released == 1 && trails[1].released == trails[1].prepared);
    placido_image_free(&seen);
  }
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static const placido_effect silent = {.name = "silent", .stage = PLACIDO_STAGE_PSF};

/* An effect has only what it needs. */
static void effects_may_have_nothing_to_do(void **state) {
  (void)state;
  const placido_effect *const effects[] = {&silent};
  placido_surface *surface = conic(7.8, -0.26);
  const placido_eye eye = {.pupil_mm = 4, .index = PLACIDO_EYE_INDEX, .retina_mm = 30.9};
  const placido_plan_settings settings = {
    .pupil_samples = 32, .nodes = 1, .bucket_arcmin = 1, .buckets = 15};
  placido_scene scene = {.name = "grey", .arcmin_per_px = 1, .bits = 8};
  placido_image with, without;
  assert_int_equal(placido_image_new(&scene.image, 9, 7, 1, NULL), PLACIDO_OK);
  scene.image.data[31] = 1;
  placido_run run = {.surface = surface, .scene = &scene, .settings = &settings, .eye = &eye,
                     .effects = effects, .count = 1, .threads = 1};
  assert_int_equal(placido_view_run(&with, NULL, &run, NULL), PLACIDO_OK);
  run.count = 0;
  assert_int_equal(placido_view_run(&without, NULL, &run, NULL), PLACIDO_OK);
  assert_memory_equal(with.data, without.data, 9 * 7 * sizeof *with.data);
  placido_image_free(&with);
  placido_image_free(&without);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(effects_act_in_their_order),
    cmocka_unit_test(effects_may_have_nothing_to_do),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
