/* Ghost images: found where they are, and not where there is only blur. */
#include "tests/simulate/aberrated.h"
#include "tests/simulate/eyes.h"

#include "base/memory.h"

#include <placido/ghost.h>

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

/* Frees the PSF. */
static placido_ghosts ghosts_of(placido_psf psf, double scale_arcmin) {
  placido_ghosts ghosts;
  placido_error err = {0};
  int status = placido_ghosts_find(&ghosts, &psf, scale_arcmin, &err);
  placido_psf_free(&psf);
  if (status != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return ghosts;
}

static void test_two_spots(void **state) {
  (void)state;
  for (int k = 0; k < 12; k++) {
    double angle = 2 * M_PI * k / 12;
    placido_psf psf = dark(257, 0.5);
    put_spot(&psf, 3, -2, 0.7);
    put_spot(&psf, 3 + 20 * cos(angle), -2 + 20 * sin(angle), 0.3);
    placido_ghosts ghosts = ghosts_of(psf, 0);
    assert_int_equal(ghosts.count, 1);
    assert_true(ghosts.diplopia);
    assert_near(ghosts.items[0].separation_arcmin, 20, 0.36); /* spots stand on buckets */
    assert_near(remainder(ghosts.items[0].direction_deg - 30.0 * k, 360), 0, 1.1);
    assert_near(remainder(ghosts.items[0].clock_h - (3 - k), 12), 0, 0.04);
    assert_near(ghosts.items[0].share, 0.3 / 0.7, 1e-6);
    assert_near(ghosts.main_share, 0.7, 1e-6);
  }
}

static void test_several_are_in_order(void **state) {
  (void)state;
  placido_psf psf = dark(257, 0.5);
  put_spot(&psf, 0, 0, 0.5);
  put_spot(&psf, 0, 30, 0.2);
  put_spot(&psf, -30, 0, 0.25);
  put_spot(&psf, 20, -20, 0.04);
  put_spot(&psf, 40, 40, 0.01); /* a fiftieth of the main image: not listed */
  placido_ghosts ghosts = ghosts_of(psf, 0);
  assert_int_equal(ghosts.count, 3);
  assert_near(ghosts.items[0].direction_deg, 180, 1e-6);
  assert_near(ghosts.items[1].direction_deg, 90, 1e-6);
  assert_near(ghosts.items[2].direction_deg, 315, 1e-6);
  char text[256];
  placido_ghosts_write(text, sizeof text, &ghosts);
  assert_string_equal(text, "3 ghost images, the brightest 30' from the main one towards 9 "
                            "o'clock, with 50 % of its light: seen double.");
}

/* Ten ghosts: the brightest are kept. */
static void test_no_more_than_there_is_room_for(void **state) {
  (void)state;
  placido_psf psf = dark(257, 0.5);
  put_spot(&psf, 0, 0, 0.3);
  for (int k = 0; k < 10; k++) {
    put_spot(&psf, 40 * cos(0.6 * k), 40 * sin(0.6 * k), 0.03 + 0.003 * k);
  }
  placido_ghosts ghosts = ghosts_of(psf, 0);
  assert_int_equal(ghosts.count, PLACIDO_GHOSTS_MAX);
  for (int k = 0; k < PLACIDO_GHOSTS_MAX; k++) {
    assert_near(ghosts.items[k].share, (0.03 + 0.003 * (9 - k)) / 0.3, 1e-6);
  }
}

/* Nearer than the scale there is one image; at that of finer letters there are two. */
static void test_scale_decides_what_is_apart(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    placido_psf psf = dark(257, 0.5);
    put_spot(&psf, 0, 0, 0.6);
    put_spot(&psf, 5, 0, 0.4);
    assert_int_equal(ghosts_of(psf, k == 0 ? 2 : 8).count, k == 0 ? 1 : 0);
  }
}

static void test_blur_alone_has_no_ghost(void **state) {
  (void)state;
  char text[256];
  for (double radius = 1; radius < 50; radius *= 2) {
    placido_ghosts ghosts = ghosts_of(blur_disc(radius), 0);
    assert_int_equal(ghosts.count, 0);
    assert_false(ghosts.diplopia);
    placido_ghosts_write(text, sizeof text, &ghosts);
    assert_string_equal(text, "No ghost image.");
  }
  for (double blur = 0; blur <= 3; blur += 1) {
    assert_int_equal(ghosts_of(normal_eye(4, blur, 0), 0).count, 0);
  }
}

