/* Prescriptions, power vectors, spectacle planes, and eyes of known length. */
#include "tests/support/near.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static const double exact_D = 1e-12; /* rounding */

/* Thibos et al. 1997: -1.00 / -2.00 × 30. */
static void test_power_vector_becomes_a_prescription(void **state) {
  (void)state;
  double sphere_D, cylinder_D, axis_deg;
  placido_correction vector = {-2, cos(acos(-1) / 3), sin(acos(-1) / 3)};
  placido_correction_clinical(&vector, &sphere_D, &cylinder_D, &axis_deg);
  assert_near(sphere_D, -1, exact_D);
  assert_near(cylinder_D, -2, exact_D);
  assert_near(axis_deg, 30, 1e-12);
  vector = (placido_correction){0, 0, -1};
  placido_correction_clinical(&vector, &sphere_D, &cylinder_D, &axis_deg);
  assert_near(axis_deg, 135, 1e-12);
  vector = (placido_correction){1.5, 0, 0};
  placido_correction_clinical(&vector, &sphere_D, &cylinder_D, &axis_deg);
  assert_true(sphere_D == 1.5 && cylinder_D == 0 && isnan(axis_deg));
}

static void test_prescription_becomes_a_power_vector_and_back(void **state) {
  (void)state;
  for (int axis = 0; axis < 180; axis += 15) {
    double sphere_D, cylinder_D, axis_deg;
    placido_correction minus = placido_correction_of(1.25, -2.5, axis);
    placido_correction_clinical(&minus, &sphere_D, &cylinder_D, &axis_deg);
    assert_near(sphere_D, 1.25, exact_D);
    assert_near(cylinder_D, -2.5, exact_D);
    assert_near(axis_deg, axis, 1e-9);
    /* The same lens, written with a plus cylinder. */
    placido_correction plus = placido_correction_of(-1.25, 2.5, axis + 90);
    assert_near(plus.m_D, minus.m_D, exact_D);
    assert_near(plus.j0_D, minus.j0_D, exact_D);
    assert_near(plus.j45_D, minus.j45_D, exact_D);
  }
  placido_correction sphere = placido_correction_of(-3, 0, NAN);
  assert_true(sphere.m_D == -3 && sphere.j0_D == 0 && sphere.j45_D == 0);
}

/* From 179 to 1 degree nothing leaps, and no axis is 180. */
static void test_axis_has_no_edge(void **state) {
  (void)state;
  placido_correction before = placido_correction_of(-1, -2, 179);
  for (double axis = 179.01; axis < 181; axis += 0.01) {
    double sphere_D, cylinder_D, axis_deg;
    placido_correction vector = placido_correction_of(-1, -2, axis);
    double moved = hypot(vector.j0_D - before.j0_D, vector.j45_D - before.j45_D);
    assert_near(moved, 0.01 * acos(-1) / 90, 1e-6); /* J times twice the angle */
    placido_correction_clinical(&vector, &sphere_D, &cylinder_D, &axis_deg);
    assert_true(axis_deg >= 0 && axis_deg < 180);
    assert_near(remainder(axis_deg - axis, 180), 0, 1e-9);
    before = vector;
  }
  double sphere_D, cylinder_D, axis_deg;
  placido_correction edge = {0, 1, -1e-300};
  placido_correction_clinical(&edge, &sphere_D, &cylinder_D, &axis_deg);
  assert_true(axis_deg == 0);
}

/* F / (1 - d F), 12 mm: -10 is -8.93 on the cornea, -5 is -4.72, +5 is +5.32. */
static void test_spectacles_move_to_the_cornea(void **state) {
  (void)state;
  static const double powers_D[][2] = {
    {-10, -10 / 1.12}, {-5, -5 / 1.06}, {5, 5 / 0.94}, {0, 0}};
  for (size_t i = 0; i < sizeof powers_D / sizeof *powers_D; i++) {
    placido_correction lens = {.m_D = powers_D[i][0]}, moved;
    assert_int_equal(placido_correction_move(&moved, &lens, 12, NULL), PLACIDO_OK);
    assert_near(moved.m_D, powers_D[i][1], exact_D);
    assert_true(moved.j0_D == 0 && moved.j45_D == 0);
  }
}

