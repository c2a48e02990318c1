/* The PSF: exact cases, conservation of light, orientation, refusals. */
#include "eyes.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pupils_mm[] = {2, 4, 8};

/* The Cartesian oval for infinity is the ellipsoid of Q = -1/n². */
static void test_perfect_ellipsoid_puts_every_ray_in_one_bucket(void **state) {
  (void)state;
  const double indices[] = {1.3375, 4.0 / 3};
  for (int k = 0; k < 2; k++) {
    placido_surface *surface = conic(7.8, -1 / (indices[k] * indices[k]));
    for (int i = 0; i < 6; i++) {
      placido_eye eye = {.pupil_mm = pupils_mm[i % 3], .index = indices[k], .correct = i < 3};
      placido_psf psf = psf_of(surface, &eye, &(placido_optics){.samples = 100});
      assert_int_equal(psf.rays, 19801);
      assert_int_equal(psf.rays_entered, 15373);
      assert_int_equal(psf.rays_landed, psf.rays_entered);
      assert_int_equal(psf.rays_missed, 0);
      assert_true(psf.strehl_g == 1);
      assert_true(psf.values[psf.n * (psf.n / 2) + psf.n / 2] == 1);
      /* 0.002 D is where the search stops; the focus is at n R / (n - 1). */
      double focus_D = 1000 * (indices[k] - 1) / 7.8;
      assert_near(1000 * indices[k] / psf.retina_mm, focus_D, 0.002);
      placido_psf_free(&psf);
    }
    placido_surface_free(surface);
  }
}

static void test_psf_sums_to_the_share_that_landed(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  for (int i = 0; i < 3; i++) {
    placido_eye eye = {.pupil_mm = pupils_mm[i], .correct = true};
    placido_psf psf = psf_of(surface, &eye, &(placido_optics){.buckets = 101});
    moments m = moments_of(&psf);
    double most = 0;
    for (int k = 0; k < psf.n * psf.n; k++) {
      most = fmax(most, psf.values[k]);
    }
    double landed = (double)psf.rays_landed / (double)psf.rays_entered;
    assert_near(m.sum, landed, 1e-12);
    assert_near(psf.strehl_g, most / landed, 1e-12);
    assert_int_equal(psf.rays, 400 * 400 + 399 * 399);
    placido_psf_free(&psf);
  }
  placido_surface_free(surface);
}

/* The upper half's extra slope turns its normals upwards, and light bends away from them: it meets
 * the retina lower, and what is lower on the retina is seen higher (as through a prism with its
 * thin edge up). The upper image lies (n - 1) × slope off; as entering light is refracted at the
 * nodal point's scale, an angle e at the surface is e (n - 1) in the visual field. */
