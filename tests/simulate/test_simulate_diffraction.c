/* Diffraction images against closed forms and against images computed by other means: by polar
 * quadrature to 16 digits, each checked by a second method. */
#include "base/memory.h"
#include "diffracted.h"
#include "eyes.h"
#include "simulate/wavefront.h"
#include "tests/support/near.h"

#include <placido/diffraction.h>
#include <placido/quality.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double *green_image(double pupil_mm, const double *terms_um, int count,
                           const placido_window *window) {
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  placido_pupil pupil = pupil_of(pupil_mm, terms_um, count);
  double *values = image_of(&pupil, &wave, 1, window, NULL);
  placido_pupil_free(&pupil);
  return values;
}

/* What a bucket receives of a perfect pupil's peak: area of pupil × bucket / wavelength². */
static double ideal(double pupil_mm, double bucket_arcmin, double wavelength_nm) {
  double bucket_mm = bucket_arcmin * arcmin_rad / (1e-6 * wavelength_nm);
  return pi / 4 * pupil_mm * pupil_mm * bucket_mm * bucket_mm;
}

/* Buckets of the aberrated eye (right, down: the reference counts angles the other way), in units
 * of the perfect peak, against polar quadrature; the sampled rim is worth 1e-4 of the peak. */
static void buckets_are_integrals(void **state) {
  (void)state;
  static const int places[7][2] = {{0, 0}, {0, 1}, {1, 2}, {-2, -1}, {3, -4}, {-4, 5}, {-5, -5}};
  static const struct { double pupil_mm, strehl[7], tolerance; } cases[] = {
    {2, {0.017769857152, 0.068957760731, 0.15259072423, 0.064977057453, 0.0033460945687,
         0.0030114134661, 0.0057488666528}, 1e-4},
    {4, {0.024510242283, 0.10078229574, 0.074185847839, 0.018899730414, 0.002239085653,
         0.00016877242148, 0.0029606946863}, 3e-5},
    {8, {0.041325668133, 0.044560884032, 0.00087273127947, 0.0041903623668, 0.00047428816635,
         1.7647137634e-05, 0.00069025900367}, 3e-6}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const placido_window window = {0};
    double *values = green_image(cases[c].pupil_mm, eye_um, 15, &window);
    double peak = ideal(cases[c].pupil_mm, 0.5, green_nm);
    for (int k = 0; k < 7; k++) {
      double value = values[(MIDDLE + places[k][1]) * SIDE + MIDDLE + places[k][0]] / peak;
      assert_near(value, cases[c].strehl[k], cases[c].tolerance);
    }
    free(values);
  }
}

static void brightest_bucket_has_its_share(void **state) {
  (void)state;
  static const struct { double pupil_mm, share; } cases[] = {
    {2, 0.03292185394}, {4, 0.08697619169}, {8, 0.1538260649}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const placido_window window = {0};
    double *values = green_image(cases[c].pupil_mm, eye_um, 15, &window);
    assert_near(values[fullest(values, SIDE)] / cases[c].share, 1, 3e-4);
    free(values);
  }
}

/* Half a minute is too coarse for points above a pupil of 2 mm: by so much a sample in the
 * brightest bucket's middle is beside that bucket's light. */
static void points_are_not_buckets(void **state) {
  (void)state;
  static const struct { double pupil_mm, ratio, point; } cases[] = {
    {2, 1.0646027563628186, 0.16244850561065674}, {4, 1.2362841095428128, 0.12459555074660632},
    {8, 0.7928721219572148, 0.03533108267887223}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const placido_window buckets = {0}, points = {.points = true};
    double *whole = green_image(cases[c].pupil_mm, eye_um, 15, &buckets);
    double *sampled = green_image(cases[c].pupil_mm, eye_um, 15, &points);
    double sample = sampled[fullest(sampled, SIDE)];
    double ratio = sample / whole[fullest(whole, SIDE)];
    assert_near(ratio, cases[c].ratio, 1e-3);
    assert_near(sample / ideal(cases[c].pupil_mm, 0.5, green_nm), cases[c].point, 1e-4);
    free(whole);
    free(sampled);
  }
}

