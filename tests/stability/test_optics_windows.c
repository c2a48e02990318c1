/* Point spread functions at the limits of what they are given: surfaces with an edge or a step,
 * windows far too small, wavelengths and pupils at their ends, light in one corner; and Zernike
 * terms through points that do not determine them. */
#include "tests/simulate/aberrated.h"
#include "tests/simulate/eyes.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"
#include "tests/support/near.h"

#include "base/random.h"

#include <placido/acuity.h>
#include <placido/diffraction.h>

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A perfect cornea with ridges across x: each turns what is above its offset by its slope. */
static placido_surface *ridges(const double *offsets_mm, const double *slopes, int count) {
  const double n = PLACIDO_EYE_INDEX;
  placido_part parts[3] = {{.kind = PLACIDO_PART_BICONIC}};
  parts[0].as.biconic.r1 = parts[0].as.biconic.r2 = 7.8;
  parts[0].as.biconic.q1 = parts[0].as.biconic.q2 = -1 / (n * n);
  for (int i = 0; i < count; i++) {
    parts[1 + i].kind = PLACIDO_PART_RIDGE;
    parts[1 + i].as.ridge.slope = slopes[i];
    parts[1 + i].as.ridge.width_mm = 1e-4;
    parts[1 + i].as.ridge.offset_mm = offsets_mm[i];
  }
  placido_surface *surface;
  placido_error err = {0};
  if (placido_surface_new(&surface, 0, 4.5, parts, 1 + (size_t)count, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return surface;
}

/* The part of a unit disc beyond a chord at k. */
static double segment(double k) { return (acos(k) - k * sqrt(1 - k * k)) / pi; }

/* Light beside the middle image, which an edge sends there. Each cell of the pattern that the edge
 * crosses lights what lies between: they take up twice the distance of two rows of rays, and the
 * edge itself is soft for some 20 of its widths, of a chord that is at most 2 a. */
static void edges_and_steps_part_the_light(void **state) {
  (void)state;
  const double a = 2, slope = 0.01, row_mm = 2 * a / 399;
  const struct {
    const char *name;
    double offsets_mm[2], slopes[2];
    int count;
    double share;
  } rows[] = {{"an edge through the middle", {0}, {slope}, 1, 0.5},
              {"an edge at 0.5 mm", {0.5}, {slope}, 1, segment(0.25)},
              {"an edge at 1.9 mm", {1.9}, {slope}, 1, segment(0.95)},
              {"a step of 5 um", {0.2, 0.7}, {slope, -slope}, 2, segment(0.1) - segment(0.35)}};
  for (int i = 0; i < 4; i++) {
    placido_surface *surface = ridges(rows[i].offsets_mm, rows[i].slopes, rows[i].count);
    const double n = PLACIDO_EYE_INDEX;
    const placido_eye eye = {.pupil_mm = 2 * a, .retina_mm = n * 7.8 / (n - 1)};
    placido_psf psf = psf_of(surface, &eye, &(placido_optics){.buckets = 257, .grow = 1});
    double fixated = 0, sum = 0; /* the fixation is on either image */
    for (int row = psf.n / 2 - 6; row <= psf.n / 2 + 6; row++) {
      for (int column = 0; column < psf.n; column++) {
        fixated += psf.values[row * psf.n + column];
      }
    }
    for (int k = 0; k < psf.n * psf.n; k++) {
      sum += psf.values[k];
    }
    assert_near(sum + psf.outside, 1, 1e-9);
    double aside = sum - fixated, share = rows[i].share;
    double off = fmin(fabs(aside - share), fabs(aside + share - 1));
    case_bounded(&(struct bounded){NAN, slope, "rad", off, NULL,
                                   2 * a * rows[i].count * (2 * row_mm + 20 * 1e-4) / (pi * a * a)},
                 "light aside behind %s", rows[i].name);
    placido_psf_free(&psf);
    placido_surface_free(surface);
  }
}

/* Waves that do not know what to do with an edge say so; where they do, light is neither made nor
 * below 0. */
static void edges_are_sampled_or_refused(void **state) {
  (void)state;
  const double offset_mm = 0.5, slopes[] = {0.0005, 0.01, 1};
  for (int i = 0; i < 3; i++) {
    placido_surface *surface = ridges(&offset_mm, &slopes[i], 1);
    const placido_eye eye = {.pupil_mm = 4};
    const placido_optics optics = {.wavelength_nm = 555, .grow = 1};
    placido_psf psf;
    placido_error err = {0};
    int status = placido_psf_new(&psf, NULL, surface, &eye, &optics, NULL, &err);
    if (status != PLACIDO_OK) {
      case_refused(status, PLACIDO_QUALITY, &err, "", "waves at an edge of %g", slopes[i]);
    } else {
      double sum = 0, least = INFINITY;
      for (int k = 0; k < psf.n * psf.n; k++) {
        sum += psf.values[k];
        least = fmin(least, psf.values[k]);
      }
      assert_true(least >= 0 && isfinite(psf.strehl_g));
      /* Five transforms in single precision of 1024 by 1024, of light that is 1 in all. */
      case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, fmax(sum - 1, 0), NULL,
                                     5 * 20 * FLT_EPSILON},
                   "waves at an edge of %g: light made", slopes[i]);
    }
    placido_psf_free(&psf);
    placido_surface_free(surface);
  }
}

