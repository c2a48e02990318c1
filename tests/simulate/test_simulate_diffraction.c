/* Diffraction images against closed forms and against images computed by other means: by polar
 * quadrature to 16 digits, each checked by a second method. */
#include "base/memory.h"
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

enum { SIDE = 257, MIDDLE = SIDE / 2 };

static const double pi = 3.14159265358979323846;
static const double arcmin_rad = 2.908882086657216e-4;
static const double green_nm = 555;

/* An aberrated eye, OSA terms in micrometres over whatever pupil is in use. */
static const double eye_um[15] = {[3] = 0.03,  [4] = 0.10, [5] = -0.08, [6] = 0.06,
                                  [7] = 0.12, [8] = 0.05, [9] = -0.04, [12] = 0.07};
static const double perfect_um[1] = {0};

static placido_pupil pupil_of(double pupil_mm, const double *terms_um, int count) {
  placido_pupil pupil;
  placido_error err = {0};
  if (placido_pupil_of_terms(&pupil, pupil_mm, terms_um, count, 0, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return pupil;
}

/* The image in `window`, whose zeros are settled; to be freed. */
static double *image_of(const placido_pupil *pupil, const placido_wave *waves, size_t count,
                        const placido_window *window, placido_diffraction_use *use) {
  placido_error err = {0};
  int side = window->buckets ? window->buckets : SIDE;
  double *values = malloc((size_t)side * (size_t)side * sizeof *values);
  assert_non_null(values);
  if (placido_diffraction(values, use, pupil, waves, count, window, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return values;
}

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

static size_t fullest(const double *values, int side) {
  size_t best = 0;
  for (size_t i = 0; i < (size_t)side * (size_t)side; i++) {
    best = values[i] > values[best] ? i : best;
  }
  return best;
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

/* 100 samples across 4 mm repeat every 47.7', far inside a window of 128.5'. */
static void window_that_would_wrap_is_refused(void **state) {
  (void)state;
  placido_error err = {0};
  double *values = malloc(sizeof(double) * SIDE * SIDE);
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  placido_pupil pupil = pupil_of(4, perfect_um, 1);
  placido_window window = {.samples = 269}; /* pupil × window / wavelength is 269.4 */
  placido_diffraction_use use;
  assert_int_equal(placido_diffraction(values, NULL, &pupil, &wave, 1, &window, &err),
                   PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "wrap"));
  assert_non_null(strstr(err.text, "at least 270"));
  window.samples = 270;
  assert_int_equal(placido_diffraction(values, NULL, &pupil, &wave, 1, &window, &err),
                   PLACIDO_OK);
  window.samples = 0; /* grown by itself */
  window.buckets = SIDE;
  assert_int_equal(placido_diffraction(values, &use, &pupil, &wave, 1, &window, &err),
                   PLACIDO_OK);
  assert_true(use.samples >= 270 && use.period_arcmin > 128.5);
  placido_pupil_free(&pupil);
  free(values);
}

/* 6 D of defocus behind 6 mm sends rays to 61.9': beyond a narrow window, whose samples have to
 * grow for them; forced to be few, they would come back in it as if they belonged there. */
static void steep_wavefront_is_sampled_or_refused(void **state) {
  (void)state;
  placido_error err = {0};
  double values[11 * 11];
  const double defocus_um[5] = {[4] = 6 * 9 / (4 * 1.7320508075688772)};
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  placido_pupil pupil = pupil_of(6, defocus_um, 5);
  placido_window window = {.buckets = 11};
  placido_diffraction_use use;
  assert_int_equal(placido_diffraction(values, &use, &pupil, &wave, 1, &window, &err), PLACIDO_OK);
  assert_true(use.samples >= 6e-3 * 2 * 6 * 3e-3 / 555e-9 * 0.97);
  double disc_arcmin = 6 * 6e-3 / arcmin_rad; /* even light, but for its rings */
  double even = 11 * 11 * 0.25 / (pi / 4 * disc_arcmin * disc_arcmin);
  assert_near(use.share / even, 1, 0.3);
  window.samples = 300;
  assert_int_equal(placido_diffraction(values, &use, &pupil, &wave, 1, &window, &err),
                   PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "half a wavelength"));
  placido_pupil_free(&pupil);
  const double much_um[5] = {[4] = 250};
  pupil = pupil_of(6, much_um, 5);
  window.samples = 0;
  assert_int_equal(placido_diffraction(values, &use, &pupil, &wave, 1, &window, &err),
                   PLACIDO_QUALITY);
  placido_pupil_free(&pupil);
}

/* |sum over whole cells|² relative to the peak, at an angle right of the axis. */
static double hard_edged(double pupil_mm, int samples, double arcmin) {
  double real = 0, imaginary = 0, count = 0, step = pupil_mm / samples;
  double phase = 2 * pi * arcmin * arcmin_rad / (1e-6 * green_nm);
  for (int j = 0; j < samples; j++) {
    for (int i = 0; i < samples; i++) {
      double x = (i - 0.5 * (samples - 1)) * step, y = (j - 0.5 * (samples - 1)) * step;
      if (x * x + y * y <= pupil_mm * pupil_mm / 4) {
        real += cos(phase * x);
        imaginary += sin(phase * x);
        count++;
      }
    }
  }
  return (real * real + imaginary * imaginary) / (count * count);
}

/* Cells at the rim that count by their area are worth four times as many whole ones. */
static void rim_counts_by_area(void **state) {
  (void)state;
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  placido_pupil pupil = pupil_of(2, perfect_um, 1);
  double hard = 0, soft = 0;
  for (int samples = 60; samples <= 100; samples++) {
    placido_window window = {.buckets = 3, .samples = samples, .points = true};
    double *values = image_of(&pupil, &wave, 1, &window, NULL);
    soft += fabs(values[5] / values[4] - 0.486214559798);
    hard += fabs(hard_edged(2, samples, 0.5) - 0.486214559798);
    free(values);
  }
  assert_true(hard > 4 * soft);
  placido_pupil_free(&pupil);
}

static void tilt_moves_the_image(void **state) {
  (void)state;
  const placido_window window = {0};
  placido_pupil pupil = pupil_of(3, perfect_um, 1);
  const placido_wave wave = {
    .wavelength_nm = green_nm, .weight = 0.5, .x_arcmin = 5, .y_arcmin = -2};
  double *values = image_of(&pupil, &wave, 1, &window, NULL);
  assert_int_equal(fullest(values, SIDE), (MIDDLE - 4) * SIDE + MIDDLE + 10);
  free(values);
  placido_pupil_free(&pupil);
}

/* Light through half of a pupil: half the amplitude's square, all of its own light. */
static void dark_samples_let_no_light_through(void **state) {
  (void)state;
  enum { N = 128 };
  static double opd_um[N * N], amplitude[N * N];
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  const placido_window window = {0};
  placido_diffraction_use use;
  placido_pupil pupil = {.n = N, .spacing_mm = 3.0 / N, .pupil_mm = 3, .opd_um = opd_um};
  for (int i = 0; i < N * N; i++) {
    opd_um[i] = i % N < N / 2 ? (double)NAN : 0;
    amplitude[i] = 0.5;
  }
  double *half = image_of(&pupil, &wave, 1, &window, &use);
  assert_near(use.light, 0.5, 0.01);
  assert_near(use.share, 1, 0.01);
  assert_true(half[MIDDLE * SIDE + MIDDLE + 2] > 1.5 * half[(MIDDLE + 2) * SIDE + MIDDLE]);
  free(half);
  memset(opd_um, 0, sizeof opd_um);
  pupil.amplitude = amplitude;
  double *dim = image_of(&pupil, &wave, 1, &window, &use);
  assert_near(use.light, 0.25, 1e-6);
  assert_near(use.share, 1, 0.01);
  free(dim);
}

/* A wavefront known only within the pupil is continued for the rim's cells. */
static void wavefront_may_end_at_the_rim(void **state) {
  (void)state;
  const placido_window window = {0};
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  placido_pupil pupil = pupil_of(4, eye_um, 15);
  double *whole = image_of(&pupil, &wave, 1, &window, NULL);
  double *opd_um = (double *)pupil.opd_um;
  for (int row = 0; row < pupil.n; row++) {
    for (int column = 0; column < pupil.n; column++) {
      double away = hypot(row - 0.5 * (pupil.n - 1), column - 0.5 * (pupil.n - 1));
      if (away * pupil.spacing_mm > 2) {
        opd_um[row * pupil.n + column] = NAN;
      }
    }
  }
  double *ended = image_of(&pupil, &wave, 1, &window, NULL);
  double peak = whole[fullest(whole, SIDE)];
  for (int i = 0; i < SIDE * SIDE; i++) {
    assert_true(fabs(ended[i] - whole[i]) < 1e-4 * peak);
  }
  free(whole);
  free(ended);
  placido_pupil_free(&pupil);
}

static void coarse_grid_is_refused(void **state) {
  (void)state;
  placido_error err = {0};
  double values[9];
  const double terms_um[136] = {[131] = 1}; /* order 15 */
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  const placido_window window = {.buckets = 3};
  placido_pupil pupil;
  assert_int_equal(placido_pupil_of_terms(&pupil, 4, terms_um, 136, 24, &err), PLACIDO_OK);
  assert_int_equal(placido_diffraction(values, NULL, &pupil, &wave, 1, &window, &err),
                   PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "finer grid"));
  placido_pupil_free(&pupil);
}

static void threads_change_nothing(void **state) {
  (void)state;
  placido_wave waves[5];
  const placido_window one = {.buckets = 65, .threads = 1}, three = {.buckets = 65, .threads = 3};
  assert_int_equal(placido_waves_white(waves, 5, 450, 650, 555, NULL), PLACIDO_OK);
  placido_pupil pupil = pupil_of(3, eye_um, 15);
  double *a = image_of(&pupil, waves, 5, &one, NULL);
  double *b = image_of(&pupil, waves, 5, &three, NULL);
  assert_memory_equal(a, b, 65 * 65 * sizeof *a);
  free(a);
  free(b);
  placido_pupil_free(&pupil);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  double values[9];
  placido_wave waves[2] = {{.wavelength_nm = 500, .weight = 1}, {.wavelength_nm = 600}};
  const placido_window window = {.buckets = 3, .threads = 2};
  placido_pupil pupil = pupil_of(3, eye_um, 15);
  placido_memory_fail_at(0);
  assert_int_equal(placido_diffraction(values, NULL, &pupil, waves, 2, &window, NULL), PLACIDO_OK);
  unsigned long count = placido_memory_fail_at(0);
  assert_true(count > 5);
  for (unsigned long i = 1; i <= count; i++) {
    placido_memory_fail_at(i);
    assert_int_equal(placido_diffraction(values, NULL, &pupil, waves, 2, &window, NULL),
                     PLACIDO_MEMORY);
  }
  placido_memory_fail_at(0);
  placido_pupil_free(&pupil);
}

static void arguments_out_of_range_are_refused(void **state) {
  (void)state;
  double values[9], flat[64] = {0};
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1}, none = {0};
  const placido_window good = {.buckets = 3}, even = {.buckets = 4},
                       fine = {.buckets = 3, .bucket_arcmin = 0.001};
  const placido_pupil pupil = {.n = 8, .spacing_mm = 0.5, .pupil_mm = 4, .opd_um = flat};
  const placido_pupil narrow = {.n = 8, .spacing_mm = 0.4, .pupil_mm = 4, .opd_um = flat};
  placido_error err;
  const struct {
    const placido_pupil *pupil;
    const placido_wave *wave;
    size_t count;
    const placido_window *window;
  } cases[] = {{&narrow, &wave, 1, &good}, {&pupil, &none, 1, &good}, {&pupil, &wave, 0, &good},
               {&pupil, &wave, 1, &even}, {&pupil, &wave, 1, &fine}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    assert_int_equal(placido_diffraction(values, NULL, cases[c].pupil, cases[c].wave,
                                         cases[c].count, cases[c].window, &err), PLACIDO_INPUT);
  }
}

/* Rays and waves of one eye: same place, same shape, same way up, behind wide pupils, too, where a
 * ray's place in the pupil is not its direction. Diffraction adds a little spread of its own to the
 * second moments: its rings reach to the window's rim. */
static void waves_follow_the_rays(void **state) {
  (void)state;
  static const double pupils_mm[2] = {4, 8};
  for (int k = 0; k < 2; k++) {
    placido_surface *surface = keratoconus(0);
    const placido_eye eye = {.pupil_mm = pupils_mm[k], .correct = true};
    placido_optics optics = {.samples = 200};
    placido_eye found;
    placido_psf rays, waves;
    placido_error err = {0};
    assert_int_equal(placido_psf_new(&rays, &found, surface, &eye, &optics, NULL, &err),
                     PLACIDO_OK);
    optics.wavelength_nm = green_nm;
    if (placido_psf_new(&waves, NULL, surface, &found, &optics, NULL, &err) != PLACIDO_OK) {
      fail_msg("%s", err.text);
    }
    assert_int_equal(waves.n, rays.n);
    placido_moments r = placido_psf_moments(&rays), w = placido_psf_moments(&waves);
    assert_true(r.rms > 10);
    assert_near(w.x, r.x, 0.05);
    assert_near(w.y, r.y, 0.05);
    assert_near(w.xy, r.xy, 0.005 * r.rms * r.rms);
    assert_near(w.xx - r.xx, w.yy - r.yy, 0.005 * r.rms * r.rms);
    assert_true(w.xx > r.xx && w.yy > r.yy && w.xx < r.xx + 8);
    placido_psf_free(&rays);
    placido_psf_free(&waves);
    placido_surface_free(surface);
  }
}

/* A cornea without aberrations behind a small pupil has the Airy pattern's middle bucket. */
static void perfect_cornea_is_diffraction_limited(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -1 / (1.3375 * 1.3375));
  const placido_eye eye = {.pupil_mm = 2, .retina_mm = 30.911111111};
  const placido_optics optics = {.wavelength_nm = green_nm};
  placido_psf psf = psf_of(surface, &eye, &optics);
  assert_near(psf.values[MIDDLE * SIDE + MIDDLE], 0.192917835403, 2e-3);
  assert_near(psf.wavelength_nm, green_nm, 0);
  placido_psf_free(&psf);
  placido_surface_free(surface);
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
    cmocka_unit_test(window_that_would_wrap_is_refused),
    cmocka_unit_test(steep_wavefront_is_sampled_or_refused),
    cmocka_unit_test(rim_counts_by_area),
    cmocka_unit_test(tilt_moves_the_image),
    cmocka_unit_test(dark_samples_let_no_light_through),
    cmocka_unit_test(wavefront_may_end_at_the_rim),
    cmocka_unit_test(coarse_grid_is_refused),
    cmocka_unit_test(threads_change_nothing),
    cmocka_unit_test(every_allocation_may_fail),
    cmocka_unit_test(arguments_out_of_range_are_refused),
    cmocka_unit_test(waves_follow_the_rays),
    cmocka_unit_test(perfect_cornea_is_diffraction_limited),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