static void test_ghost_of_an_upper_ridge_is_seen_above(void **state) {
  (void)state;
  double n = 1.3375, slope = 0.01;
  placido_surface *surface = ridged(n, slope, 0.5, 0);
  placido_eye eye = {.pupil_mm = 4, .index = n, .retina_mm = n / (n - 1) * 7.8};
  placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
  double ghost = 0, ghost_row = 0;
  int half = psf.n / 2;
  for (int row = 0; row < psf.n; row++) {
    for (int column = 0; column < psf.n; column++) {
      double value = psf.values[row * psf.n + column];
      if (abs(row - half) > 6) {
        ghost += value;
        ghost_row += value * (row - half);
      }
    }
  }
  /* Share of a 4 mm disc above 0.5 mm: (acos k - k sqrt(1 - k²)) / pi, k = 1/4, is 0.343. */
  assert_near(ghost, 0.343, 0.02); /* the ridge is 0.02 mm wide */
  double expected_arcmin = -slope * (n - 1) / 2.908882e-4;
  /* Blur of the ghost by the tilted incidence and the ridge's rim: a few per cent. */
  assert_near(ghost_row / ghost * psf.bucket_arcmin, expected_arcmin,
                     0.06 * -expected_arcmin);
  assert_true(expected_arcmin < 0);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

/* The same ridge on the right half: thin edge to the right of the picture that the examiner sees.
 * Its light meets the retina at smaller x, which is on the patient's left. */
static void test_ghost_of_a_right_ridge_is_seen_at_smaller_columns(void **state) {
  (void)state;
  double n = 1.3375;
  placido_surface *surface = ridged(n, 0.01, 0.5, -90);
  placido_eye eye = {.pupil_mm = 4, .index = n, .retina_mm = n / (n - 1) * 7.8};
  placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
  moments m = moments_of(&psf);
  assert_true(m.column < -2); /* a third of the light 11.6' off: -3.9' */
  assert_near(m.row, 0, 0.2);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

/* Coma, lower half steeper, focus kept in the middle: light from below has crossed the axis before
 * the retina, meets it above, and what is above on the retina is seen below: the comet's tail hangs
 * down. Light from above has not yet met and arrives above too. */
static void test_tail_of_a_cornea_steeper_below_hangs_down(void **state) {
  (void)state;
  double n = 1.3375;
  placido_surface *surface = comatic(n, -15);
  placido_eye eye = {.pupil_mm = 4, .index = n, .retina_mm = n / (n - 1) * 7.8};
  placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
  moments m = moments_of(&psf);
  double above = 0;
  for (int i = 0; i < psf.n * (psf.n / 2 - 4); i++) {
    above += psf.values[i];
  }
  assert_near(m.sum, 1, 1e-12);
  assert_true(m.row > 4); /* rows grow downwards */
  assert_near(m.column, 0, 0.1);
  assert_near(above, 0, 0); /* nothing 2' above the tip */
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

static void test_result_does_not_depend_on_threads(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  placido_eye eye = {.pupil_mm = 4, .correct = true};
  placido_psf one = psf_of(surface, &eye, &(placido_optics){.samples = 101, .threads = 1});
  placido_psf three = psf_of(surface, &eye, &(placido_optics){.samples = 101, .threads = 3});
  assert_memory_equal(one.values, three.values, sizeof *one.values * 257 * 257);
  assert_true(one.retina_mm == three.retina_mm && one.strehl_g == three.strehl_g);
  assert_int_equal(one.rays_entered, three.rays_entered);
  placido_psf_free(&one);
  placido_psf_free(&three);
  placido_surface_free(surface);
}

static void test_what_was_found_traces_to_the_same_psf(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  placido_eye eye = {.pupil_mm = 4, .correct = true}, found;
  placido_optics optics = {.samples = 60};
  placido_psf first;
  assert_int_equal(placido_psf_new(&first, &found, surface, &eye, &optics, NULL, NULL), PLACIDO_OK);
  placido_psf again = psf_of(surface, &found, &optics);
  assert_memory_equal(first.values, again.values, sizeof *first.values * 257 * 257);
  placido_psf_free(&first);
  placido_psf_free(&again);
  placido_surface_free(surface);
}

static void test_cwhatuc_counts_in_buckets_of_2500_nm(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26);
  placido_eye eye = {.pupil_mm = 8};
  placido_psf psf = psf_of(surface, &eye, &(placido_optics){.samples = 100, .cwhatuc = true});
  assert_true(psf.bucket_um == 2.5 && psf.bucket_arcmin == 0.5);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

static void test_tiny_and_decentred_pupils_work(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26);
  placido_eye tiny = {.pupil_mm = 0.3, .correct = true};
  placido_psf psf = psf_of(surface, &tiny, &(placido_optics){.samples = 100});
  assert_true(psf.strehl_g == 1); /* aberrations go with the cube of the pupil */
  placido_psf_free(&psf);
  placido_eye decentred = {.pupil_mm = 3, .pupil_x_mm = 1, .pupil_y_mm = -0.5};
  psf = psf_of(surface, &decentred, &(placido_optics){.samples = 100});
  assert_int_equal(psf.rays_missed, 0);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

static void expect_failure(const placido_surface *surface, placido_eye eye, placido_optics optics,
                           int status, const char *words) {
  placido_psf psf;
  placido_error err = {0};
  assert_int_equal(placido_psf_new(&psf, NULL, surface, &eye, &optics, NULL, &err), status);
  assert_null(psf.values);
  if (strstr(err.text, words) == NULL) {
    fail_msg("\"%s\" does not say \"%s\"", err.text, words);
  }
}

static void test_bad_arguments_are_refused(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26);
  placido_optics plain = {0};
  expect_failure(surface, (placido_eye){0}, plain, PLACIDO_INPUT, "pupil");
  expect_failure(surface, (placido_eye){.pupil_mm = NAN}, plain, PLACIDO_INPUT, "pupil");
  expect_failure(surface, (placido_eye){.pupil_mm = 4, .index = 1}, plain, PLACIDO_INPUT, "index");
  expect_failure(surface, (placido_eye){.pupil_mm = 4, .retina_mm = -3}, plain, PLACIDO_INPUT,
                 "retina");
  expect_failure(surface, (placido_eye){.pupil_mm = 4}, (placido_optics){.buckets = 256},
                 PLACIDO_INPUT, "odd");
  expect_failure(surface, (placido_eye){.pupil_mm = 4}, (placido_optics){.samples = -5},
                 PLACIDO_INPUT, "samples");
  expect_failure(surface, (placido_eye){.pupil_mm = 4}, (placido_optics){.threads = 1000},
                 PLACIDO_INPUT, "threads");
  expect_failure(surface, (placido_eye){.pupil_mm = 4},
                 (placido_optics){.cwhatuc = true, .bucket_arcmin = 1}, PLACIDO_INPUT, "seed");
  placido_surface_free(surface);
}

static void test_what_cannot_be_seen_through_is_refused(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26); /* to 4.5 mm */
  placido_optics plain = {0};
  expect_failure(surface, (placido_eye){.pupil_mm = 11}, plain, PLACIDO_QUALITY, "67 %");
  expect_failure(surface, (placido_eye){.pupil_mm = 2, .pupil_x_mm = 5}, plain, PLACIDO_QUALITY,
                 "not defined");
  placido_surface_free(surface);
  surface = flat();
  expect_failure(surface, (placido_eye){.pupil_mm = 4}, plain, PLACIDO_QUALITY, "no focus");
  placido_surface_free(surface);
}

/* 9.1 mm on a surface of 9.0 mm: 2 % of the rays miss, which is told, not hidden. */
static void test_missed_rays_are_counted_and_told(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26);
  placido_eye eye = {.pupil_mm = 9.1};
  placido_notes notes = {0};
  placido_psf psf;
  int status = placido_psf_new(&psf, NULL, surface, &eye, &(placido_optics){.samples = 100},
                               &notes, NULL);
  assert_int_equal(status, PLACIDO_OK);
  assert_int_equal(psf.rays_entered + psf.rays_missed, 15373);
  double share = 1 - 81 / (9.1 * 9.1);
  assert_near((double)psf.rays_missed / 15373, share, 0.003); /* hard rim */
  assert_true(notes.count >= 1 && strstr(notes.lines[0], "do not meet the surface") != NULL);
  placido_notes_clear(&notes);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_perfect_ellipsoid_puts_every_ray_in_one_bucket),
    cmocka_unit_test(test_psf_sums_to_the_share_that_landed),
    cmocka_unit_test(test_ghost_of_an_upper_ridge_is_seen_above),
    cmocka_unit_test(test_ghost_of_a_right_ridge_is_seen_at_smaller_columns),
    cmocka_unit_test(test_tail_of_a_cornea_steeper_below_hangs_down),
    cmocka_unit_test(test_result_does_not_depend_on_threads),
    cmocka_unit_test(test_what_was_found_traces_to_the_same_psf),
    cmocka_unit_test(test_cwhatuc_counts_in_buckets_of_2500_nm),
    cmocka_unit_test(test_tiny_and_decentred_pupils_work),
    cmocka_unit_test(test_bad_arguments_are_refused),
    cmocka_unit_test(test_what_cannot_be_seen_through_is_refused),
    cmocka_unit_test(test_missed_rays_are_counted_and_told),
  };
  return cmocka_run_group_tests_name("simulate_psf", tests, NULL, NULL);
}
