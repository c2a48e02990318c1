/* Pupils from the least to beyond the cornea: where rays meet, miss or graze, and what has no
 * focus.
 *
 * Shares of rays are areas but for the cells of the pattern that a border crosses: rays stand in
 * squares of diagonal 2 h, h being half the distance of neighbours, so that a border of length l
 * misplaces at most l 2 h of the pupil's area, and so does the pupil's rim. */
#include "simulate/eye.h"
#include "tests/simulate/eyes.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"
#include "tests/support/near.h"

#include <placido/diffraction.h>

#include <float.h>
#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double n_eye = PLACIDO_EYE_INDEX;

#ifdef __SANITIZE_ADDRESS__
enum { SAMPLES = 400 };
#else
enum { SAMPLES = 1500 };
#endif

static double focus_mm(double radius_mm) { return n_eye * radius_mm / (n_eye - 1); }

/* The depth of the focus comes from the cosine of the rays, whose standard deviation over a pupil
 * of radius r is (r / f)² / (4 sqrt 3): paths that round by 4 epsilon n f leave 4 epsilon f over
 * that. The search ends below that, or below 1e-9 mm. */
static void tiny_pupils_have_the_focus_of_wide_ones(void **state) {
  (void)state;
  const double radii_mm[] = {5, 7.8, 12, 40}, pupils_mm[] = {0.1, 0.3, 1, 4, 8};
  for (int k = 0; k < 4; k++) {
    placido_surface *surface = conic(radii_mm[k], -1 / (n_eye * n_eye));
    for (int i = 0; i < 5; i++) {
      const placido_eye eye = {.pupil_mm = pupils_mm[i]};
      placido_wavefront w;
      placido_error err = {0};
      if (placido_wavefront_new(&w, surface, &eye, NULL, NULL, &err) != PLACIDO_OK) {
        fail_msg("R %g mm, pupil %g mm: %s", radii_mm[k], pupils_mm[i], err.text);
      }
      double f = focus_mm(radii_mm[k]), sine = pupils_mm[i] / 2 / f;
      double condition = 4 * sqrt(3) / (sine * sine);
      case_bounded(&(struct bounded){condition, 4 * DBL_EPSILON, NULL, fabs(w.focus_mm[2] - f),
                                     "mm", 1e-9 + 2 * 4 * DBL_EPSILON * f * condition},
                   "focus of R %g mm, pupil %g mm", radii_mm[k], pupils_mm[i]);
      placido_wavefront_free(&w);
    }
    placido_surface_free(surface);
  }
}

/* The ellipsoid of Q = -1/n² sends all rays to one point, within epsilon of the way: on a retina
 * that stands there no light falls beside one bucket, however small, and no share is rounded. */
static void exact_focus_is_one_bucket(void **state) {
  (void)state;
  const double pupils_mm[] = {0.1, 0.3, 8.9}, buckets_arcmin[] = {0.01, 0.5, 60};
  placido_surface *surface = conic(7.8, -1 / (n_eye * n_eye));
  for (int i = 0; i < 9; i++) {
    const placido_eye eye = {.pupil_mm = pupils_mm[i / 3], .retina_mm = focus_mm(7.8)};
    const placido_optics optics = {.samples = 100, .bucket_arcmin = buckets_arcmin[i % 3]};
    placido_psf psf = psf_of(surface, &eye, &optics);
    double beside = 0;
    for (int k = 0; k < psf.n * psf.n; k++) {
      beside += k == psf.n * psf.n / 2 ? 0 : psf.values[k];
    }
    assert_true(psf.strehl_g == 1 && psf.outside == 0 && psf.rays_missed == 0);
    case_bounded(&(struct bounded){1, DBL_EPSILON, NULL,
                                   beside + fabs(psf.values[psf.n * psf.n / 2] - 1), NULL, 0},
                 "exact focus, pupil %g mm, bucket %g'", pupils_mm[i / 3], buckets_arcmin[i % 3]);
    placido_psf_free(&psf);
  }
  placido_surface_free(surface);
}

