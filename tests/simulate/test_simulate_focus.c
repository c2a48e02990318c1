/* The search: peaks of known corneas, cylinders and their axes, an eye that is turned. */
#include "eyes.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/trace.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

/* Where the half-minute histogram is highest and where the spread is least, as defocus from the
 * paraxial focus, n = 4/3, from an independent trace. Light counts within some 0.7', so the best
 * focus is beside the one and far from the other; of the highest bucket it leaves over a half. */
static void test_search_finds_the_peak_and_not_the_least_spread(void **state) {
  (void)state;
  static const struct {
    double q, pupil_mm, strehl, peak_D, spread_D;
  } rows[] = {
    {-0.26, 2, 1, 0.07, 0.07}, {-0.26, 4, 0.49, 0.16, 0.29}, {-0.26, 8, 0.122, 0.16, 1.21},
    {0, 4, 0.33, 0.19, 0.54},  {0, 8, 0.082, 0.19, 2.35},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    double n = 4.0 / 3, paraxial_D = 1000 * (n - 1) / 7.8;
    placido_surface *surface = conic(7.8, rows[i].q);
    placido_eye eye = {.pupil_mm = rows[i].pupil_mm, .index = n};
    placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
    double defocus_D = 1000 * n / psf.retina_mm - paraxial_D;
    assert_true(psf.strehl_g > 0.55 * rows[i].strehl);
    assert_true(defocus_D > rows[i].peak_D - 0.01 && defocus_D < rows[i].peak_D + 0.12);
    assert_true(defocus_D < rows[i].spread_D + 0.01);
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
      /* 0.04 D: an asphere's cylinder grows a little towards the rim. */
      assert_near(cylinder_D, expected_D, 0.04);
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

/* Share of the light within the search's profile, as the eye that was found sees it: gathered and
 * followed uphill (mean shift) in double precision from every hundredth ray. */
static double gathered_share(const placido_surface *surface, const placido_eye *eye) {
  placido_optics optics = {.bucket_arcmin = 0.5};
  placido_apex apex;
  placido_rays rays;
  assert_int_equal(placido_apex_find(&apex, surface, eye, NULL), PLACIDO_OK);
  assert_int_equal(placido_rays_new(&rays, surface, &apex, eye, 75, NULL), PLACIDO_OK);
  double *x = test_calloc(rays.count, 2 * sizeof *x), *y = x + rays.count, best = 0;
  for (size_t i = 0; i < rays.count; i++) {
    assert_true(placido_entry_trace(&rays.entries[i], eye, eye->retina_mm, &x[i], &y[i]));
  }
  double arcmin_mm =
    placido_apex_bucket_um(&apex, &optics, eye->index, eye->retina_mm) / 0.5 / 1000;
  double width_mm = PLACIDO_FOCUS_WIDTH_ARCMIN * arcmin_mm;
  for (size_t k = 0; k < rays.count; k += 100) {
    double at[2] = {x[k], y[k]}, gathered = 0;
    for (int step = 0; step < 4; step++) {
      double weight = 0, sum[2] = {0, 0};
      gathered = 0;
      for (size_t i = 0; i < rays.count; i++) {
        double far = 1 + (pow(x[i] - at[0], 2) + pow(y[i] - at[1], 2)) / pow(width_mm, 2);
        double share = 1 / (far * sqrt(far));
        gathered += share;
        weight += share / far;
        sum[0] += share / far * x[i];
        sum[1] += share / far * y[i];
      }
      at[0] = sum[0] / weight;
      at[1] = sum[1] / weight;
    }
    best = fmax(best, gathered);
  }
  best /= (double)rays.count;
  test_free(x);
  placido_rays_free(&rays);
  return best;
}

/* Cones small and large, near and far: the best shares known are those of a brute-force search by
 * another program, with a trace of its own, by simplices in five
 * unknowns from 3,000 random starts and 9,000 rays of another pattern: hence the 1 %. */
static void test_search_finds_the_best_focus_of_cones(void **state) {
  (void)state;
  static const struct {
    double height_mm, sigma_mm, x_mm, y_mm, pupil_mm, best;
  } rows[] = {
    {0.061, 1.2, 0.7, -0.7, 4, 0.04995}, {0.061, 1.2, 0.7, -0.7, 8, 0.06711},
    {0.044, 1.3, 0.2, -0.5, 8, 0.09215}, {0.018, 0.6, 0.9, -0.5, 2, 0.17583},
    {0.018, 0.6, 0.9, -0.5, 8, 0.09017}, {0.078, 1.0, -0.6, -1.5, 4, 0.12607},
    {0.078, 1.0, -0.6, -1.5, 8, 0.05853}, {0.050, 0.8, -1.0, -1.0, 8, 0.06579},
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
    if (!(share >= 0.99 * rows[i].best)) {
      fail_msg("cone %zu, pupil %g mm: %.5f of the light, %.5f is known", i, eye.pupil_mm, share,
               rows[i].best);
    }
    placido_psf_free(&psf);
    placido_surface_free(surface);
  }
}

/* A perfect cornea and a retina that is a dioptre and a half too near: the lens makes up for it, and
 * nothing else changes. */
static void test_sphere_is_found_for_a_given_retina(void **state) {
  (void)state;
  static const enum placido_correct asked[] = {PLACIDO_CORRECT_SPHERE, PLACIDO_CORRECT_FULL};
  double n = 1.3375, focus_D = 1000 * (n - 1) / 7.8;
  placido_surface *surface = conic(7.8, -1 / (n * n));
  for (int i = 0; i < 4; i++) {
    double lens_D = i < 2 ? 1.5 : -7;
    placido_eye eye = {.pupil_mm = 1, .retina_mm = 1000 * n / (focus_D + lens_D),
                       .correct = asked[i % 2]};
    placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
    assert_near(psf.correction.m_D, lens_D, 0.005 * fabs(lens_D)); /* what 1 mm has of aberration */
    assert_true(psf.correction.j0_D == 0 && psf.correction.j45_D == 0);
    assert_true(psf.retina_mm == eye.retina_mm);
    placido_psf_free(&psf);
  }
  placido_surface_free(surface);
}

/* Whether the retina or the lens's sphere is searched, the lens and the retina together are the
 * same: on the retina that the first search finds, the second one wants no sphere. */
static void test_both_kinds_of_sphere_agree(void **state) {
  (void)state;
  placido_surface *surface = toric(7.849, 7.5, -0.25, 30);
  placido_eye eye = {.pupil_mm = 4, .correct = PLACIDO_CORRECT_FULL};
  placido_psf by_retina = psf_of(surface, &eye, &(placido_optics){0});
  eye.retina_mm = by_retina.retina_mm;
  placido_psf by_lens = psf_of(surface, &eye, &(placido_optics){0});
  assert_near(by_lens.correction.m_D, 0, 0.005);
  assert_near(by_lens.correction.j0_D, by_retina.correction.j0_D, 0.005);
  assert_near(by_lens.correction.j45_D, by_retina.correction.j45_D, 0.005);
  placido_psf_free(&by_retina);
  placido_psf_free(&by_lens);
  placido_surface_free(surface);
}

/* A worn cylinder stays where only the sphere is asked for. */
static void test_sphere_alone_leaves_the_cylinder(void **state) {
  (void)state;
  placido_surface *surface = toric(7.849, 7.5, -0.25, 30);
  placido_eye eye = {.pupil_mm = 4, .retina_mm = 30, .correct = PLACIDO_CORRECT_SPHERE,
                     .correction = placido_correction_of(0, -2, 30)};
  placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
  assert_true(psf.correction.j0_D == eye.correction.j0_D);
  assert_true(psf.correction.j45_D == eye.correction.j45_D);
  assert_true(psf.strehl_g > 0.1); /* the cylinder is right: the sphere makes it sharp */
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

/* Nothing is searched where nothing is asked for and the retina is given. */
static void test_no_correction_leaves_everything(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26);
  placido_eye eye = {.pupil_mm = 4, .retina_mm = 29, .correction = {-1, 0.25, 0.5}};
  placido_psf psf = psf_of(surface, &eye, &(placido_optics){.samples = 50});
  assert_true(psf.retina_mm == 29 && psf.correction.m_D == -1);
  assert_true(psf.correction.j0_D == 0.25 && psf.correction.j45_D == 0.5);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

/* Coma leaves the sharp tip of its tail where the pupil's middle sends the light: off the axis by
 * (n - 1) times the tilt of the sag there, -2 √8 c / r for a term of c over the radius r. With a
 * lens that suits a part beside the middle the peak lies farther out, never nearer to the axis. */
static void test_peak_of_coma_is_off_the_axis(void **state) {
  (void)state;
  double n = 1.3375, coma_um = 3, radius_mm = 4.5;
  double tilt = -2 * sqrt(8) * coma_um / 1000 / radius_mm;
  double expected_arcmin = (n - 1) * tilt / PLACIDO_ARCMIN_RAD;
  assert_true(fabs(expected_arcmin) > 4); /* six widths of the profile */
  for (int side = -1; side <= 1; side += 2) {
    placido_surface *surface = comatic(n, side * coma_um);
    placido_eye eye = {.pupil_mm = 6, .correct = PLACIDO_CORRECT_FULL};
    placido_psf psf = psf_of(surface, &eye, &(placido_optics){0});
    double arcmin_um = psf.bucket_um / psf.bucket_arcmin;
    assert_near(psf.centre_x_um / arcmin_um, 0, 0.05);
    double off = fabs(psf.centre_y_um / arcmin_um / expected_arcmin);
    assert_true(off > 0.9 && off < 2);
    assert_true((psf.centre_y_um > 0) == (side * expected_arcmin < 0));
    placido_psf_free(&psf);
    placido_surface_free(surface);
  }
}

/* Through a pinhole everything is nearly sharp: the top is flat, and still found. */
static void test_tiny_pupils_are_refracted(void **state) {
  (void)state;
  double paraxial_D = 1000 * 0.3375 / 7.8;
  for (double pupil_mm = 0.3; pupil_mm < 0.55; pupil_mm += 0.1) {
    placido_surface *sphere = conic(7.8, -0.26), *cylinder = toric(7.849, 7.5, -0.25, 30);
    placido_eye eye = {.pupil_mm = pupil_mm, .correct = PLACIDO_CORRECT_FULL};
    placido_psf round = psf_of(sphere, &eye, &(placido_optics){.samples = 40});
    assert_near(1337.5 / round.retina_mm, paraxial_D, 0.02);
    assert_near(hypot(round.correction.j0_D, round.correction.j45_D), 0, 0.01);
    placido_psf toric_psf = psf_of(cylinder, &eye, &(placido_optics){.samples = 40});
    double j = 337.5 / 2 * (1 / 7.5 - 1 / 7.849);
    assert_near(toric_psf.correction.j0_D, j * cos(acos(-1) / 3), 0.01);
    assert_near(toric_psf.correction.j45_D, j * sin(acos(-1) / 3), 0.01);
    placido_psf_free(&round);
    placido_psf_free(&toric_psf);
    placido_surface_free(sphere);
    placido_surface_free(cylinder);
  }
}

static void test_what_has_no_focus_is_refused(void **state) {
  (void)state;
  placido_surface *plane = flat(), *dome = conic(7.8, -0.26);
  placido_eye eye = {.pupil_mm = 4, .correct = PLACIDO_CORRECT_FULL};
  placido_psf psf;
  placido_error err = {0};
  assert_int_equal(placido_psf_new(&psf, NULL, plane, &eye, &(placido_optics){0}, NULL, &err),
                   PLACIDO_QUALITY);
  assert_string_equal(err.text, "no focus: within its pupil of 4 mm the cornea has no power of 5 to "
                                "300 D");
  eye.retina_mm = 6;
  assert_int_equal(placido_psf_new(&psf, NULL, dome, &eye, &(placido_optics){0}, NULL, &err),
                   PLACIDO_QUALITY);
  assert_string_equal(err.text, "no lens of up to 40 D focuses this cornea on a retina 6 mm behind "
                                "it");
  eye.correct = (enum placido_correct)7;
  assert_int_equal(placido_psf_new(&psf, NULL, dome, &eye, &(placido_optics){0}, NULL, &err),
                   PLACIDO_INPUT);
  placido_surface_free(plane);
  placido_surface_free(dome);
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
    cmocka_unit_test(test_sphere_is_found_for_a_given_retina),
    cmocka_unit_test(test_both_kinds_of_sphere_agree),
    cmocka_unit_test(test_sphere_alone_leaves_the_cylinder),
    cmocka_unit_test(test_no_correction_leaves_everything),
    cmocka_unit_test(test_peak_of_coma_is_off_the_axis),
    cmocka_unit_test(test_tiny_pupils_are_refracted),
    cmocka_unit_test(test_what_has_no_focus_is_refused),
  };
  return cmocka_run_group_tests_name("simulate_focus", tests, NULL, NULL);
}