static double *image_of(double pupil_mm, double wavelength_nm, double bucket_arcmin,
                        double stretch) {
  enum { BUCKETS = 65 };
  double terms_um[15] = {[3] = 0.03, [4] = 0.1, [7] = -0.06, [12] = 0.05};
  double *values = calloc((size_t)BUCKETS * BUCKETS, sizeof *values);
  placido_pupil pupil;
  placido_error err = {0};
  assert_non_null(values);
  for (int i = 0; i < 15; i++) {
    terms_um[i] *= stretch;
  }
  assert_int_equal(placido_pupil_of_terms(&pupil, pupil_mm, terms_um, 15, 0, &err), PLACIDO_OK);
  const placido_wave wave = {.wavelength_nm = wavelength_nm, .weight = 1};
  const placido_window window = {.buckets = BUCKETS, .bucket_arcmin = bucket_arcmin};
  if (placido_diffraction(values, NULL, &pupil, &wave, 1, &window, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  placido_pupil_free(&pupil);
  return values;
}

/* Diffraction knows wavelength / pupil and path / wavelength only. Twice as large a pupil with half
 * as large buckets, and twice the wavelength with twice the paths and pupil, are the same numbers
 * but for powers of two, by which nothing is rounded. */
static void waves_scale(void **state) {
  (void)state;
  const struct {
    double pupil_mm, wavelength_nm, bucket_arcmin, stretch;
  } rows[] = {{0.15, 550, 4, 1}, {0.3, 550, 2, 1},   {1.2, 550, 0.5, 1}, {9.6, 550, 0.0625, 1},
              {2.4, 1100, 0.5, 2}, {0.6, 275, 0.5, 0.5}, {4.8, 8800, 2, 16}};
  double *same = image_of(1.2, 550, 0.5, 1);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    double *other =
      image_of(rows[i].pupil_mm, rows[i].wavelength_nm, rows[i].bucket_arcmin, rows[i].stretch);
    double worst = 0;
    for (int k = 0; k < 65 * 65; k++) {
      worst = fmax(worst, fabs(other[k] - same[k]));
    }
    case_bounded(&(struct bounded){1, NAN, NULL, worst, NULL, 0}, "%g mm, %g nm, buckets of %g'",
                 rows[i].pupil_mm, rows[i].wavelength_nm, rows[i].bucket_arcmin);
    free(other);
  }
  free(same);
}

static void limits_are_kept(void **state) {
  (void)state;
  const struct {
    const char *name, *words;
    double pupil_mm;
    placido_optics optics;
    int status;
  } rows[] = {
    {"299 nm", "wavelength", 4, {.wavelength_nm = 299}, PLACIDO_INPUT},
    {"1201 nm", "wavelength", 4, {.wavelength_nm = 1201}, PLACIDO_INPUT},
    {"a pupil of 0.09 mm", "pupil", 0.09, {0}, PLACIDO_INPUT},
    {"a pupil of 12.1 mm", "pupil", 12.1, {0}, PLACIDO_INPUT},
    {"NaN nm", "wavelength", 4, {.wavelength_nm = NAN}, PLACIDO_INPUT},
    {"NaN of a bucket", "bucket", 4, {.bucket_arcmin = NAN}, PLACIDO_INPUT},
    {"waves of a pupil of 0.1 mm", "choose wider ones", 0.1, {.wavelength_nm = 555}, PLACIDO_INPUT},
    {"buckets of 0.009'", "bucket", 4, {.bucket_arcmin = 0.009}, PLACIDO_INPUT},
    {"waves, 4095 buckets of 60'", "samples", 8,
     {.wavelength_nm = 300, .buckets = 4095, .bucket_arcmin = 60}, PLACIDO_QUALITY}};
  placido_surface *surface = conic(7.8, -0.26);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    const placido_eye eye = {.pupil_mm = rows[i].pupil_mm};
    placido_psf psf;
    placido_error err = {0};
    int status = placido_psf_new(&psf, NULL, surface, &eye, &rows[i].optics, NULL, &err);
    case_refused(status, rows[i].status, &err, rows[i].words, "%s", rows[i].name);
    assert_null(psf.values);
  }
  placido_surface_free(surface);
}

