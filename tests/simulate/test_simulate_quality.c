/* Figures of image quality against closed forms. */
#include "base/memory.h"
#include "eyes.h"
#include "tests/support/near.h"

#include <placido/quality.h>

#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double green_nm = 555;

/* A PSF without light. */
static placido_psf dark(int n, double bucket_arcmin) {
  placido_psf psf = {.n = n, .bucket_arcmin = bucket_arcmin};
  psf.values = placido_memory_new((size_t)n, (size_t)n * sizeof *psf.values, NULL);
  assert_non_null(psf.values);
  return psf;
}

/* Light in the bucket `right` and `up` of the middle one. */
static void put(placido_psf *psf, int right, int up, double value) {
  psf->values[(psf->n / 2 - up) * psf->n + psf->n / 2 + right] = value;
}

static placido_psf airy(double pupil_mm, int n, double bucket_arcmin) {
  const double perfect_um[1] = {0};
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  const placido_window window = {.buckets = n, .bucket_arcmin = bucket_arcmin};
  placido_psf psf = dark(n, bucket_arcmin);
  placido_pupil pupil;
  assert_int_equal(placido_pupil_of_terms(&pupil, pupil_mm, perfect_um, 1, 0, NULL), PLACIDO_OK);
  assert_int_equal(placido_diffraction(psf.values, NULL, &pupil, &wave, 1, &window, NULL),
                   PLACIDO_OK);
  placido_pupil_free(&pupil);
  return psf;
}

/* 2/pi (acos v - v sqrt(1 - v²)), v in cut-offs: 125.789 c/deg behind 4 mm. The window loses 0.3 %
 * of the light, which frequency 0 alone would show. */
static void mtf_of_a_perfect_pupil(void **state) {
  (void)state;
  static const double expected[5] = {0.87288857157, 0.685037642474, 0.391002218956,
                                     0.144293612814, 0.0373860734685};
  static const int at[5] = {2, 5, 10, 15, 18}; /* twentieths of the cut-off */
  placido_psf psf = airy(4, 1025, 0.1);
  placido_mtf mtf;
  assert_int_equal(placido_mtf_new(&mtf, &psf, 26, 125.789495639 / 20, NULL), PLACIDO_OK);
  assert_near(mtf.radial[0], 1, 1e-5);
  for (int k = 0; k < 5; k++) {
    assert_near(mtf.radial[at[k]], expected[k], 4e-3);
    for (int m = 0; m < PLACIDO_MTF_MERIDIANS; m++) {
      assert_near(mtf.meridian[m][at[k]], expected[k], 4e-3);
    }
  }
  for (int k = 21; k < 26; k++) {
    assert_near(mtf.radial[k], 0, 4e-3);
  }
  placido_mtf_free(&mtf);
  placido_psf_free(&psf);
}

/* What a bucket passes on of a frequency along a direction. */
static double bucket(double frequency_cpd, const int step[2]) {
  double length = hypot(step[0], step[1]), product = 1;
  for (int i = 0; i < 2; i++) {
    double x = pi * frequency_cpd * step[i] / length * 0.5 / 60;
    product *= x == 0 ? 1 : sin(x) / x;
  }
  return product;
}

/* Two equal images along one direction: |cos(pi f d)| along it, 1 across, for any place; of points
 * the bucket's own share is divided out in vain. */
static void mtf_of_a_double_image(void **state) {
  (void)state;
  static const int steps[4][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}}; /* along the four meridians */
  for (int m = 0; m < 4; m++) {
    placido_psf psf = dark(65, 0.5);
    placido_mtf mtf;
    double apart_deg = 6 * 0.5 / 60 * hypot(steps[m][0], steps[m][1]);
    put(&psf, 2 + 3 * steps[m][0], 3 * steps[m][1], 0.4);
    put(&psf, 2 - 3 * steps[m][0], -3 * steps[m][1], 0.4);
    assert_int_equal(placido_mtf_new(&mtf, &psf, 41, 1, NULL), PLACIDO_OK);
    for (int k = 0; k <= 40; k++) {
      double expected = fabs(cos(pi * k * apart_deg)) / bucket(k, steps[m]);
      assert_near(mtf.meridian[m][k], fmin(expected, 1), 3e-4); /* blending between samples */
      assert_near(mtf.meridian[(m + 2) % 4][k], 1, 3e-4);
    }
    placido_mtf_free(&mtf);
    placido_psf_free(&psf);
  }
}

static void mtf_refuses_what_buckets_do_not_carry(void **state) {
  (void)state;
  placido_psf psf = dark(5, 0.5);
  placido_mtf mtf;
  placido_error err;
  put(&psf, 0, 0, 1);
  assert_int_equal(placido_mtf_new(&mtf, &psf, 62, 1, &err), PLACIDO_INPUT);
  assert_null(mtf.radial);
  assert_int_equal(placido_mtf_new(&mtf, &psf, 1, 1, &err), PLACIDO_INPUT);
  put(&psf, 0, 0, 0);
  assert_int_equal(placido_mtf_new(&mtf, &psf, 61, 1, &err), PLACIDO_QUALITY);
  placido_mtf_free(&mtf);
  placido_psf_free(&psf);
}

