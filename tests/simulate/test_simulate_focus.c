/* The search: peaks of known corneas, cylinders and their axes, an eye that is turned. */
#include "eyes.h"
#include "simulate/eye.h"
#include "simulate/light.h"
#include "simulate/trace.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

/* Greatest geometric Strehl ratio over all focus positions, n = 4/3, half-minute buckets, from an
 * independent trace; the search may lose 5 % of it. */
static void test_search_finds_the_peak_and_not_the_least_spread(void **state) {
  (void)state;
  static const struct {
    double q, pupil_mm, strehl, defocus_D;
  } rows[] = {
    {-0.26, 2, 1, 0.07}, {-0.26, 4, 0.49, 0.16}, {-0.26, 8, 0.122, 0.16},
    {0, 4, 0.33, 0.19},  {0, 8, 0.082, 0.19},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    double n = 4.0 / 3, paraxial_D = 1000 * (n - 1) / 7.8;
    placido_surface *surface = conic(7.8, rows[i].q);
    placido_eye eye = {.pupil_mm = rows[i].pupil_mm, .index = n};
    placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
    assert_true(psf.strehl_g > 0.95 * rows[i].strehl);
    /* Least spread at 8 mm is at 1.21 and 2.35 D. */
    assert_near(1000 * n / psf.retina_mm - paraxial_D, rows[i].defocus_D, 0.05);
    placido_psf_free(&psf);
    placido_surface_free(surface);
  }
}

/* A paraxial toric cornea: the cylinder is the difference of its powers, (n - 1)(1/r2 - 1/r1), and
 * its minus cylinder lies along the flat meridian, whose power needs no change. */
static void test_search_finds_cylinder_and_axis(void **state) {
  (void)state;
  const double axes_deg[] = {0, 30, 90, 135};
  double expected_D = -337.5 * (1 / 7.5 - 1 / 7.849);
  for (int i = 0; i < 4; i++) {
    placido_surface *surface = toric(7.849, 7.5, -0.25, axes_deg[i]);
    for (double pupil_mm = 2; pupil_mm <= 8; pupil_mm *= 2) {
      placido_eye eye = {.pupil_mm = pupil_mm, .correct = true};
      placido_psf psf = psf_of(surface, &eye, &(placido_optics){.samples = 200});
      double sphere_D, cylinder_D, axis_deg;
      placido_correction_clinical(&psf.correction, &sphere_D, &cylinder_D, &axis_deg);
      /* 0.03 D: the peak of the aberrated pupil is not exactly its paraxial focus. */
      assert_near(cylinder_D, expected_D, 0.03);
      double off = remainder(axis_deg - axes_deg[i], 180);
      assert_near(off, 0, 0.3);
      assert_near(psf.correction.m_D, 0, 0);
      placido_psf_free(&psf);
    }
    placido_surface_free(surface);
  }
}

/* Without correction both principal meridians stay: the PSF is worse than with it. */
static void test_correction_is_only_worn_where_asked_for(void **state) {
  (void)state;
  placido_surface *surface = toric(7.849, 7.5, -0.25, 30);
  placido_psf bare = psf_of(surface, &(placido_eye){.pupil_mm = 4}, &(placido_optics){0});
  placido_psf worn =
    psf_of(surface, &(placido_eye){.pupil_mm = 4, .correct = true}, &(placido_optics){0});
  assert_true(bare.correction.j0_D == 0 && bare.correction.j45_D == 0);
  assert_true(worn.strehl_g > 5 * bare.strehl_g);
  placido_psf_free(&bare);
  placido_psf_free(&worn);
  placido_surface_free(surface);
}

/* A fixed retina in front of the focus and a prescription that makes up for it: 1 D more of lens
 * power is 1 D more of vergence. */
static void test_given_sphere_and_retina_are_used_as_they_are(void **state) {
  (void)state;
  double n = 1.3375, focus_D = 1000 * (n - 1) / 7.8;
  placido_surface *surface = conic(7.8, -1 / (n * n));
  placido_eye eye = {.pupil_mm = 2, .retina_mm = 1000 * n / (focus_D + 1)};
  placido_psf blurred = psf_of(surface, &eye, &(placido_optics){.samples = 100});
  eye.correction.m_D = 1;
  placido_psf sharp = psf_of(surface, &eye, &(placido_optics){.samples = 100});
  assert_true(blurred.retina_mm == eye.retina_mm && sharp.correction.m_D == 1);
  assert_true(blurred.strehl_g < 0.02 && sharp.strehl_g > 0.9);
  placido_psf_free(&blurred);
  placido_psf_free(&sharp);
  placido_surface_free(surface);
}