/* A blur of degrees in a window of seconds of arc: what is in it and what is not are all light.
 * Each share rounds by half a unit, and so does each of their sums. */
static void small_windows_lose_no_light(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, 0);
  const double buckets_arcmin[] = {0.01, 0.5, 60};
  for (int i = 0; i < 6; i++) {
    const placido_eye eye = {.pupil_mm = i < 3 ? 8.5 : 0.3, .retina_mm = i < 3 ? 20 : 50};
    const placido_optics optics = {
      .buckets = 3, .grow = 1, .samples = 100, .bucket_arcmin = buckets_arcmin[i % 3]};
    placido_psf psf;
    placido_error err = {0};
    int status = placido_psf_new(&psf, NULL, surface, &eye, &optics, NULL, &err);
    if (status != PLACIDO_OK) { /* the rays stand farther apart than the window is wide */
      assert_true(optics.bucket_arcmin < 1);
      case_refused(status, PLACIDO_QUALITY, &err, "no light lands within the PSF's",
                   "3 buckets of %g' in a blur, pupil %g mm", optics.bucket_arcmin, eye.pupil_mm);
      continue;
    }
    double sum = 0;
    for (int k = 0; k < psf.n * psf.n; k++) {
      assert_true(psf.values[k] >= 0);
      sum += psf.values[k];
    }
    case_bounded(&(struct bounded){1, DBL_EPSILON, NULL, fabs(sum + psf.outside - 1), NULL,
                                   (psf.n * psf.n + 2) * DBL_EPSILON},
                 "3 buckets of %g' in a blur, pupil %g mm", optics.bucket_arcmin, eye.pupil_mm);
    placido_psf_free(&psf);
  }
  placido_surface_free(surface);
}

/* An observer knows where the image is: in a corner it is as sharp as in the middle. A size is
 * found to within 5e-4. */
static void images_in_a_corner_are_read(void **state) {
  (void)state;
  placido_observer *observer;
  placido_acuity middle, corner;
  assert_int_equal(placido_observer_new(&observer, placido_acuity_test_find("e"), NULL, NULL),
                   PLACIDO_OK);
  placido_psf psf = dark(129, 0.5);
  put_spot(&psf, 0, 0, 1);
  assert_int_equal(placido_acuity_find(&middle, observer, &psf, NULL, 0, NULL), PLACIDO_OK);
  put_spot(&psf, 0, 0, -1);
  put_spot(&psf, 32, 32, 1);
  assert_int_equal(placido_acuity_find(&corner, observer, &psf, NULL, 0, NULL), PLACIDO_OK);
  assert_int_equal(middle.verdict, PLACIDO_ACUITY_FOUND);
  case_bounded(&(struct bounded){NAN, 45, "arcmin", fabs(middle.logmar - corner.logmar), "logMAR",
                                 2 * 5e-4},
               "acuity, all light in a corner");
  put_spot(&psf, 32, 32, -1); /* and now none */
  const struct {
    double light;
    const char *words;
  } rows[] = {{0, "sums to 0"}, {NAN, "is not light"}, {INFINITY, "sums to"}, {-1, "is not light"}};
  for (int i = 0; i < 4; i++) {
    placido_error err = {0};
    psf.values[77] = rows[i].light;
    int status = placido_acuity_find(&corner, observer, &psf, NULL, 0, &err);
    case_refused(status, PLACIDO_INPUT, &err, rows[i].words, "acuity, light of %g", rows[i].light);
    assert_true(isnan(corner.logmar));
  }
  placido_psf_free(&psf);
  placido_observer_free(observer);
}

enum { POINTS = 400, ORDER = 6, TERMS = 28 };

/* Where points stand in the unit disc. */
enum layout { DISC, SECTOR, RING, LINE, ONE_PLACE, FEW };

static size_t lay_out(double *x, double *y, enum layout layout) {
  for (int i = 0; i < POINTS; i++) {
    double a = placido_random_uniform(1, 0, (uint64_t)i, 0, 1);
    double b = placido_random_uniform(2, 0, (uint64_t)i, 0, 1);
    double radius = layout == RING ? 0.7 : layout == ONE_PLACE ? 0.3 : sqrt(a);
    double angle = layout == LINE || layout == ONE_PLACE ? 1
                   : layout == SECTOR                    ? 1.5 * pi * b
                                                         : 2 * pi * b;
    x[i] = radius * cos(angle);
    y[i] = radius * sin(angle);
  }
  return layout == FEW ? TERMS - 1 : POINTS;
}

