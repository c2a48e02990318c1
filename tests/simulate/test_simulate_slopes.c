/* Rays by slopes: against closed forms, against rays traced one by one, and against waves. */
#include "simulate/psf/slopes.h"
#include "base/memory.h"
#include "diffracted.h"
#include "eyes.h"
#include "tests/support/near.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By slopes, in `window`, whose zeros are settled; to be freed. */
static double *rays_of(const placido_pupil *pupil, const placido_wave *waves, size_t count,
                       const placido_window *window, double *share) {
  placido_error err = {0};
  int side = window->buckets ? window->buckets : SIDE;
  double *values = malloc((size_t)side * (size_t)side * sizeof *values);
  assert_non_null(values);
  if (placido_slopes(values, share, pupil, waves, count, window, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return values;
}

static moments moments_in(double *values, int side, double bucket_arcmin) {
  const placido_psf psf = {.n = side, .bucket_arcmin = bucket_arcmin, .values = values};
  return moments_of(&psf);
}

/* Behind 4 mm two dioptres out of focus: 4 mrad, so 13.751' about the middle, evenly lit; its
 * second moments are a quarter of the radius squared and, of buckets, a twelfth of their width
 * squared. */
static void defocus_lights_a_disc_evenly(void **state) {
  (void)state;
  const double radius = 4e-3 / arcmin_rad, even = 0.25 / (pi * radius * radius);
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1, .defocus_D = 2};
  const placido_window window = {.buckets = 101};
  placido_pupil pupil = pupil_of(4, perfect_um, 1);
  double share, *values = rays_of(&pupil, &wave, 1, &window, &share);
  moments m = moments_in(values, 101, 0.5);
  assert_near(share, 1, 1e-9);
  assert_near(m.sum, 1, 1e-9);
  assert_near(m.cc, radius * radius / 4 + 0.25 / 12, 1e-3 * m.cc); /* cells of a hundredth */
  assert_near(m.rr, m.cc, 1e-9);
  assert_near(m.cr, 0, 1e-9);
  for (int row = -50; row <= 50; row++) {
    for (int column = -50; column <= 50; column++) {
      double from = 0.5 * hypot(column, row), value = values[(50 + row) * 101 + 50 + column];
      if (from < radius - 1) { /* buckets' and cells' half diagonals aside */
        assert_near(value, even, 0.02 * even);
      } else if (from > radius + 1) {
        assert_near(value, 0, 0);
      }
    }
  }
  free(values);
  placido_pupil_free(&pupil);
}

/* A path that grows with x sends light to negative x: by 3.438' for 1 µm a millimetre. */
static void tilt_moves_light_where_diffraction_moves_it(void **state) {
  (void)state;
  const double tilts_um[3] = {0, 0.25, 0.5}; /* terms y and x: 2 rho, of a radius of 2 mm */
  const double bucket = 0.5 * arcmin_rad / 1e-3; /* µm a millimetre */
  const size_t there = (size_t)((30 + (int)round(-0.25 / bucket)) * 61 +
                                30 + (int)round(-0.5 / bucket));
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  placido_pupil pupil = pupil_of(4, tilts_um, 3);
  const placido_window window = {.buckets = 61};
  double *rays = rays_of(&pupil, &wave, 1, &window, NULL);
  double *light = image_of(&pupil, &wave, 1, &window, NULL);
  assert_near(rays[there], 1, 1e-9);
  assert_int_equal(fullest(light, 61), there);
  free(rays);
  free(light);
  placido_pupil_free(&pupil);
}

/* An aberrated pupil whose light fades towards its rim as a Gaussian, so that moments of the
 * diffracted light exist: its centroid is that of the rays, its second moments are theirs and
 * (lambda / 2 pi)² times the mean square of the amplitude's relative slope, 1/w² along each axis of
 * a Gaussian exp(-r²/w²) (Schroedinger's equation has the same theorem of Ehrenfest). */
static void moments_are_those_of_waves(void **state) {
  (void)state;
  const double w_mm = 0.8;
  double terms_um[15];
  for (int i = 0; i < 15; i++) {
    terms_um[i] = 4 * eye_um[i];
  }
  placido_pupil pupil = pupil_of(5, terms_um, 15);
  size_t n = (size_t)pupil.n;
  double *amplitude = malloc(n * n * sizeof *amplitude);
  assert_non_null(amplitude);
  for (size_t i = 0; i < n * n; i++) {
    double x = ((double)(i % n) - 0.5 * (double)(n - 1)) * pupil.spacing_mm;
    double y = ((double)(i / n) - 0.5 * (double)(n - 1)) * pupil.spacing_mm;
    amplitude[i] = exp(-(x * x + y * y) / (w_mm * w_mm));
  }
  placido_pupil fading = pupil;
  fading.amplitude = amplitude;
  const placido_wave wave = {
    .wavelength_nm = green_nm, .weight = 1, .defocus_D = 0.7, .x_arcmin = 1.5, .y_arcmin = -0.5};
  const placido_window window = {.buckets = 257, .bucket_arcmin = 0.25};
  double *rays = rays_of(&fading, &wave, 1, &window, NULL);
  double *light = image_of(&fading, &wave, 1, &window, NULL);
  moments r = moments_in(rays, 257, 0.25), l = moments_in(light, 257, 0.25);
  double spread = 1e-6 * green_nm / (2 * pi * w_mm) / arcmin_rad;
  assert_near(l.column, r.column, 0.01); /* of a spread of 3': the amplitude is interpolated */
  assert_near(l.row, r.row, 0.01);
  assert_near(l.cc, r.cc + spread * spread, 0.005 * l.cc);
  assert_near(l.rr, r.rr + spread * spread, 0.005 * l.rr);
  assert_near(l.cr, r.cr, 0.005 * l.cc);
  free(amplitude);
  free(rays);
  free(light);
  placido_pupil_free(&pupil);
}

/* The scene as one spread makes it and as another does: the largest difference. */
static double seen_apart(const placido_psf *one, const placido_psf *other) {
  placido_scene scene;
  placido_image a, b;
  double most = 0;
  assert_int_equal(placido_scene_load(&scene, "tumbling-e", 0.5, NULL, NULL), PLACIDO_OK);
  assert_int_equal(placido_scene_see(&a, &scene, one, 1, NULL), PLACIDO_OK);
  assert_int_equal(placido_scene_see(&b, &scene, other, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < a.width_px * a.height_px; i++) {
    most = fmax(most, fabs((double)(a.data[i] - b.data[i])));
  }
  placido_image_free(&a);
  placido_image_free(&b);
  placido_scene_free(&scene);
  return most;
}

/* The cornea alone, as rays through its crosshatch light the retina. Half of an 8-bit step is
 * 0.002. */
static void cornea_alone_is_seen_as_by_traced_rays(void **state) {
  (void)state;
  placido_surface *surfaces[] = {conic(7.8, -0.26), keratoconus(0)};
  for (int i = 0; i < 4; i++) {
    const placido_eye eye = {.pupil_mm = i < 2 ? 4 : 6};
    const placido_optics optics = {.grow = 1};
    placido_eye found;
    placido_psf psf, mine;
    placido_pupil pupil;
    assert_int_equal(placido_psf_new(&psf, &found, surfaces[i % 2], &eye, &optics, NULL, NULL),
                     PLACIDO_OK);
    const double focus_mm[3] = {1e-3 * psf.centre_x_um, 1e-3 * psf.centre_y_um, found.retina_mm};
    assert_int_equal(placido_pupil_of_surface(&pupil, surfaces[i % 2], &found, focus_mm, 1, NULL),
                     PLACIDO_OK);
    const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
    const placido_window window = {
      .bucket_arcmin = 1e-3 * psf.bucket_um * found.index / found.retina_mm / arcmin_rad};
    mine = psf;
    mine.values = rays_of(&pupil, &wave, 1, &window, NULL);
    double apart = 0;
    for (int k = 0; k < SIDE * SIDE; k++) {
      apart += fabs(mine.values[k] - psf.values[k]);
    }
    assert_true(apart < 0.02); /* 19,801 rays, the seed's, differ by 0.02 from 320,000 */
    assert_true(seen_apart(&psf, &mine) < 5e-4);
    free(mine.values);
    placido_psf_free(&psf);
    placido_pupil_free(&pupil);
  }
  placido_surface_free(surfaces[0]);
  placido_surface_free(surfaces[1]);
}

static void waves_add_up(void **state) {
  (void)state;
  const placido_wave waves[3] = {
    {.wavelength_nm = 450, .weight = 0.2, .defocus_D = 0.8, .x_arcmin = 1},
    {.wavelength_nm = 555, .weight = 0.5},
    {.wavelength_nm = 650, .weight = 0.3, .defocus_D = -0.3, .y_arcmin = 0.6}};
  const placido_window window = {.buckets = 129};
  placido_pupil pupil = pupil_of(5, eye_um, 15);
  double *all = rays_of(&pupil, waves, 3, &window, NULL), sum[129 * 129] = {0};
  for (int i = 0; i < 3; i++) {
    double *one = rays_of(&pupil, &waves[i], 1, &window, NULL);
    for (int k = 0; k < 129 * 129; k++) {
      sum[k] += one[k];
    }
    free(one);
  }
  for (int k = 0; k < 129 * 129; k++) {
    assert_near(all[k], sum[k], 1e-10); /* whole units of 2^-50, some thousand cells a bucket */
  }
  free(all);
  placido_pupil_free(&pupil);
}

static void shift_by_buckets_moves_the_picture(void **state) {
  (void)state;
  const placido_wave here = {.wavelength_nm = green_nm, .weight = 1};
  placido_wave there = here;
  there.x_arcmin = 3 * 0.5;
  there.y_arcmin = -2 * 0.5;
  const placido_window window = {.buckets = 129};
  placido_pupil pupil = pupil_of(5, eye_um, 15);
  double *a = rays_of(&pupil, &here, 1, &window, NULL);
  double *b = rays_of(&pupil, &there, 1, &window, NULL);
  for (int row = 2; row < 129; row++) {
    for (int column = 0; column < 129 - 3; column++) {
      assert_near(b[(row - 2) * 129 + column + 3], a[row * 129 + column], 1e-9);
    }
  }
  free(a);
  free(b);
  placido_pupil_free(&pupil);
}

/* Half of the pupil is dark: the defocused disc has its other half only, whose centroid is
 * 4 r / 3 pi from the middle. */
static void missing_samples_are_dark(void **state) {
  (void)state;
  const double radius = 4e-3 / arcmin_rad;
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1, .defocus_D = 2};
  const placido_window window = {.buckets = 101};
  placido_pupil pupil = pupil_of(4, perfect_um, 1);
  double *opd_um = (double *)pupil.opd_um;
  for (int i = 0; i < pupil.n * pupil.n; i++) {
    opd_um[i] = i % pupil.n < pupil.n / 2 ? (double)NAN : opd_um[i];
  }
  double share, *values = rays_of(&pupil, &wave, 1, &window, &share);
  moments m = moments_in(values, 101, 0.5);
  assert_near(share, 1, 1e-9); /* of the light that came through */
  assert_near(m.column, -4 * radius / (3 * pi), 0.01 * radius); /* a cell of the grid */
  assert_near(m.row, 0, 1e-9);
  free(values);
  placido_pupil_free(&pupil);
}

/* A grid that ends at the pupil's edge has no sample to look at beyond: quadratic paths keep their
 * slopes all the same. */
static void grids_may_end_at_the_rim(void **state) {
  (void)state;
  double terms_um[6] = {[4] = 0.3, [5] = 0.2};
  placido_pupil tight;
  assert_int_equal(placido_pupil_of_terms(&tight, 4, terms_um, 6, 60, NULL), PLACIDO_OK);
  placido_pupil wide = pupil_of(4, terms_um, 6);
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  const placido_window window = {.buckets = 61};
  double *a = rays_of(&tight, &wave, 1, &window, NULL);
  double *b = rays_of(&wide, &wave, 1, &window, NULL);
  moments of_a = moments_in(a, 61, 0.5), of_b = moments_in(b, 61, 0.5);
  assert_near(of_a.cc, of_b.cc, 2e-3 * of_b.cc); /* rims of 60 and 128 cells */
  assert_near(of_a.rr, of_b.rr, 2e-3 * of_b.rr);
  free(a);
  free(b);
  placido_pupil_free(&tight);
  placido_pupil_free(&wide);
}

/* What falls beside the window is lost, and the share tells. */
static void light_outside_is_told(void **state) {
  (void)state;
  const double radius = 4e-3 / arcmin_rad;
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1, .defocus_D = 2};
  const placido_window window = {.buckets = 21};
  placido_pupil pupil = pupil_of(4, perfect_um, 1);
  double share, *values = rays_of(&pupil, &wave, 1, &window, &share);
  assert_near(share, 10.5 * 10.5 / (pi * radius * radius), 2e-3);
  free(values);
  placido_pupil_free(&pupil);
}