/* A cone: the peak is nowhere near the middle of the light. Its cylinder search must not lose to
 * the eye without one. */
static void test_cylinder_never_makes_a_cone_worse(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  for (double pupil_mm = 2; pupil_mm <= 8; pupil_mm *= 2) {
    placido_psf bare = psf_of(surface, &(placido_eye){.pupil_mm = pupil_mm}, &(placido_optics){0});
    placido_psf worn =
      psf_of(surface, &(placido_eye){.pupil_mm = pupil_mm, .correct = true}, &(placido_optics){0});
    /* The search works on 2,000 rays and a smooth peak, not on this histogram. */
    assert_true(worn.strehl_g > 0.9 * bare.strehl_g);
    placido_psf_free(&bare);
    placido_psf_free(&worn);
  }
  placido_surface_free(surface);
}

/* An eye turned by 30 degrees towards +y: axis 30 degrees more, the PSF turned with it. In the
 * picture that the patient sees rows grow with y, so (column, row) turns like (x, y). */
static void test_turned_eye_has_a_turned_psf(void **state) {
  (void)state;
  const double turn_deg = 30, turn = turn_deg * acos(-1) / 180;
  placido_surface *straight = keratoconus(0), *turned = keratoconus(turn_deg);
  placido_eye eye = {.pupil_mm = 8, .correct = true};
  placido_optics optics = {.buckets = 801, .bucket_arcmin = 0.25};
  placido_psf a = psf_of(straight, &eye, &optics), b = psf_of(turned, &eye, &optics);
  moments m = moments_of(&a), t = moments_of(&b);
  double c = cos(turn), s = sin(turn), size = sqrt(m.cc + m.rr);
  /* The square sampling is not turned with the eye: 2 % of the spot's size. */
  assert_near(t.column, c * m.column - s * m.row, 0.02 * size);
  assert_near(t.row, s * m.column + c * m.row, 0.02 * size);
  assert_near(t.cc, c * c * m.cc - 2 * c * s * m.cr + s * s * m.rr, 0.03 * size * size);
  assert_near(t.cr, c * s * (m.cc - m.rr) + (c * c - s * s) * m.cr, 0.03 * size * size);
  double j0 = cos(2 * turn) * a.correction.j0_D - sin(2 * turn) * a.correction.j45_D;
  double j45 = sin(2 * turn) * a.correction.j0_D + cos(2 * turn) * a.correction.j45_D;
  assert_near(b.correction.j0_D, j0, 0.02);
  assert_near(b.correction.j45_D, j45, 0.02);
  assert_true(hypot(m.column, m.row) > 0.1 * size); /* there is something to turn */
  placido_psf_free(&a);
  placido_psf_free(&b);
  placido_surface_free(straight);
  placido_surface_free(turned);
}

/* Share of the light that the search's profile gathers at 0.4', as the eye that was found sees it.
 */
static double gathered_share(const placido_surface *surface, const placido_eye *eye) {
  placido_optics optics = {.bucket_arcmin = 0.5};
  placido_apex apex;
  placido_rays rays;
  double peak[2];
  assert_int_equal(placido_apex_find(&apex, surface, eye, NULL), PLACIDO_OK);
  assert_int_equal(placido_rays_new(&rays, surface, &apex, eye, 75, NULL), PLACIDO_OK);
  double *x = test_calloc(rays.count, 2 * sizeof *x), *y = x + rays.count;
  for (size_t i = 0; i < rays.count; i++) {
    assert_true(placido_entry_trace(&rays.entries[i], eye, eye->retina_mm, &x[i], &y[i]));
  }
  double arcmin_mm =
    placido_apex_bucket_um(&apex, &optics, eye->index, eye->retina_mm) / 0.5 / 1000;
  double share =
    placido_light_peak(x, y, rays.count, 0.4 * arcmin_mm, peak) / (double)rays.count;
  test_free(x);
  placido_rays_free(&rays);
  return share;
}

/* Cones small and large, near and far: the best shares known are those of a brute-force search by
 * another program, downhill in five unknowns from 2,500 random starts. */