/* Of z = A c the least-squares solution turns an error e of z into one of c of at most |e| / s, s
 * the least singular value, and |c| is at least |A c| / S with the largest: relative to |c| an
 * error grows by at most the condition S / s (Golub and Van Loan, Matrix Computations, 5.3.8). */
static void terms_grow_by_their_condition(void **state) {
  (void)state;
  static double x[POINTS], y[POINTS], z[POINTS], terms[TERMS * POINTS];
  const char *const names[] = {"the disc", "three quarters of it"};
  for (int k = 0; k < 2; k++) {
    size_t count = lay_out(x, y, k == 0 ? DISC : SECTOR);
    placido_zernike_fit plain, noisy;
    double signal = 0, noise = 0, change = 0, size = 0;
    placido_zernike_terms(terms, ORDER, x, y, count);
    for (size_t i = 0; i < count; i++) {
      z[i] = terms[4 * POINTS + i] - 0.3 * terms[12 * POINTS + i];
      signal += z[i] * z[i];
    }
    assert_int_equal(placido_zernike_fit_points(&plain, ORDER, x, y, z, NULL, count, NULL),
                     PLACIDO_OK);
    for (size_t i = 0; i < count; i++) {
      double e = 1e-6 * placido_random_normal(3, 0, (uint64_t)i);
      z[i] += e;
      noise += e * e;
    }
    assert_int_equal(placido_zernike_fit_points(&noisy, ORDER, x, y, z, NULL, count, NULL),
                     PLACIDO_OK);
    for (int j = 0; j < TERMS; j++) {
      change += pow(noisy.coefficients[j] - plain.coefficients[j], 2);
      size += pow(plain.coefficients[j], 2);
    }
    case_bounded(&(struct bounded){plain.condition, sqrt(noise / signal), NULL, sqrt(change / size),
                                   NULL, plain.condition * sqrt(noise / signal)},
                 "28 terms by 400 points over %s", names[k]);
  }
}

static void points_that_determine_nothing_are_refused(void **state) {
  (void)state;
  static double x[POINTS], y[POINTS], z[POINTS], weight[POINTS];
  const char *const names[] = {[RING] = "a ring", [LINE] = "a line", [ONE_PLACE] = "one place",
                               [FEW] = "27 points"};
  for (int k = RING; k <= FEW; k++) {
    placido_zernike_fit fit;
    placido_error err = {0};
    size_t count = lay_out(x, y, (enum layout)k);
    int status = placido_zernike_fit_points(&fit, ORDER, x, y, z, NULL, count, &err);
    case_refused(status, PLACIDO_QUALITY, &err, "do not determine", "28 terms by %s", names[k]);
  }
  const double bad[] = {NAN, INFINITY, -1, 0};
  const char *const none[] = {"weights of NaN", "weights of inf", "weights of -1",
                              "weights of 0",   "values of NaN",  "values of inf",
                              "places of NaN",  "places at 2 radii"};
  lay_out(x, y, DISC);
  for (int k = 0; k < 8; k++) {
    placido_zernike_fit fit;
    placido_error err = {0};
    for (int i = 0; i < POINTS; i++) {
      weight[i] = k < 4 ? bad[k] : 1;
      z[i] = k == 4 ? NAN : k == 5 ? INFINITY : 0;
      x[i] = k == 6 ? NAN : x[i];
      y[i] = k == 7 ? 2 : y[i];
    }
    int status = placido_zernike_fit_points(&fit, ORDER, x, y, z, weight, POINTS, &err);
    case_refused(status, PLACIDO_QUALITY, &err, "0 points", "28 terms, %s", none[k]);
  }
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Optics: edges, windows and waves"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(edges_and_steps_part_the_light),
    cmocka_unit_test(edges_are_sampled_or_refused),
    cmocka_unit_test(waves_scale),
    cmocka_unit_test(limits_are_kept),
    cmocka_unit_test(small_windows_lose_no_light),
    cmocka_unit_test(images_in_a_corner_are_read),
    cmocka_unit_test(terms_grow_by_their_condition),
    cmocka_unit_test(points_that_determine_nothing_are_refused),
    cmocka_unit_test(the_table_is_good)};
  return cmocka_run_group_tests_name("stability_optics_windows", tests, NULL, NULL);
}