/* (2 J1(x) / x)² at half a minute, and what the middle bucket catches. */
static void perfect_pupil_has_airy_pattern(void **state) {
  (void)state;
  static const struct { double pupil_mm, half_minute, bucket; } cases[] = {
    {2, 0.486214559798, 0.192917835403},
    {3, 0.166823172175, NAN},
    {4, 0.0184198467797, 0.559960287196},
    {6, 0.0168087669397, NAN},
    {8, 0.00153397604655, 0.836848193357}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const placido_window buckets = {0}, points = {.points = true};
    double *values = green_image(cases[c].pupil_mm, perfect_um, 1, &points);
    double peak = ideal(cases[c].pupil_mm, 0.5, green_nm);
    assert_near(values[MIDDLE * SIDE + MIDDLE] / peak, 1, 3e-4);
    assert_near(values[MIDDLE * SIDE + MIDDLE + 1] / peak, cases[c].half_minute, 3e-4);
    assert_near(values[(MIDDLE - 1) * SIDE + MIDDLE] / peak, cases[c].half_minute, 3e-4);
    free(values);
    if (!isnan(cases[c].bucket)) {
      values = green_image(cases[c].pupil_mm, perfect_um, 1, &buckets);
      assert_near(values[MIDDLE * SIDE + MIDDLE], cases[c].bucket, 3e-4);
      free(values);
    }
  }
}

/* The first dark ring: 1.16353425 arcmin behind 2 mm. */
static void first_ring_is_dark(void **state) {
  (void)state;
  const placido_window window = {.buckets = 3, .bucket_arcmin = 1.16353425386, .points = true};
  double *values = green_image(2, perfect_um, 1, &window);
  assert_true(values[4 + 1] / values[4] < 1e-6);
  assert_true(values[4 + 3] / values[4] < 1e-6);
  free(values);
}

static void strehl_ratio_is_on_the_axis_and_at_the_peak(void **state) {
  (void)state;
  static const double pupils_mm[] = {2, 4, 8};
  for (size_t c = 0; c < 3; c++) {
    double peak, at[2], x = 0.98101457278690 / pupils_mm[c], y = 2.30935113156 / pupils_mm[c];
    const placido_window points = {.points = true};
    double *values = green_image(pupils_mm[c], eye_um, 15, &points);
    double on_axis = values[MIDDLE * SIDE + MIDDLE] / ideal(pupils_mm[c], 0.5, green_nm);
    assert_near(on_axis, 0.01531701858, 1e-5);
    free(values);
    placido_pupil pupil = pupil_of(pupils_mm[c], eye_um, 15);
    assert_int_equal(placido_strehl_peak(&peak, at, &pupil, green_nm, NULL), PLACIDO_OK);
    placido_pupil_free(&pupil);
    assert_near(peak, 0.1697799515, 2e-4); /* a parabola through samples an eighth apart */
    assert_near(at[0], x, 0.02 / pupils_mm[c]);
    assert_near(at[1], y, 0.02 / pupils_mm[c]);
  }
}

/* Single aberrations of so many wavelengths rms, by quadrature over the pupil, checked by closed
 * forms. */
static void strehl_ratio_of_one_aberration(void **state) {
  (void)state;
  static const double waves[5] = {0.02, 0.05, 0.0714, 0.1, 0.2};
  static const struct { int term; double strehl[5]; } cases[] = {
    {4, {0.984308043047, 0.905118989579, 0.814262405938, 0.662551634211, 0.142650876385}},
    {5, {0.984326535664, 0.905799599183, 0.816889799037, 0.67131929479, 0.197009757008}},
    {7, {0.984322712211, 0.905657412268, 0.816333756918, 0.669417035376, 0.182854300585}},
    {9, {0.984341487911, 0.906346599997, 0.818987141931, 0.678244704942, 0.24125931708}},
    {12, {0.984315126126, 0.905387261774, 0.815336026621, 0.666393184203, 0.181637660118}}};
  enum { RINGS = 24, COUNT = 3 * RINGS * RINGS };
  static double x[COUNT], y[COUNT], weight[COUNT], opd_um[COUNT], terms[15 * COUNT];
  placido_disc_quadrature(x, y, weight, RINGS);
  placido_zernike_terms(terms, 4, x, y, COUNT);
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    for (int k = 0; k < 5; k++) {
      double rms_um = 1e-3 * green_nm * waves[k];
      for (int i = 0; i < COUNT; i++) {
        opd_um[i] = rms_um * terms[cases[c].term * COUNT + i];
      }
      double strehl = placido_strehl(opd_um, NULL, weight, COUNT, green_nm);
      assert_near(strehl, cases[c].strehl[k], 1e-9);
      double estimate = placido_strehl_marechal(rms_um, green_nm);
      assert_true(strehl < 0.66 || fabs(estimate - strehl) < 0.012);
    }
  }
  assert_near(placido_strehl_marechal(0.05 * 0.555, 555), 0.906018055788923, 1e-12);
}

/* sinc²(D r² / (2 wavelength)): a perfect eye out of focus. */
static void defocus_lowers_strehl_ratio(void **state) {
  (void)state;
  static const struct { double defocus_D, pupil_mm, strehl; } cases[] = {
    {0.125, 4, 0.487348739708}, {0.25, 2, 0.843867181091}, {0.25, 4, 0.0117140835324},
    {0.5, 2, 0.487348739708}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const placido_window points = {.points = true};
    placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
    wave.defocus_D = cases[c].defocus_D;
    placido_pupil pupil = pupil_of(cases[c].pupil_mm, perfect_um, 1);
    double *values = image_of(&pupil, &wave, 1, &points, NULL);
    double strehl = values[MIDDLE * SIDE + MIDDLE] / ideal(cases[c].pupil_mm, 0.5, green_nm);
    assert_near(strehl, cases[c].strehl, 2e-4);
    placido_pupil_free(&pupil);
    free(values);
  }
}

