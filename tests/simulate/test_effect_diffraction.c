/* Diffraction through a whole run: a star behind a perfect pupil is Airy's pattern. */
#include "eyes.h"
#include "simulate/plan/run.h"
#include "tests/support/near.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

enum { FIELD = 41, STAR = FIELD / 2, BUCKETS = 101, FINE = 16 };

static const double arcmin_rad = 2.908882086657216e-4;
static const double pi = 3.14159265358979323846;

static const placido_plan_settings settings = {
  .wavelengths = 1, .nodes = 1, .bucket_arcmin = 0.5, .buckets = BUCKETS};

/* A white pixel in the middle of the dark; free with placido_scene_free. */
static placido_scene star(enum placido_spectrum spectrum, double wavelength_nm) {
  placido_scene scene = {.name = "star", .arcmin_per_px = 0.5, .bits = 8};
  scene.conditions.distance_m = INFINITY;
  scene.conditions.spectrum = spectrum;
  scene.conditions.wavelength_nm = wavelength_nm;
  assert_int_equal(placido_image_new(&scene.image, FIELD, FIELD, 1, NULL), PLACIDO_OK);
  scene.image.data[STAR * FIELD + STAR] = 1;
  return scene;
}

/* A cornea that brings all rays to one point, Q = -1/n², and the eye whose retina is there. */
static placido_surface *perfect_cornea(void) {
  return conic(7.8, -1 / (PLACIDO_EYE_INDEX * PLACIDO_EYE_INDEX));
}

static placido_eye perfect_eye(double pupil_mm) {
  return (placido_eye){.pupil_mm = pupil_mm, .index = PLACIDO_EYE_INDEX,
                       .retina_mm = 7.8 * PLACIDO_EYE_INDEX / (PLACIDO_EYE_INDEX - 1)};
}