/* The part of a pupil of radius a, at a distance d from its middle, that a disc of radius r has. */
static double common_share(double a, double d, double r) {
  if (d + a <= r) {
    return 1;
  }
  if (d == 0) {
    return r * r / (a * a);
  }
  double lens = a * a * acos((d * d + a * a - r * r) / (2 * d * a)) +
                r * r * acos((d * d + r * r - a * a) / (2 * d * r)) -
                sqrt((a + r - d) * (d + a - r) * (d - a + r) * (d + a + r)) / 2;
  return lens / (pi * a * a);
}

/* A bound of a share as the head of this file has it: its border is no longer than the pupil's rim;
 * the rim changes what it is a share of. */
static double misplaced(double pupil_mm, double share) {
  double a = pupil_mm / 2, h = a / (SAMPLES - 1), rim_mm = share > 0 ? (1 + share) * 2 * pi * a : 0;
  return rim_mm * 2 * h / (pi * a * a);
}

/* Few buckets: it is the rays that count here. */
static const placido_optics counting = {.samples = SAMPLES, .buckets = 33, .grow = 1};

/* Wherever rays go, they are counted: none is lost silently. */
static void count_all(const placido_psf *psf) {
  double sum = 0;
  for (int i = 0; i < psf->n * psf->n; i++) {
    assert_true(psf->values[i] >= 0);
    sum += psf->values[i];
  }
  assert_near(sum + psf->outside, 1, 1e-9); /* rounding of at most a million shares */
  assert_true(psf->rays_landed <= psf->rays_entered);
}

static void rays_beyond_the_cornea_are_counted(void **state) {
  (void)state;
  const struct {
    double pupil_mm, x_mm, y_mm;
  } pupils[] = {{9, 0, 0}, {9.1, 0, 0}, {7, 1.2, 0}, {7, 0.9, -0.9}, {0.3, 4.34, 0}};
  placido_surface *surface = conic(7.8, -0.26); /* to 4.5 mm */
  for (int i = 0; i < 5; i++) {
    const placido_eye eye = {.pupil_mm = pupils[i].pupil_mm,
                             .pupil_x_mm = pupils[i].x_mm,
                             .pupil_y_mm = pupils[i].y_mm};
    placido_psf psf = psf_of(surface, &eye, &counting);
    double share = 1 - common_share(pupils[i].pupil_mm / 2, hypot(pupils[i].x_mm, pupils[i].y_mm),
                                    4.5);
    double missed = (double)psf.rays_missed / (double)(psf.rays_missed + psf.rays_entered);
    count_all(&psf);
    case_bounded(&(struct bounded){NAN, share, NULL, fabs(missed - share), NULL,
                                   misplaced(pupils[i].pupil_mm, share)},
                 "rays missed, pupil %g mm at (%g, %g)", pupils[i].pupil_mm, pupils[i].x_mm,
                 pupils[i].y_mm);
    placido_psf_free(&psf);
  }
  const placido_eye beyond[] = {{.pupil_mm = 9.4}, {.pupil_mm = 7, .pupil_x_mm = 2}};
  for (int i = 0; i < 2; i++) {
    placido_psf psf;
    placido_error err = {0};
    int status =
      placido_psf_new(&psf, NULL, surface, &beyond[i], &(placido_optics){0}, NULL, &err);
    case_refused(status, PLACIDO_QUALITY, &err, "fills only", "pupil %g mm at (%g, 0)",
                 beyond[i].pupil_mm, beyond[i].pupil_x_mm);
  }
  placido_surface_free(surface);
}

/* A spline ends with its knots: a square of 6 mm, of which a pupil of radius a takes four segments
 * away. */