/* The Strehl ratio in the middle of white light with Thibos's chromatic focus; every wavelength
 * against its own peak, and all together with the energy of each. */
static void white_strehl(const placido_pupil *pupil, const placido_wave *waves, size_t count,
                         double *own, double *energy) {
  double ideals = 0, weights = 0;
  const placido_window window = {.buckets = 3, .points = true};
  double *values = image_of(pupil, waves, count, &window, NULL);
  *energy = values[4];
  *own = 0;
  free(values);
  for (size_t i = 0; i < count; i++) {
    double peak = ideal(pupil->pupil_mm, 0.5, waves[i].wavelength_nm);
    values = image_of(pupil, &waves[i], 1, &window, NULL);
    *own += values[4] / peak;
    ideals += waves[i].weight * peak;
    weights += waves[i].weight;
    free(values);
  }
  *energy /= ideals;
  *own /= weights;
}

static void seven_wavelengths_agree_with_quadrature(void **state) {
  (void)state;
  placido_pupil pupil = pupil_of(4, eye_um, 15);
  placido_wave waves[7];
  for (int i = 0; i < 7; i++) {
    double wavelength_nm = 400 + 50 * i, from_peak = (wavelength_nm - 555) / 60;
    waves[i] = (placido_wave){.wavelength_nm = wavelength_nm,
                              .weight = exp(-from_peak * from_peak),
                              .defocus_D = placido_chromatic_defocus(wavelength_nm, 555)};
  }
  double own, energy;
  white_strehl(&pupil, waves, 7, &own, &energy);
  assert_near(own, 0.01437533839, 1e-5);
  assert_near(energy, 0.01364268603, 1e-5);
  placido_pupil_free(&pupil);
}

/* Between few wavelengths focus beats: seven are far off, fifteen are not. */
static void fifteen_wavelengths_are_enough(void **state) {
  (void)state;
  static const size_t counts[3] = {7, 15, 121};
  placido_pupil pupil = pupil_of(4, eye_um, 15);
  placido_wave waves[121];
  double energy[3];
  for (int c = 0; c < 3; c++) {
    const placido_window window = {.buckets = 3, .points = true};
    double peak = 0;
    assert_int_equal(placido_waves_white(waves, counts[c], 400, 700, 555, NULL), PLACIDO_OK);
    for (size_t i = 0; i < counts[c]; i++) {
      peak += waves[i].weight * ideal(4, 0.5, waves[i].wavelength_nm);
    }
    double *values = image_of(&pupil, waves, counts[c], &window, NULL);
    energy[c] = values[4] / peak;
    free(values);
  }
  assert_true(fabs(energy[0] / energy[2] - 1) > 0.1);
  assert_true(fabs(energy[1] / energy[2] - 1) < 1e-3);
  placido_pupil_free(&pupil);
}

/* Twice the wavelength: the peak has a quarter of the light. */
static void energy_goes_with_the_wavelength(void **state) {
  (void)state;
  const placido_window points = {.points = true};
  const placido_wave blue = {.wavelength_nm = 400, .weight = 1}, red = {.wavelength_nm = 800,
                                                                       .weight = 1};
  placido_pupil pupil = pupil_of(3, perfect_um, 1);
  double *short_waves = image_of(&pupil, &blue, 1, &points, NULL);
  double *long_waves = image_of(&pupil, &red, 1, &points, NULL);
  size_t at = MIDDLE * SIDE + MIDDLE;
  assert_near(short_waves[at] / long_waves[at], 4, 2e-3);
  free(short_waves);
  free(long_waves);
  placido_pupil_free(&pupil);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(buckets_are_integrals),
    cmocka_unit_test(brightest_bucket_has_its_share),
    cmocka_unit_test(points_are_not_buckets),
    cmocka_unit_test(perfect_pupil_has_airy_pattern),
    cmocka_unit_test(first_ring_is_dark),
    cmocka_unit_test(strehl_ratio_is_on_the_axis_and_at_the_peak),
    cmocka_unit_test(strehl_ratio_of_one_aberration),
    cmocka_unit_test(defocus_lowers_strehl_ratio),
    cmocka_unit_test(seven_wavelengths_agree_with_quadrature),
    cmocka_unit_test(fifteen_wavelengths_are_enough),
    cmocka_unit_test(energy_goes_with_the_wavelength),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