/* 1 - J0(3.8317)² within the first dark ring of 2 mm, of what all of space receives. */
static void first_ring_holds_84_percent(void **state) {
  (void)state;
  placido_psf psf = airy(2, 1025, 0.125);
  double held = placido_encircled_share(&psf, 0, 0, 1.16353425386) * placido_psf_moments(&psf).sum;
  assert_near(held, 0.837784869173, 1e-3); /* within a bucket light is taken as even */
  double half = 0.5 / placido_psf_moments(&psf).sum, radius = placido_encircled_radius(&psf, half);
  assert_near(placido_encircled_share(&psf, 0, 0, radius), half, 1e-9);
  placido_psf_free(&psf);
}

/* A single bucket is even: a circle within holds its area; the whole is reached at the corner. */
static void a_bucket_is_even(void **state) {
  (void)state;
  placido_psf psf = dark(11, 0.5);
  put(&psf, 2, -1, 0.7);
  assert_near(placido_encircled_share(&psf, 1, -0.5, 0.2), pi * 0.04 / 0.25, 1e-12);
  assert_near(placido_encircled_share(&psf, 1, -0.5, 0.3536), 1, 1e-9);
  assert_near(placido_encircled_share(&psf, 1, -0.25, 0.25), pi / 4 / 2, 1e-12); /* half a disc */
  assert_near(placido_encircled_radius(&psf, 0.5), sqrt(0.5 * 0.25 / pi), 1e-9);
  placido_psf_free(&psf);
}

static void moments_of_two_images(void **state) {
  (void)state;
  placido_psf psf = dark(21, 0.5);
  put(&psf, 4, 6, 0.2);
  put(&psf, 0, -2, 0.2);
  placido_moments m = placido_psf_moments(&psf);
  assert_near(m.sum, 0.4, 1e-15);
  assert_near(m.x, 1, 1e-12);
  assert_near(m.y, 1, 1e-12);
  assert_near(m.xx, 1, 1e-12);
  assert_near(m.xy, 2, 1e-12);
  assert_near(m.yy, 4, 1e-12);
  assert_near(m.rms, sqrt(5), 1e-12);
  put(&psf, 4, 6, 0);
  put(&psf, 0, -2, 0);
  assert_true(isnan(placido_psf_moments(&psf).x));
  assert_true(isnan(placido_encircled_radius(&psf, 0.5)));
  placido_psf_free(&psf);
}

/* A cornea without aberrations in focus is the perfect eye, for rays and for waves; a lens of
 * either sign spoils it, and one that undoes the eye's own brings it back. */
static void focus_curve_peaks_in_focus(void **state) {
  (void)state;
  static const double wavelengths_nm[2] = {0, 555};
  placido_surface *surface = conic(7.8, -1 / (1.3375 * 1.3375));
  for (int w = 0; w < 2; w++) {
    const placido_eye eye = {
      .pupil_mm = 3, .retina_mm = 30.911111111, .correction = {.m_D = 0.5}};
    const placido_optics optics = {
      .samples = 60, .buckets = 129, .wavelength_nm = wavelengths_nm[w]};
    placido_focus_curve curve;
    placido_error err = {0};
    if (placido_focus_curve_new(&curve, surface, &eye, &optics, -1.5, 0.5, 9, &err)) {
      fail_msg("%s", err.text);
    }
    assert_near(curve.lens_D[4], -0.5, 1e-12);
    assert_near(curve.peak[4], 1, 2e-3);
    assert_near(curve.visual_strehl[4], 1, 2e-3);
    assert_near(curve.mtf_area[4], 1, 2e-3);
    for (int k = 0; k < 4; k++) {
      assert_true(curve.peak[k] < curve.peak[k + 1]);
      assert_true(curve.mtf_area[k] < curve.mtf_area[k + 1]);
      assert_true(curve.peak[8 - k] < curve.peak[7 - k]);
      assert_true(curve.mtf_area[8 - k] < curve.mtf_area[7 - k]);
      assert_near(curve.visual_strehl[k], curve.visual_strehl[8 - k], 0.05);
    }
    placido_focus_curve_free(&curve);
  }
  placido_surface_free(surface);
}

static void focus_curve_wants_a_decided_eye(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, 0);
  const placido_eye open = {.pupil_mm = 3}, eye = {.pupil_mm = 3, .retina_mm = 30};
  const placido_optics optics = {0};
  placido_focus_curve curve;
  assert_int_equal(placido_focus_curve_new(&curve, surface, &open, &optics, -1, 1, 5, NULL),
                   PLACIDO_INPUT);
  assert_int_equal(placido_focus_curve_new(&curve, surface, &eye, &optics, 1, -1, 5, NULL),
                   PLACIDO_INPUT);
  assert_int_equal(placido_focus_curve_new(&curve, surface, &eye, &optics, -1, 1, 1, NULL),
                   PLACIDO_INPUT);
  placido_focus_curve_free(&curve);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(mtf_of_a_perfect_pupil),
    cmocka_unit_test(mtf_of_a_double_image),
    cmocka_unit_test(mtf_refuses_what_buckets_do_not_carry),
    cmocka_unit_test(first_ring_holds_84_percent),
    cmocka_unit_test(a_bucket_is_even),
    cmocka_unit_test(moments_of_two_images),
    cmocka_unit_test(focus_curve_peaks_in_focus),
    cmocka_unit_test(focus_curve_wants_a_decided_eye),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
