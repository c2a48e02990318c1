/* The ideal observer's arithmetic, against formulas and brute force, and its manners. */
#include "tests/simulate/aberrated.h"
#include "tests/simulate/eyes.h"

#include "base/memory.h"
#include "simulate/acuity/neural.h"
#include "simulate/acuity/observer.h"

#include <placido/simulate.h>
#include <placido/acuity.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <setjmp.h>
#include <cmocka.h>

static void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance)) {
    fail_msg("%g is not within %g of %g", value, tolerance, expected);
  }
}

static placido_observer *observer_of(const char *test, const placido_acuity_options *options) {
  placido_observer *observer;
  placido_error err = {0};
  if (placido_observer_new(&observer, placido_acuity_test_find(test), options, &err) !=
      PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return observer;
}

static placido_acuity find(const placido_observer *observer, const placido_psf *psf) {
  placido_acuity acuity;
  placido_error err = {0};
  if (placido_acuity_find(&acuity, observer, psf, NULL, 0, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return acuity;
}

/* Formulas' values, worked out apart from the code. Sensitivity at 0 is 373.08 (1 - 0.8493); Watson
 * 2013's mean eye passes 0.56 of 10 and 0.28 of 20 cycles a degree at 3 mm, 0.05 of 30 at 6 mm. */
static void test_filters_have_their_published_values(void **state) {
  (void)state;
  assert_near(placido_contrast_sensitivity(0), 56.22, 0.01);
  assert_near(placido_contrast_sensitivity(4.1726), 241.78 - 29.58, 0.05);
  assert_near(placido_mean_mtf(10, 3), 0.56, 0.006);
  assert_near(placido_mean_mtf(20, 3), 0.28, 0.006);
  assert_near(placido_mean_mtf(30, 6), 0.05, 0.006);
  assert_near(placido_diffraction_mtf(31.449, 2), 0.391, 0.001); /* half the cut-off of 62.9 */
  assert_true(placido_diffraction_mtf(63, 2) == 0);
}

/* Letters that have nothing in common and the same energy: m-alternative forced choice, the
 * integral of phi(x - d) Phi(x)^(m - 1) (Green and Swets 1966). Three standard errors of 4096
 * trials. */
static void test_score_is_that_of_forced_choice(void **state) {
  (void)state;
  const placido_acuity_options plain = {.noise = 1, .proportional_noise = -1};
  for (int k = 0; k < 2; k++) {
    placido_observer *observer = observer_of(k == 0 ? "e" : "sloan", &plain);
    int m = observer->choices;
    for (double d = 0.5; d < 4; d += 0.5) {
      placido_gram gram = {0};
      double sigma, expected = 0, step = 0.01;
      for (int i = 0; i < m; i++) {
        gram.values[i][i] = d * d;
      }
      for (double x = -8; x < 12; x += step) {
        expected += step * exp(-0.5 * (x - d) * (x - d)) / sqrt(2 * M_PI) *
                    pow(0.5 * erfc(-x / sqrt(2)), m - 1);
      }
      double score = placido_observer_score(observer, &gram, 1, &sigma);
      assert_near(score, expected, 3 * sigma);
      assert_true(sigma < 0.5 / sqrt(4096));
    }
    placido_observer_free(observer);
  }
}

/* Spectrum of a tumbling E, arms to the right, or turned by quarter turns to the left, of stroke 1,
 * about its middle: rectangles' sines. x to the right, y up; the real and the imaginary part. */
static void e_spectrum(double *re, double *im, double fx, double fy, int quarters) {
  static const double boxes[4][4] = {
    {-2, 0, 1, 5}, {0.5, 2, 4, 1}, {0.5, 0, 4, 1}, {0.5, -2, 4, 1}}; /* middle, size */
  *re = *im = 0;
  for (int q = 0; q < quarters; q++) { /* the letter turns left: the frequency turns right */
    double swapped = fx;
    fx = fy;
    fy = -swapped;
  }
  for (int i = 0; i < 4; i++) {
    const double *b = boxes[i];
    double a = M_PI * fx * b[2], c = M_PI * fy * b[3];
    double size = b[2] * b[3] * (a == 0 ? 1 : sin(a) / a) * (c == 0 ? 1 : sin(c) / c);
    *re += size * cos(2 * M_PI * (fx * b[0] + fy * b[1]));
    *im -= size * sin(2 * M_PI * (fx * b[0] + fy * b[1]));
  }
}

/* Inner products of E's seen through a Gaussian PSF, by Parseval: the integral over frequency of
 * the letters' exact spectra times the squares of the filters. Strokes on both sides of where the
 * code changes its way. The neural filter's cusp at 0 is finer than the transform of 130'
 * resolves, which makes half a percent. */
static void test_letters_compare_as_their_exact_spectra_do(void **state) {
  (void)state;
  const double sigma_arcmin = 1.5, bucket = 0.5, step_cpd = 0.25;
  placido_observer *observer = observer_of("e", NULL);
  placido_psf psf = dark(129, bucket);
  placido_lags lags;
  placido_gram gram;
  placido_sight *sight = placido_memory_new(1, sizeof *sight, NULL);
  for (int i = 0; i < 129 * 129; i++) {
    double x = (i % 129 - 64) * bucket, y = (i / 129 - 64) * bucket, s = sigma_arcmin * sqrt(2);
    psf.values[i] = 0.25 * (erf((x + bucket / 2) / s) - erf((x - bucket / 2) / s)) *
                    (erf((y + bucket / 2) / s) - erf((y - bucket / 2) / s));
  }
  assert_int_equal(placido_lags_new(&lags, &psf, NULL), PLACIDO_OK);
  const double strokes[] = {0.7, 1.5, 4, 5.9, 6.1};
  for (int k = 0; k < 5; k++) {
    double stroke = strokes[k] / 60, sums[4] = {0}; /* right with right, up, left, down */
    for (double fy = -30; fy <= 30; fy += step_cpd) {
      for (double fx = -30; fx <= 30; fx += step_cpd) {
        double f = hypot(fx, fy), s = sigma_arcmin / 60, re, im;
        double gain = exp(-2 * M_PI * M_PI * s * s * f * f) * placido_neural_filter(f);
        e_spectrum(&re, &im, fx * stroke, fy * stroke, 0);
        for (int j = 0; j < 4; j++) {
          double other_re, other_im;
          e_spectrum(&other_re, &other_im, fx * stroke, fy * stroke, j);
          sums[j] += gain * gain * (re * other_re + im * other_im) * pow(stroke, 4) * step_cpd *
                     step_cpd;
        }
      }
    }
    placido_observer_look(&gram, observer, &lags, strokes[k], sight);
    for (int j = 0; j < 4; j++) {
      assert_near(gram.values[0][j], sums[j], 0.005 * sums[0]);
    }
    /* What tells the letters apart is a small part of what they are. */
    assert_near(gram.values[0][0] - gram.values[0][2], sums[0] - sums[2],
                0.01 * (sums[0] - sums[2]) + 1e-5 * sums[0]);
  }
  placido_lags_free(&lags);
  placido_memory_free(sight);
  placido_psf_free(&psf);
  placido_observer_free(observer);
}

static void test_score_rises_from_chance_to_certainty(void **state) {
  (void)state;
  size_t count;
  const placido_acuity_test *tests = placido_acuity_tests(&count);
  placido_psf psf = normal_eye(4, 1, 0);
  for (size_t k = 0; k < count; k++) {
    placido_observer *observer = observer_of(tests[k].name, NULL);
    double last = 0, score = 0;
    for (double logmar = -1; logmar <= 1.31; logmar += 0.1) {
      assert_int_equal(placido_acuity_score(&score, observer, &psf, logmar, NULL), PLACIDO_OK);
      if (logmar < -0.9) {
        assert_near(score, 1.0 / tests[k].choices, 0.02); /* trials; little is seen */
      }
      assert_true(score >= last - 0.01);
      last = score;
    }
    assert_true(score > 0.98);
    placido_observer_free(observer);
  }
  placido_psf_free(&psf);
}

/* An astigmatic picture turned by a quarter: its E's and C's turn into each other. */
static void test_turning_the_eye_changes_nothing(void **state) {
  (void)state;
  placido_psf one = normal_eye(4, 0, 1), other = normal_eye(4, 0, 1);
  for (int i = 0; i < one.n * one.n; i++) {
    int x = i % one.n, y = i / one.n;
    other.values[x * one.n + (one.n - 1 - y)] = one.values[i];
  }
  const char *const names[] = {"e", "c", "c8"};
  for (int k = 0; k < 3; k++) {
    placido_observer *observer = observer_of(names[k], NULL);
    placido_acuity a = find(observer, &one), b = find(observer, &other);
    assert_near(a.logmar, b.logmar, 4 * a.sigma_trials);
    placido_observer_free(observer);
  }
  placido_psf_free(&one);
  placido_psf_free(&other);
}

/* Half the bucket, the same acuity: what buckets average is taken back. */
static void test_bucket_does_not_matter(void **state) {
  (void)state;
  placido_observer *observer = observer_of("sloan", NULL);
  const double r2 = 4, terms[15] = {[4] = 1 * r2 / (4 * 1.7320508), [8] = 0.07, [12] = 0.05};
  double found[3];
  for (int k = 0; k < 3; k++) {
    const double bucket = 0.25 * (1 << k);
    placido_psf psf = dark((int)(128 / bucket) + 1, bucket);
    placido_pupil pupil;
    const placido_wave wave = {.wavelength_nm = 555, .weight = 1};
    const placido_window window = {.buckets = psf.n, .bucket_arcmin = bucket};
    assert_int_equal(placido_pupil_of_terms(&pupil, 4, terms, 15, 0, NULL), PLACIDO_OK);
    assert_int_equal(placido_diffraction(psf.values, NULL, &pupil, &wave, 1, &window, NULL),
                     PLACIDO_OK);
    found[k] = find(observer, &psf).logmar;
    placido_pupil_free(&pupil);
    placido_psf_free(&psf);
  }
  assert_near(found[0], found[1], 0.005);
  assert_near(found[2], found[1], 0.01);
  placido_observer_free(observer);
}

/* Other draws move the size by what sigma_trials says: twelve of them have its spread to 2 in 5
 * (one in sqrt(2 · 11) is expected, thrice that is allowed). */
static void test_trials_leave_the_error_they_say(void **state) {
  (void)state;
  const int runs = 12;
  double mean = 0, squares = 0, told = 0;
  placido_psf psf = normal_eye(4, 0, 0);
  for (int k = 0; k < runs; k++) {
    const placido_acuity_options options = {.seed = 100 + (uint64_t)k, .trials = 1000};
    placido_observer *observer = observer_of("sloan", &options);
    placido_acuity acuity = find(observer, &psf);
    mean += acuity.logmar / runs;
    squares += acuity.logmar * acuity.logmar / runs;
    told += acuity.sigma_trials / runs;
    placido_observer_free(observer);
  }
  double spread = sqrt((squares - mean * mean) * runs / (runs - 1));
  assert_near(spread, told, 0.64 * told);
  placido_psf_free(&psf);
}

static void test_beyond_chart_and_window(void **state) {
  (void)state;
  const placido_acuity_options small = {.smallest_logmar = -0.3, .largest_logmar = 0.4};
  placido_observer *chart = observer_of("e", &small), *full = observer_of("e", NULL);
  placido_psf blurred = blur_disc(25), lost = blur_disc(60), sharp = dark(257, 0.5);
  put_spot(&sharp, 0, 0, 1);
  for (int i = 0; i < lost.n * lost.n; i++) {
    lost.values[i] *= 0.5;
  }
  placido_acuity a = find(chart, &blurred);
  assert_int_equal(a.verdict, PLACIDO_ACUITY_BEYOND_CHART);
  assert_true(isnan(a.logmar) && a.bound_logmar == 0.4);
  a = find(full, &lost);
  assert_int_equal(a.verdict, PLACIDO_ACUITY_BEYOND_WINDOW);
  assert_near(a.bound_logmar, log10(257 * 0.5 / 10), 1e-12); /* letters of half the window */
  const placido_acuity_options large = {.smallest_logmar = 0.5, .largest_logmar = 1};
  placido_observer *coarse = observer_of("e", &large);
  a = find(coarse, &sharp);
  assert_int_equal(a.verdict, PLACIDO_ACUITY_ALL_READ);
  assert_true(a.bound_logmar == 0.5);
  placido_observer_free(coarse);
  placido_observer_free(chart);
  placido_observer_free(full);
  placido_psf_free(&blurred);
  placido_psf_free(&lost);
  placido_psf_free(&sharp);
}

static void test_variants_widen_the_interval(void **state) {
  (void)state;
  placido_observer *observer = observer_of("e", NULL);
  placido_psf psf = normal_eye(4, 1, 0), more = normal_eye(4, 1.2, 0), same = normal_eye(4, 1, 0);
  const placido_acuity_variant variants[] = {{&more, 1}, {&same, 5}, {&more, 3}};
  placido_acuity alone = find(observer, &psf), with, moved = find(observer, &more);
  assert_true(isnan(alone.sigma_optics));
  assert_int_equal(placido_acuity_find(&with, observer, &psf, variants, 3, NULL), PLACIDO_OK);
  assert_true(with.logmar == alone.logmar);
  /* Each search ends within half a thousandth. */
  assert_near(with.sigma_optics, 2 * (moved.logmar - alone.logmar), 0.002);
  assert_near(with.sigma, sqrt(alone.sigma * alone.sigma + with.sigma_optics * with.sigma_optics),
              1e-9);
  assert_near(with.high_logmar - with.low_logmar, 2 * 1.96 * with.sigma, 1e-4);
  /* A quarter more or less noise moves an acuity by about half a line: people of equal optics. */
  assert_true(alone.sigma_observer > 0.02 && alone.sigma_observer < 0.1);
  placido_psf_free(&psf);
  placido_psf_free(&more);
  placido_psf_free(&same);
  placido_observer_free(observer);
}

/* Few rays leave no speckle: the seed's 19,801 over the square of 8 mm and ten times as many give
 * acuities that differ by less than people notice. */
static void test_few_rays_are_enough(void **state) {
  (void)state;
  placido_observer *observer = observer_of("sloan", NULL);
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = {.pupil_mm = 4, .correct = true};
  const placido_optics sparse = {.samples = 100}, dense = {.samples = 320};
  placido_psf few = psf_of(surface, &eye, &sparse), many = psf_of(surface, &eye, &dense);
  assert_near(find(observer, &few).logmar, find(observer, &many).logmar, 0.02);
  placido_psf_free(&few);
  placido_psf_free(&many);
  placido_surface_free(surface);
  placido_observer_free(observer);
}

static void test_same_bits_from_every_thread(void **state) {
  (void)state;
  placido_observer *observer = observer_of("sloan", NULL);
  placido_psf psf = normal_eye(4, 0.5, 0);
  placido_acuity found[6];
  int statuses[6];
#pragma omp parallel for num_threads(3)
  for (int k = 0; k < 6; k++) {
    statuses[k] = placido_acuity_find(&found[k], observer, &psf, NULL, 0, NULL);
  }
  for (int k = 0; k < 6; k++) {
    assert_int_equal(statuses[k], PLACIDO_OK);
    assert_memory_equal(&found[k].logmar, &found[0].logmar, sizeof found[0].logmar);
  }
  placido_psf_free(&psf);
  placido_observer_free(observer);
}

static void test_refuses_what_is_no_psf(void **state) {
  (void)state;
  placido_observer *observer = observer_of("e", NULL);
  placido_psf psf = dark(9, 0.5), broken = psf;
  placido_acuity acuity;
  placido_error err;
  assert_int_equal(placido_acuity_find(&acuity, observer, &psf, NULL, 0, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "light"));
  assert_true(isnan(acuity.logmar));
  put_spot(&psf, 0, 0, 1);
  broken.bucket_arcmin = NAN;
  assert_int_equal(placido_acuity_find(&acuity, observer, &broken, NULL, 0, &err), PLACIDO_INPUT);
  broken = psf;
  broken.n = 8;
  assert_int_equal(placido_acuity_find(&acuity, observer, &broken, NULL, 0, &err), PLACIDO_INPUT);
  psf.values[0] = NAN;
  assert_int_equal(placido_acuity_find(&acuity, observer, &psf, NULL, 0, &err), PLACIDO_INPUT);
  psf.values[0] = 0.5;
  assert_int_equal(placido_acuity_find(&acuity, observer, &psf, NULL, 0, &err), PLACIDO_INPUT);
  placido_psf_free(&psf);
  placido_observer_free(observer);
  placido_observer_free(NULL);
  const placido_acuity_options wrong[] = {{.trials = 3}, {.noise = -1}, {.criterion = 0.2},
                                          {.largest_logmar = 3}, {.observer_spread = NAN}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    int status = placido_observer_new(&observer, placido_acuity_test_find("e"), &wrong[i], &err);
    assert_int_equal(status, PLACIDO_INPUT);
    assert_null(observer);
  }
  assert_null(placido_acuity_test_find("snellen"));
}

static void test_every_allocation_may_fail(void **state) {
  (void)state;
  placido_psf psf = normal_eye(3, 0, 0);
  const placido_acuity_options few = {.trials = 64};
  for (unsigned long n = 1; n < 100; n++) {
    placido_observer *observer = NULL;
    placido_acuity acuity;
    placido_memory_fail_at(n);
    int status = placido_observer_new(&observer, placido_acuity_test_find("c"), &few, NULL);
    if (status == PLACIDO_OK) {
      status = placido_acuity_find(&acuity, observer, &psf, NULL, 0, NULL);
    }
    unsigned long made = placido_memory_fail_at(0);
    placido_observer_free(observer);
    if (status == PLACIDO_OK) {
      assert_true(made < n);
      placido_psf_free(&psf);
      return;
    }
    assert_int_equal(status, PLACIDO_MEMORY);
  }
  fail();
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_filters_have_their_published_values),
    cmocka_unit_test(test_score_is_that_of_forced_choice),
    cmocka_unit_test(test_letters_compare_as_their_exact_spectra_do),
    cmocka_unit_test(test_score_rises_from_chance_to_certainty),
    cmocka_unit_test(test_turning_the_eye_changes_nothing),
    cmocka_unit_test(test_bucket_does_not_matter),
    cmocka_unit_test(test_trials_leave_the_error_they_say),
    cmocka_unit_test(test_beyond_chart_and_window),
    cmocka_unit_test(test_variants_widen_the_interval),
    cmocka_unit_test(test_few_rays_are_enough),
    cmocka_unit_test(test_same_bits_from_every_thread),
    cmocka_unit_test(test_refuses_what_is_no_psf),
    cmocka_unit_test(test_every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
