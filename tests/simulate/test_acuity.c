/* Predicted acuity against what people read through blur. */
#include "tests/simulate/aberrated.h"

#include <placido/acuity.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

/* logMAR; frees the PSF. */
static double acuity_of(const placido_observer *observer, placido_psf psf) {
  placido_acuity acuity;
  placido_error err = {0};
  int status = placido_acuity_find(&acuity, observer, &psf, NULL, 0, &err);
  placido_psf_free(&psf);
  if (status != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  assert_int_equal(acuity.verdict, PLACIDO_ACUITY_FOUND);
  return acuity.logmar;
}

static placido_observer *observer_of(const char *test) {
  placido_observer *observer;
  placido_error err = {0};
  if (placido_observer_new(&observer, placido_acuity_test_find(test), NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return observer;
}

static void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance)) {
    fail_msg("%g is not within %g of %g", value, tolerance, expected);
  }
}

static const char *const names[] = {"e", "c", "sloan"};

/* The calibration: an eye of 3 to 4 mm with mean aberrations reads E and letters of -0.1, a stroke
 * of 0.8'. A Landolt C is harder for people, too, by less than a line. */
static void test_normal_eye_reads_minus_a_tenth(void **state) {
  (void)state;
  const double expected[] = {-0.1, -0.05, -0.1};
  for (int k = 0; k < 3; k++) {
    placido_observer *observer = observer_of(names[k]);
    for (double pupil = 3; pupil <= 4; pupil += 0.5) {
      assert_near(acuity_of(observer, normal_eye(pupil, 0, 0)), expected[k], 0.06);
    }
    placido_observer_free(observer);
  }
}

/* MAR = MAR0 (1 + b²), Blendowske 2015, which holds to 0.15 logMAR: people scatter by as much. */
static void test_defocus_costs_what_people_lose(void **state) {
  (void)state;
  const double blurs[] = {0.5, 1, 1.5, 2, 3};
  for (int k = 0; k < 3; k++) {
    placido_observer *observer = observer_of(names[k]);
    for (double pupil = 3.5; pupil <= 4; pupil += 0.5) {
      double sharp = acuity_of(observer, normal_eye(pupil, 0, 0));
      for (int i = 0; i < 5; i++) {
        double lost = acuity_of(observer, normal_eye(pupil, blurs[i], 0)) - sharp;
        assert_near(lost, log10(1 + blurs[i] * blurs[i]), 0.15);
      }
    }
    placido_observer_free(observer);
  }
}

/* Small pupils blur less, which Blendowske's rule does not know; Smith's (1991) for large blur
 * does: MAR = 0.65 pupil defocus. */
static void test_large_blur_follows_the_pupil(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    placido_observer *observer = observer_of(names[k]);
    for (double pupil = 3; pupil <= 4; pupil += 0.5) {
      for (double blur = 2; blur <= 3; blur += 1) {
        double logmar = acuity_of(observer, normal_eye(pupil, blur, 0));
        assert_near(logmar, log10(0.65 * pupil * blur), 0.15);
      }
    }
    placido_observer_free(observer);
  }
}

static void test_more_defocus_is_never_better(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    placido_observer *observer = observer_of(names[k]);
    double last = -1;
    for (double blur = 0; blur <= 3; blur += 0.25) {
      double at = acuity_of(observer, normal_eye(4, blur, 0));
      assert_true(at > last);
      last = at;
    }
    placido_observer_free(observer);
  }
}

/* Astigmatism without mean sphere counts as its power vector's length does; letters that have their
 * detail along the sharper lines make up for some: to 0.2 logMAR. */
static void test_astigmatism_counts_as_defocus_of_its_length(void **state) {
  (void)state;
  placido_observer *observer = observer_of("sloan");
  double sharp = acuity_of(observer, normal_eye(4, 0, 0));
  for (double blur = 0.5; blur <= 2; blur *= 2) {
    double lost = acuity_of(observer, normal_eye(4, 0, blur)) - sharp;
    assert_near(lost, log10(1 + blur * blur), 0.2);
  }
  placido_observer_free(observer);
}

/* Diffraction alone: the aberrations of a normal eye cost it something, and a pupil of 1 mm, whose
 * cut-off of 31 cycles a degree is near that of a stroke of 1', costs a line or two. */
static void test_diffraction_alone(void **state) {
  (void)state;
  placido_observer *observer = observer_of("sloan");
  double perfect = acuity_of(observer, aberrated(4, NULL, 0, 0, 0));
  double pinhole = acuity_of(observer, aberrated(1, NULL, 0, 0, 0));
  assert_true(perfect < acuity_of(observer, normal_eye(4, 0, 0)) - 0.05);
  assert_true(perfect > -0.3); /* 20/10, which the best eyes read */
  assert_true(pinhole > perfect + 0.1);
  assert_true(pinhole < 0.3);
  placido_observer_free(observer);
}

/* Rays with the pupil's diffraction put in come to what wave optics gives, where blur is large. */
static void test_rays_and_waves_agree(void **state) {
  (void)state;
  placido_observer *observer = observer_of("e");
  for (double blur = 0; blur <= 2; blur += 1) {
    placido_psf rays = blur_disc(fmax(3.4377 * 4 * blur / 2, 0.05)); /* arcmin per mm and D, half */
    rays.wavelength_nm = 0;
    rays.pupil_mm = 4;
    assert_near(acuity_of(observer, rays),
                acuity_of(observer, aberrated(4, NULL, 0, blur, 0)), 0.03);
  }
  placido_observer_free(observer);
}

/* A second image far away takes half of the contrast, however far it is: the letter stands alone.
 * The observer sees it twice, at half the contrast each: the noise weighs as sqrt(2), less than a
 * line. */
static void test_far_ghost_costs_contrast_only(void **state) {
  (void)state;
  placido_observer *observer = observer_of("e");
  placido_psf alone = dark(257, 0.5), far = dark(257, 0.5), farther = dark(257, 0.5);
  put_spot(&alone, 0, 0, 1);
  put_spot(&far, -10, 0, 0.5);
  put_spot(&far, 10, 0, 0.5);
  put_spot(&farther, -25, 0, 0.5);
  put_spot(&farther, 25, 0, 0.5);
  double sharp = acuity_of(observer, alone), at_20 = acuity_of(observer, far);
  assert_true(at_20 > sharp + 0.005 && at_20 < sharp + 0.1);
  assert_near(acuity_of(observer, farther), at_20, 0.005);
  placido_observer_free(observer);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_normal_eye_reads_minus_a_tenth),
    cmocka_unit_test(test_defocus_costs_what_people_lose),
    cmocka_unit_test(test_large_blur_follows_the_pupil),
    cmocka_unit_test(test_more_defocus_is_never_better),
    cmocka_unit_test(test_astigmatism_counts_as_defocus_of_its_length),
    cmocka_unit_test(test_diffraction_alone),
    cmocka_unit_test(test_rays_and_waves_agree),
    cmocka_unit_test(test_far_ghost_costs_contrast_only),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
