/* The pupil that follows the light: the formula's values, and who decides when. */
#include "simulate/effects/effect.h"
#include "simulate/models/pupil_diameter.h"
#include "tests/support/near.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* A field 60 degrees across, both eyes: Watson and Yellott's formula worked out by hand. */
static void diameters_are_the_formulas(void **state) {
  (void)state;
  static const double cd_m2[5] = {0.1, 1, 10, 100, 1000};
  static const double at_30[5] = {6.30, 5.12, 3.83, 2.89, 2.38};
  static const double at_60[5] = {5.12, 4.28, 3.36, 2.70, 2.34};
  const double area_deg2 = pi * 30 * 30, digits = 0.005;
  for (int i = 0; i < 5; i++) {
    assert_near(placido_pupil_diameter_mm(cd_m2[i], area_deg2, true, 30), at_30[i], digits);
    assert_near(placido_pupil_diameter_mm(cd_m2[i], area_deg2, true, 60), at_60[i], digits);
  }
}

/* One eye behind a cover is a tenth of the light; so is a tenth of the area. */
static void a_covered_eye_is_a_tenth_of_the_light(void **state) {
  (void)state;
  double one = placido_pupil_diameter_mm(50, 100, false, 40);
  assert_near(one, placido_pupil_diameter_mm(5, 100, true, 40), 1e-12);
  assert_near(one, placido_pupil_diameter_mm(50, 10, true, 40), 1e-12);
}

/* In darkness 7.75 mm at 28.58 years, the age of reference; beyond the formula's ages its ends. */
static void darkness_and_age_have_limits(void **state) {
  (void)state;
  assert_near(placido_pupil_diameter_mm(0, 100, true, 28.58), 7.75, 1e-12);
  assert_near(placido_pupil_diameter_mm(3, 100, true, 12),
              placido_pupil_diameter_mm(3, 100, true, 20), 0);
  assert_near(placido_pupil_diameter_mm(3, 100, true, 95),
              placido_pupil_diameter_mm(3, 100, true, 83), 0);
}

/* A scene of one row of cells, the second of them half in the picture: 0.2 and 0.8 of white. */
static placido_scene two_cells(placido_facts *facts, double luminance_cd_m2) {
  *facts = (placido_facts){.planes = 1, .columns = 2, .rows = 1, .cell_arcmin = 10,
                           .luminance = {0.2f, 0.8f}};
  return (placido_scene){.name = "two",
                         .image = {.width_px = 15, .height_px = 10, .planes = 1},
                         .arcmin_per_px = 1,
                         .conditions = {.luminance_cd_m2 = luminance_cd_m2}};
}

static int settle(placido_eye *eye, placido_answer *answer, double luminance_cd_m2,
                  enum placido_force force, placido_error *err) {
  placido_facts facts;
  const placido_scene scene = two_cells(&facts, luminance_cd_m2);
  const placido_eye given = *eye;
  const placido_question question = {.scene = &scene, .facts = &facts, .eye = &given};
  *answer = (placido_answer){.bound = 0};
  return placido_effect_pupil.settle(eye, &question, force, answer, err);
}

static void pupil_is_of_the_mean_light(void **state) {
  (void)state;
  placido_eye eye = {.age_years = 50};
  placido_answer answer;
  double mean = (2 * 0.2 + 0.8) / 3;
  assert_int_equal(settle(&eye, &answer, 300, PLACIDO_FORCE_NONE, NULL), PLACIDO_OK);
  assert_near(eye.pupil_mm, placido_pupil_diameter_mm(300 * mean, pi * 900, false, 50), 1e-6);
  assert_true(answer.applies);
  assert_non_null(strstr(answer.reason, "50 years"));
}

static void an_eye_without_age_is_of_35(void **state) {
  (void)state;
  placido_eye unknown = {.age_years = 0}, known = {.age_years = 35}, old = {.age_years = 90};
  placido_answer answer;
  assert_int_equal(settle(&unknown, &answer, 300, PLACIDO_FORCE_ON, NULL), PLACIDO_OK);
  assert_int_equal(settle(&known, &answer, 300, PLACIDO_FORCE_NONE, NULL), PLACIDO_OK);
  assert_near(unknown.pupil_mm, known.pupil_mm, 0);
  assert_int_equal(settle(&old, &answer, 300, PLACIDO_FORCE_NONE, NULL), PLACIDO_OK);
  assert_non_null(strstr(answer.reason, "as at 83"));
}

static void a_given_pupil_stays(void **state) {
  (void)state;
  const enum placido_force forces[] = {PLACIDO_FORCE_NONE, PLACIDO_FORCE_ON, PLACIDO_FORCE_OFF};
  for (int i = 0; i < 3; i++) {
    placido_eye eye = {.pupil_mm = 4};
    placido_answer answer;
    assert_int_equal(settle(&eye, &answer, NAN, forces[i], NULL), PLACIDO_OK);
    assert_near(eye.pupil_mm, 4, 0);
    assert_false(answer.applies);
    assert_non_null(strstr(answer.reason, "the pupil is given: 4 mm"));
  }
}

static void no_pupil_and_no_light_is_refused(void **state) {
  (void)state;
  placido_eye eye = {.pupil_mm = 0};
  placido_answer answer;
  placido_error err;
  assert_int_equal(settle(&eye, &answer, NAN, PLACIDO_FORCE_NONE, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "luminance"));
  assert_int_equal(settle(&eye, &answer, 300, PLACIDO_FORCE_OFF, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "forced off"));
  assert_near(eye.pupil_mm, 0, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(diameters_are_the_formulas),
    cmocka_unit_test(a_covered_eye_is_a_tenth_of_the_light),
    cmocka_unit_test(darkness_and_age_have_limits),
    cmocka_unit_test(pupil_is_of_the_mean_light),
    cmocka_unit_test(an_eye_without_age_is_of_35),
    cmocka_unit_test(a_given_pupil_stays),
    cmocka_unit_test(no_pupil_and_no_light_is_refused),
  };
  return cmocka_run_group_tests_name("effect_pupil", tests, NULL, NULL);
}