static placido_image see(const placido_scene *scene, const placido_surface *surface,
                         const placido_eye *eye, bool diffracted) {
  static const placido_effect *const effects[] = {&placido_effect_diffraction};
  const placido_run run = {.surface = surface, .scene = scene, .settings = &settings, .eye = eye,
                           .effects = effects, .count = diffracted ? 1 : 0, .threads = 1};
  placido_image seen;
  placido_error err = {0};
  if (placido_view_run(&seen, NULL, &run, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return seen;
}

/* Airy's pattern (G. B. Airy, 1835), pi D² / 4 lambda² (2 J1(v) / v)², v = pi D theta / lambda, of
 * which all light is 1, integrated over a bucket. */
static double airy_in_bucket(int column, int row, double pupil_mm, double wavelength_nm) {
  const double bucket = 0.5 * arcmin_rad, across = pi * pupil_mm / (1e-6 * wavelength_nm);
  double sum = 0;
  for (int i = 0; i < FINE; i++) {
    for (int k = 0; k < FINE; k++) {
      double x = (column - 0.5 + (i + 0.5) / FINE) * bucket;
      double y = (row - 0.5 + (k + 0.5) / FINE) * bucket;
      double v = across * hypot(x, y), height = v > 0 ? 2 * j1(v) / v : 1;
      sum += height * height;
    }
  }
  return sum * bucket * bucket / (FINE * FINE) * across * across / (4 * pi);
}

/* In the light that a scene has: of a line its own, else the middle of the spectrum. */
static void star_is_an_airy_pattern(void **state) {
  (void)state;
  static const struct {
    double pupil_mm, wavelength_nm;
    enum placido_spectrum spectrum;
  } cases[] = {{2, 555, PLACIDO_SPECTRUM_EQUAL_ENERGY},
               {3, 650, PLACIDO_SPECTRUM_LINE},
               {4, 480, PLACIDO_SPECTRUM_LINE}};
  placido_surface *surface = perfect_cornea();
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const placido_eye eye = perfect_eye(cases[c].pupil_mm);
    /* By the sine of its rays' directions the pupil is wider by its rim's sag over their way. */
    double sag_mm = cases[c].pupil_mm * cases[c].pupil_mm / (8 * 7.8);
    double wide_mm = cases[c].pupil_mm * (1 + sag_mm / eye.retina_mm);
    placido_scene scene = star(cases[c].spectrum, cases[c].wavelength_nm);
    placido_image seen = see(&scene, surface, &eye, true);
    for (int row = -6; row <= 6; row++) {
      for (int column = -6; column <= 6; column++) {
        double value = (double)seen.data[(STAR + row) * FIELD + STAR + column];
        double airy = airy_in_bucket(column, row, wide_mm, cases[c].wavelength_nm);
        /* Of a peak of 0.2 to 0.66: as much as a pupil 0.15 % wider would give. */
        assert_near(value, airy, 2e-3);
      }
    }
    placido_image_free(&seen);
    placido_scene_free(&scene);
  }
  placido_surface_free(surface);
}

static void without_it_a_star_is_a_point(void **state) {
  (void)state;
  placido_surface *surface = perfect_cornea();
  const placido_eye eye = perfect_eye(2);
  placido_scene scene = star(PLACIDO_SPECTRUM_EQUAL_ENERGY, NAN);
  placido_image seen = see(&scene, surface, &eye, false);
  for (int i = 0; i < FIELD * FIELD; i++) {
    assert_near((double)seen.data[i], i == STAR * FIELD + STAR ? 1 : 0, 1e-6);
  }
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

/* Where aberrations spread light over many Airy discs, rays and waves show the same picture. */
static void behind_a_wide_irregular_pupil_it_is_not_seen(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = {.pupil_mm = 6, .index = PLACIDO_EYE_INDEX, .retina_mm = 29};
  placido_scene scene = star(PLACIDO_SPECTRUM_EQUAL_ENERGY, NAN);
  for (int i = 0; i < FIELD * FIELD; i++) {
    scene.image.data[i] = i % FIELD < FIELD / 2 ? 1 : 0;
  }
  placido_image waves = see(&scene, surface, &eye, true), rays = see(&scene, surface, &eye, false);
  for (int i = 0; i < FIELD * FIELD; i++) {
    assert_near((double)waves.data[i], (double)rays.data[i], 0.02); /* the rings' light */
  }
  placido_image_free(&waves);
  placido_image_free(&rays);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

/* 1.22 lambda / D is 1.16' behind 2 mm at 555 nm; rays on a circle of 3' have that blur. */
static void sentence_has_the_airy_disc_and_the_blur(void **state) {
  (void)state;
  placido_sketch_rays rays = {.count = 8};
  for (int i = 0; i < 8; i++) {
    rays.angle_x[i] = 5 + 3 * (float)cos(i * pi / 4);
    rays.angle_y[i] = -2 + 3 * (float)sin(i * pi / 4);
    rays.weight[i] = 0.125f;
  }
  const placido_eye eye = perfect_eye(2);
  placido_scene scene = star(PLACIDO_SPECTRUM_EQUAL_ENERGY, NAN);
  const placido_question question = {
    .scene = &scene, .eye = &eye, .rays = &rays, .bucket_arcmin = 0.5, .tolerance = 0.01};
  placido_strokes strokes;
  memset(&strokes, 0, sizeof strokes);
  placido_answer answer = {.strokes = &strokes};
  placido_effect_diffraction.ask(&question, &answer);
  assert_true(answer.applies && strokes.waves && answer.bound == 0);
  assert_non_null(strstr(answer.reason, "1.16'"));
  assert_non_null(strstr(answer.reason, "3.00'"));
  placido_scene_free(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(star_is_an_airy_pattern),
    cmocka_unit_test(without_it_a_star_is_a_point),
    cmocka_unit_test(behind_a_wide_irregular_pupil_it_is_not_seen),
    cmocka_unit_test(sentence_has_the_airy_disc_and_the_blur),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