static void test_search_finds_the_best_focus_of_cones(void **state) {
  (void)state;
  static const struct {
    double height_mm, sigma_mm, x_mm, y_mm, pupil_mm, best;
  } rows[] = {
    {0.061, 1.2, 0.7, -0.7, 4, 0.03028}, {0.061, 1.2, 0.7, -0.7, 8, 0.03516},
    {0.044, 1.3, 0.2, -0.5, 8, 0.04831}, {0.018, 0.6, 0.9, -0.5, 2, 0.11463},
    {0.018, 0.6, 0.9, -0.5, 8, 0.04267}, {0.078, 1.0, -0.6, -1.5, 4, 0.08903},
    {0.078, 1.0, -0.6, -1.5, 8, 0.03033}, {0.050, 0.8, -1.0, -1.0, 8, 0.03321},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    placido_surface *surface =
      cone(rows[i].height_mm, rows[i].sigma_mm, rows[i].x_mm, rows[i].y_mm);
    placido_eye eye = {.pupil_mm = rows[i].pupil_mm, .correct = true}, found;
    placido_psf psf;
    placido_optics optics = {.samples = 20}; /* the search has its own */
    assert_int_equal(placido_psf_new(&psf, &found, surface, &eye, &optics, NULL, NULL),
                     PLACIDO_OK);
    double share = gathered_share(surface, &found);
    if (!(share >= 0.97 * rows[i].best)) {
      fail_msg("cone %zu, pupil %g mm: %.5f of the light, %.5f is known", i, eye.pupil_mm, share,
               rows[i].best);
    }
    placido_psf_free(&psf);
    placido_surface_free(surface);
  }
}

/* A retina in the wrong place: the cylinder alone is searched, and must not lose to none. */
static void test_cylinder_is_found_for_a_given_retina(void **state) {
  (void)state;
  placido_surface *surface = toric(7.849, 7.5, -0.25, 30);
  double retina_mm = 1337.5 / (337.5 / 7.849); /* at the flat meridian's focus */
  placido_eye bare = {.pupil_mm = 4, .retina_mm = retina_mm};
  placido_eye open = {.pupil_mm = 4, .retina_mm = retina_mm, .correct = true};
  placido_psf without = psf_of(surface, &bare, &(placido_optics){0});
  placido_psf with = psf_of(surface, &open, &(placido_optics){0});
  assert_true(with.retina_mm == retina_mm && with.correction.m_D == 0);
  assert_true(with.strehl_g >= without.strehl_g);
  placido_psf_free(&without);
  placido_psf_free(&with);
  placido_surface_free(surface);
}

/* Thibos et al. 1997: -1.00 / -2.00 × 30. */
static void test_power_vector_becomes_a_prescription(void **state) {
  (void)state;
  double sphere_D, cylinder_D, axis_deg;
  placido_correction vector = {-2, cos(acos(-1) / 3), sin(acos(-1) / 3)};
  placido_correction_clinical(&vector, &sphere_D, &cylinder_D, &axis_deg);
  assert_near(sphere_D, -1, 1e-12);
  assert_near(cylinder_D, -2, 1e-12);
  assert_near(axis_deg, 30, 1e-12);
  vector = (placido_correction){0, 0, -1};
  placido_correction_clinical(&vector, &sphere_D, &cylinder_D, &axis_deg);
  assert_near(axis_deg, 135, 1e-12);
  vector = (placido_correction){1.5, 0, 0};
  placido_correction_clinical(&vector, &sphere_D, &cylinder_D, &axis_deg);
  assert_true(sphere_D == 1.5 && cylinder_D == 0 && isnan(axis_deg));
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_search_finds_the_peak_and_not_the_least_spread),
    cmocka_unit_test(test_search_finds_cylinder_and_axis),
    cmocka_unit_test(test_correction_is_only_worn_where_asked_for),
    cmocka_unit_test(test_given_sphere_and_retina_are_used_as_they_are),
    cmocka_unit_test(test_cylinder_never_makes_a_cone_worse),
    cmocka_unit_test(test_turned_eye_has_a_turned_psf),
    cmocka_unit_test(test_search_finds_the_best_focus_of_cones),
    cmocka_unit_test(test_cylinder_is_found_for_a_given_retina),
    cmocka_unit_test(test_power_vector_becomes_a_prescription),
  };
  return cmocka_run_group_tests_name("simulate_focus", tests, NULL, NULL);
}
