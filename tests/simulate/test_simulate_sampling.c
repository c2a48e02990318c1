/* How diffraction samples pupil and image: what it grows, what it refuses, and that it agrees with
 * the rays. */
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