/* Coma of waves and of rays: a tail, not a second image. */
static void test_coma_has_no_ghost(void **state) {
  (void)state;
  for (double coma_um = 0.1; coma_um < 1; coma_um *= 2) {
    double terms[15] = {[7] = coma_um};
    assert_int_equal(ghosts_of(aberrated(5, terms, 15, 0, 0), 0).count, 0);
  }
  const double n = 1.3375;
  placido_surface *surface = comatic(n, -15);
  for (double pupil = 2; pupil <= 6; pupil += 2) {
    placido_eye eye = {.pupil_mm = pupil, .index = n, .retina_mm = n / (n - 1) * 7.8};
    assert_int_equal(ghosts_of(psf_of(surface, &eye, &(placido_optics){0}), 0).count, 0);
  }
  placido_surface_free(surface);
}

/* A ring of light around the main image is a halo. */
static void test_halo_is_no_ghost(void **state) {
  (void)state;
  placido_psf psf = dark(257, 0.5);
  put_spot(&psf, 0, 0, 0.4);
  for (int k = 0; k < 360; k++) {
    put_spot(&psf, 25 * cos(k * M_PI / 180), 25 * sin(k * M_PI / 180), 0.6 / 360);
  }
  assert_int_equal(ghosts_of(psf, 0).count, 0);
}

/* A slope s that one half of a perfect cornea has more moves its light by (n - 1) s across the
 * ridge, seen as (n - 1) s, too. The visual field is the examiner's view upside down. */
static void test_ridge_doubles_across_itself(void **state) {
  (void)state;
  const double n = 1.3375, slope = 0.02, arcmin = 180 * 60 / M_PI;
  const double axes[] = {0, 30, 90};
  for (int k = 0; k < 3; k++) {
    placido_surface *surface = ridged(n, slope, 0.3, axes[k]);
    placido_eye eye = {.pupil_mm = 5, .index = n, .retina_mm = n / (n - 1) * 7.8};
    placido_ghosts ghosts = ghosts_of(psf_of(surface, &eye, &(placido_optics){0}), 0);
    assert_int_equal(ghosts.count, 1);
    assert_true(ghosts.diplopia);
    assert_near(ghosts.items[0].separation_arcmin, (n - 1) * slope * arcmin, 1.5);
    assert_near(remainder(ghosts.items[0].direction_deg + axes[k] - 90, 180), 0, 3);
    /* Of the disc, a segment 0.3 mm off the middle: 0.42 of all. */
    assert_near(ghosts.items[0].share, 0.42 / 0.58, 0.12);
    placido_surface_free(surface);
  }
}

static void test_refuses_nonsense(void **state) {
  (void)state;
  placido_psf psf = dark(9, 0.5);
  placido_ghosts ghosts;
  placido_error err;
  assert_int_equal(placido_ghosts_find(&ghosts, &psf, 0, &err), PLACIDO_INPUT);
  put_spot(&psf, 0, 0, 1);
  assert_int_equal(placido_ghosts_find(&ghosts, &psf, 0, &err), PLACIDO_OK);
  assert_int_equal(placido_ghosts_find(&ghosts, &psf, 100, &err), PLACIDO_INPUT);
  assert_int_equal(placido_ghosts_find(&ghosts, &psf, NAN, &err), PLACIDO_INPUT);
  for (unsigned long n = 1; n < 20; n++) {
    placido_memory_fail_at(n);
    int status = placido_ghosts_find(&ghosts, &psf, 0, &err);
    if (status == PLACIDO_OK) {
      assert_true(placido_memory_fail_at(0) < n);
      break;
    }
    assert_int_equal(status, PLACIDO_MEMORY);
  }
  placido_psf_free(&psf);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_two_spots),
    cmocka_unit_test(test_several_are_in_order),
    cmocka_unit_test(test_no_more_than_there_is_room_for),
    cmocka_unit_test(test_scale_decides_what_is_apart),
    cmocka_unit_test(test_blur_alone_has_no_ghost),
    cmocka_unit_test(test_coma_has_no_ghost),
    cmocka_unit_test(test_halo_is_no_ghost),
    cmocka_unit_test(test_ridge_doubles_across_itself),
    cmocka_unit_test(test_refuses_nonsense),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