static void bits_do_not_depend_on_threads(void **state) {
  (void)state;
  const placido_wave waves[2] = {{.wavelength_nm = 450, .weight = 0.4, .defocus_D = 0.8},
                                 {.wavelength_nm = 555, .weight = 0.6}};
  placido_pupil pupil = pupil_of(6, eye_um, 15);
  const placido_window one = {.threads = 1};
  double *alone = rays_of(&pupil, waves, 2, &one, NULL);
  for (int threads = 2; threads <= 7; threads += 5) {
    const placido_window some = {.threads = threads};
    double *together = rays_of(&pupil, waves, 2, &some, NULL);
    assert_memory_equal(together, alone, SIDE * SIDE * sizeof *alone);
    free(together);
  }
  free(alone);
  placido_pupil_free(&pupil);
}

static void wrong_arguments_are_refused(void **state) {
  (void)state;
  static double values[SIDE * SIDE];
  placido_pupil pupil = pupil_of(4, perfect_um, 1);
  const placido_window usual = {0}, even = {.buckets = 100};
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  const placido_wave dark = {.wavelength_nm = green_nm}, odd = {.wavelength_nm = 1, .weight = 1};
  placido_error err;
  assert_int_equal(placido_slopes(values, NULL, &pupil, &wave, 1, &even, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "100 buckets"));
  assert_int_equal(placido_slopes(values, NULL, &pupil, &odd, 1, &usual, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "wavelength"));
  assert_int_equal(placido_slopes(values, NULL, &pupil, &wave, 0, &usual, &err), PLACIDO_INPUT);
  assert_int_equal(placido_slopes(values, NULL, &pupil, &dark, 1, &usual, &err), PLACIDO_QUALITY);
  double *opd_um = (double *)pupil.opd_um;
  for (int i = 0; i < pupil.n * pupil.n; i++) {
    opd_um[i] = NAN;
  }
  assert_int_equal(placido_slopes(values, NULL, &pupil, &wave, 1, &usual, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "no light"));
  placido_pupil_free(&pupil);
}