static void rays_beside_a_spline_are_counted(void **state) {
  (void)state;
  static const double knots_mm[] = {-3, -3, -3, -3, 0, 3, 3, 3, 3}, flat_mm[25] = {0};
  placido_part parts[2] = {{.kind = PLACIDO_PART_BICONIC}, {.kind = PLACIDO_PART_BSPLINE}};
  parts[0].as.biconic.r1 = parts[0].as.biconic.r2 = 7.8;
  parts[1].as.bspline.degree = 3;
  parts[1].as.bspline.columns = parts[1].as.bspline.rows = 5;
  parts[1].as.bspline.knots_x_mm = parts[1].as.bspline.knots_y_mm = knots_mm;
  parts[1].as.bspline.coefficients_mm = flat_mm;
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, parts, 2, NULL, NULL), PLACIDO_OK);
  const double pupils_mm[] = {6, 6.2, 6.4};
  for (int i = 0; i < 3; i++) {
    double k = 6 / pupils_mm[i], segment = (acos(k) - k * sqrt(1 - k * k)) / pi;
    const placido_eye eye = {.pupil_mm = pupils_mm[i]};
    placido_psf psf = psf_of(surface, &eye, &counting);
    double missed = (double)psf.rays_missed / (double)(psf.rays_missed + psf.rays_entered);
    count_all(&psf);
    case_bounded(&(struct bounded){NAN, 4 * segment, NULL, fabs(missed - 4 * segment), NULL,
                                   misplaced(pupils_mm[i], 4 * segment)},
                 "rays missed beside a spline of 6 mm, pupil %g mm", pupils_mm[i]);
    placido_psf_free(&psf);
  }
  placido_surface_free(surface);
}

/* A sphere of R meets a ray at the sine r / R: beyond that of 80 degrees it grazes. */
static void grazing_rays_are_counted(void **state) {
  (void)state;
  const double radius_mm = 4, pupils_mm[] = {7.8, 7.9, 7.99};
  const double limit_mm = radius_mm * sin(80 * pi / 180);
  placido_surface *surface = conic(radius_mm, 0);
  for (int i = 0; i < 3; i++) {
    const placido_eye eye = {.pupil_mm = pupils_mm[i]};
    placido_psf psf = psf_of(surface, &eye, &counting);
    double reach = fmin(limit_mm / (pupils_mm[i] / 2), 1), share = 1 - reach * reach;
    double grazed = (double)psf.rays_grazed / (double)(psf.rays_missed + psf.rays_entered);
    count_all(&psf);
    case_bounded(&(struct bounded){NAN, share, NULL, fabs(grazed - share), NULL,
                                   misplaced(pupils_mm[i], share)},
                 "rays grazing a sphere of 4 mm, pupil %g mm", pupils_mm[i]);
    placido_psf_free(&psf);
  }
  placido_surface_free(surface);
}

/* Where a ray enters a sphere that reaches the focus by a direction of this sine: between the axis
 * and the equator, halved until nothing is left between. */
static long double entry_mm(long double radius_mm, long double focus, long double sine) {
  long double low = 0, high = radius_mm;
  for (int i = 0; i < 100; i++) {
    long double r = (low + high) / 2, depth = radius_mm - sqrtl(radius_mm * radius_mm - r * r);
    long double found = r / hypotl(r, focus - depth);
    *(found < sine ? &low : &high) = r;
  }
  return (low + high) / 2;
}

/* Each sample of a pupil belongs to a direction, and its ray's entry is sought until its way is
 * known to 1e-5 mm, across by the sine s of that; the path changes by its slope along the surface.
 * Rounding of a path is 4 epsilon of it. */