/* Every principal meridian on its own, about an axis that stays. */
static void test_cylinders_move_by_their_meridians(void **state) {
  (void)state;
  double sphere_D, cylinder_D, axis_deg;
  placido_correction lens = placido_correction_of(-6, -4, 25), moved, back;
  assert_int_equal(placido_correction_move(&moved, &lens, 14, NULL), PLACIDO_OK);
  placido_correction_clinical(&moved, &sphere_D, &cylinder_D, &axis_deg);
  assert_near(sphere_D, -6 / (1 + 0.014 * 6), exact_D);
  assert_near(sphere_D + cylinder_D, -10 / (1 + 0.014 * 10), exact_D);
  assert_near(axis_deg, 25, 1e-9);
  assert_int_equal(placido_correction_move(&back, &moved, -14, NULL), PLACIDO_OK);
  assert_near(back.m_D, lens.m_D, exact_D);
  assert_near(back.j0_D, lens.j0_D, exact_D);
  assert_near(back.j45_D, lens.j45_D, exact_D);
}

static void test_lens_whose_focus_is_on_the_way_is_refused(void **state) {
  (void)state;
  placido_error err = {0};
  placido_correction strong = {.m_D = 100}, moved;
  assert_int_equal(placido_correction_move(&moved, &strong, 12, &err), PLACIDO_INPUT);
  assert_string_equal(err.text, "a lens of +100.00 D has no counterpart 12 mm nearer to the eye: "
                                "its focus lies in between");
  assert_true(isnan(moved.m_D));
}

/* Bennett and Rabbetts' eye is emmetropic: the cornea's paraxial focus falls on the retina. A
 * millimetre more makes 2.4 to 2.8 D of myopia. */
static void test_retina_of_an_eye_of_known_length(void **state) {
  (void)state;
  double retina_mm, longer_mm, n = 1.336;
  assert_int_equal(placido_eye_retina_of_length(&retina_mm, 24.086, n, NULL), PLACIDO_OK);
  assert_near(1000 * n / retina_mm, 1000 * (n - 1) / 7.8, 0.002); /* their figures are rounded */
  assert_int_equal(placido_eye_retina_of_length(&longer_mm, 25.086, n, NULL), PLACIDO_OK);
  double myopia_D = 1000 * n / retina_mm - 1000 * n / longer_mm;
  assert_true(myopia_D > 2.4 && myopia_D < 2.8);
  placido_error err = {0};
  assert_int_equal(placido_eye_retina_of_length(&retina_mm, 12, n, &err), PLACIDO_INPUT);
  assert_string_equal(err.text, "the eye's axial length (mm) is 12, expected 18 to 36");
  assert_int_equal(placido_eye_retina_of_length(&retina_mm, 24, NAN, &err), PLACIDO_INPUT);
}

/* The whole way: a perfect cornea, a retina 2 D too far, the lens that was found, and what stands on
 * the prescription for spectacles at 13 mm. */
static void test_short_sight_is_corrected_in_spectacles(void **state) {
  (void)state;
  double n = 1.3375, focus_D = 1000 * (n - 1) / 7.8;
  placido_part part = {.kind = PLACIDO_PART_BICONIC};
  part.as.biconic.r1 = part.as.biconic.r2 = 7.8;
  part.as.biconic.q1 = part.as.biconic.q2 = -1 / (n * n);
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, &part, 1, NULL, NULL), PLACIDO_OK);
  placido_eye eye = {.pupil_mm = 1, .retina_mm = 1000 * n / (focus_D - 2),
                     .correct = PLACIDO_CORRECT_FULL}, found;
  placido_psf psf;
  assert_int_equal(placido_psf_new(&psf, &found, surface, &eye, &(placido_optics){0}, NULL, NULL),
                   PLACIDO_OK);
  placido_correction glasses;
  assert_near(found.correction.m_D, -2, 0.005);
  assert_true(found.retina_mm == eye.retina_mm && found.correct == PLACIDO_CORRECT_NONE);
  assert_int_equal(placido_correction_move(&glasses, &found.correction, -13, NULL), PLACIDO_OK);
  assert_near(glasses.m_D, -2 / (1 - 0.013 * 2), 0.006);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_power_vector_becomes_a_prescription),
    cmocka_unit_test(test_prescription_becomes_a_power_vector_and_back),
    cmocka_unit_test(test_axis_has_no_edge),
    cmocka_unit_test(test_spectacles_move_to_the_cornea),
    cmocka_unit_test(test_cylinders_move_by_their_meridians),
    cmocka_unit_test(test_lens_whose_focus_is_on_the_way_is_refused),
    cmocka_unit_test(test_retina_of_an_eye_of_known_length),
    cmocka_unit_test(test_short_sight_is_corrected_in_spectacles),
  };
  return cmocka_run_group_tests_name("simulate_correction", tests, NULL, NULL);
}