static void every_failed_allocation_is_told(void **state) {
  (void)state;
  static double values[SIDE * SIDE];
  const placido_window window = {.threads = 2};
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  placido_pupil pupil = pupil_of(4, eye_um, 15);
  unsigned long count = 0;
  for (unsigned long n = 0; n <= count; n++) {
    placido_memory_fail_at(n);
    int status = placido_slopes(values, NULL, &pupil, &wave, 1, &window, NULL);
    unsigned long made = placido_memory_fail_at(0);
    count = n == 0 ? made : count;
    assert_int_equal(status, n == 0 ? PLACIDO_OK : PLACIDO_MEMORY);
  }
  assert_true(count >= 4); /* the wavefront, the cells, two tallies */
  placido_pupil_free(&pupil);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(defocus_lights_a_disc_evenly),
    cmocka_unit_test(tilt_moves_light_where_diffraction_moves_it),
    cmocka_unit_test(moments_are_those_of_waves),
    cmocka_unit_test(cornea_alone_is_seen_as_by_traced_rays),
    cmocka_unit_test(waves_add_up),
    cmocka_unit_test(shift_by_buckets_moves_the_picture),
    cmocka_unit_test(missing_samples_are_dark),
    cmocka_unit_test(grids_may_end_at_the_rim),
    cmocka_unit_test(light_outside_is_told),
    cmocka_unit_test(bits_do_not_depend_on_threads),
    cmocka_unit_test(wrong_arguments_are_refused),
    cmocka_unit_test(every_failed_allocation_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