static void steep_corneas_lose_no_sample_of_a_wave(void **state) {
  (void)state;
  const struct {
    double radius_mm, pupil_mm;
  } eyes[] = {{7.8, 8}, {5, 8}, {5, 8.9}, {4.5, 8.8}, {2, 3.9}};
  for (int k = 0; k < 5; k++) {
    const double radius_mm = eyes[k].radius_mm, f = 0.93 * focus_mm(radius_mm);
    placido_surface *surface = conic(radius_mm, 0);
    placido_pupil pupil;
    const placido_eye eye = {.pupil_mm = eyes[k].pupil_mm};
    const double focus[3] = {0, 0, f};
    assert_int_equal(placido_pupil_of_surface(&pupil, surface, &eye, focus, 1, NULL), PLACIDO_OK);
    double worst_um = 0, bound_um = 0, middle = (pupil.n - 1) / 2.0;
    for (int row = 0; row < pupil.n; row += 3) {
      for (int column = 0; column < pupil.n; column += 3) {
        double place_mm = hypot(column - middle, row - middle) * pupil.spacing_mm, s = place_mm / f;
        if (place_mm > pupil.pupil_mm / 2 * (1 - 1e-9)) {
          continue;
        }
        long double r = entry_mm(radius_mm, f, s);
        long double depth = radius_mm - sqrtl((long double)radius_mm * radius_mm - r * r);
        long double way = hypotl(r, f - depth), tilt = r / (radius_mm - depth);
        double path_um = (double)(1000 * (n_eye * f - depth - n_eye * way));
        double slope = (double)fabsl(tilt + n_eye * (r - (f - depth) * tilt) / way);
        worst_um = fmax(worst_um, fabs(pupil.opd_um[row * pupil.n + column] - path_um));
        assert_false(isnan(pupil.opd_um[row * pupil.n + column]));
        bound_um = fmax(bound_um, 1e3 * (1e-5 * s * slope + 4 * DBL_EPSILON * n_eye * f));
      }
    }
    case_bounded(&(struct bounded){NAN, 1e-5, "mm", worst_um, "um", bound_um},
                 "paths of R %g mm, pupil %g mm", radius_mm, eyes[k].pupil_mm);
    placido_pupil_free(&pupil);
    placido_surface_free(surface);
  }
}

/* What bends light too little, apart, or not by Snell's law into an eye. */
static void what_has_no_focus_is_refused(void **state) {
  (void)state;
  placido_part hollow = {.kind = PLACIDO_PART_ZERNIKE};
  hollow.as.zernike.radius_mm = 4.5;
  hollow.as.zernike.coefficients_um[4] = -200;
  placido_surface *surfaces[] = {flat(), conic(200, 0), NULL, conic(7.8, 0)};
  const char *const names[] = {"a plane", "R 200 mm", "a hollow", "index 0.9"};
  assert_int_equal(placido_surface_new(&surfaces[2], 0, 4.5, &hollow, 1, NULL, NULL), PLACIDO_OK);
  for (int i = 0; i < 4; i++) {
    const bool thin = i == 3; /* no eye: a ray would be reflected totally within it */
    for (int waves = 0; waves < 3; waves++) {
      const placido_eye eye = {.pupil_mm = 0.3 + 2 * waves, .index = thin ? 0.9 : 0};
      placido_psf psf;
      placido_wavefront w;
      placido_error err = {0};
      int status =
        waves == 2
          ? placido_wavefront_new(&w, surfaces[i], &eye, NULL, NULL, &err)
          : placido_psf_new(&psf, NULL, surfaces[i], &eye,
                            &(placido_optics){.wavelength_nm = waves ? 555 : 0}, NULL, &err);
      case_refused(status, thin ? PLACIDO_INPUT : PLACIDO_QUALITY, &err,
                   thin ? "refractive index is 0.9" : "no focus", "%s, %s", names[i],
                   waves == 2 ? "wavefront" : waves ? "diffraction" : "rays");
    }
    placido_surface_free(surfaces[i]);
  }
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Optics: pupils, borders and grazing rays"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(tiny_pupils_have_the_focus_of_wide_ones),
    cmocka_unit_test(exact_focus_is_one_bucket),
    cmocka_unit_test(rays_beyond_the_cornea_are_counted),
    cmocka_unit_test(rays_beside_a_spline_are_counted),
    cmocka_unit_test(grazing_rays_are_counted),
    cmocka_unit_test(steep_corneas_lose_no_sample_of_a_wave),
    cmocka_unit_test(what_has_no_focus_is_refused),
    cmocka_unit_test(the_table_is_good)};
  return cmocka_run_group_tests_name("stability_optics_pupils", tests, NULL, NULL);
}
