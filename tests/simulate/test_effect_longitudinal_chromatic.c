/* Longitudinal chromatic aberration against closed forms, wavelength by wavelength: through a
 * perfect eye an edge is spread by a disc of 3.438' a dioptre and millimetre of pupil. */
#include "chromatic.h"
#include "simulate/spectrum/spectrum.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

enum { WIDTH = 160, HEIGHT = 9, EDGE = WIDTH / 2, BUCKETS = 97, FIRST_NM = 380, LAST_NM = 780 };

static const placido_effect *const longitudinal[] = {&placido_effect_longitudinal_chromatic};

/* Light `at_arcmin` beside the edge of a half plane, 0 to 1. */
static double edge(double at_arcmin, double pupil_mm, double defocus_D) {
  double radius = fmax(3.43775 * pupil_mm / 2 * fabs(defocus_D), 1e-9);
  double t = fmin(fmax(at_arcmin / radius, -1), 1);
  return 0.5 + (t * sqrt(1 - t * t) + asin(t)) / acos(-1);
}

static double true_edge(double at_arcmin, double pupil_mm, enum placido_spectrum spectrum,
                        int planes, int plane) {
  double light = 0, sum = 0;
  for (int nm = FIRST_NM; nm <= LAST_NM; nm++) {
    double power[3];
    placido_spectrum_power(power, planes, spectrum, nm);
    double weight = tabled_efficiency(nm) * power[plane];
    sum += weight;
    light += weight * edge(at_arcmin, pupil_mm, thibos_D(nm));
  }
  return light / sum;
}

/* Dark to the left, white to the right; above and below everything is white far beyond the blur. */
static placido_scene half_white(int planes, enum placido_spectrum spectrum) {
  placido_scene scene = dark_scene(WIDTH, WIDTH, planes, spectrum);
  for (int i = 0; i < planes * WIDTH * WIDTH; i++) {
    scene.image.data[i] = i % WIDTH >= EDGE;
  }
  return scene;
}

/* The largest difference from the truth along the middle row, 10' to either side of the edge. */
static double worst_error(const placido_image *seen, double pupil_mm,
                          enum placido_spectrum spectrum) {
  double worst = 0;
  for (int plane = 0; plane < seen->planes; plane++) {
    const float *row = placido_image_plane(seen, plane) + WIDTH / 2 * WIDTH;
    for (int column = EDGE - 20; column < EDGE + 20; column++) {
      double at_arcmin = (column + 0.5 - EDGE) * sample_arcmin;
      double truth = true_edge(at_arcmin, pupil_mm, spectrum, seen->planes, plane);
      worst = fmax(worst, fabs((double)row[column] - truth));
    }
  }
  return worst;
}

/* 31 waves stand for a light to 1e-3, the fit of V to 2e-3, rays for a disc to 1e-3. Without the
 * effect it is wrong by more than 0.15: white is spread. */
static void edge_is_spread_as_in_closed_form(void **state) {
  (void)state;
  static const enum placido_spectrum spectra[] = {
    PLACIDO_SPECTRUM_EQUAL_ENERGY, PLACIDO_SPECTRUM_DAYLIGHT, PLACIDO_SPECTRUM_INCANDESCENT,
    PLACIDO_SPECTRUM_DISPLAY_SRGB};
  for (size_t s = 0; s < sizeof spectra / sizeof *spectra; s++) {
    for (int planes = 1; planes <= 3; planes += 2) {
      placido_scene scene = half_white(planes, spectra[s]);
      for (double pupil_mm = 3; pupil_mm <= 6; pupil_mm += 3) {
        const placido_eye eye = {.pupil_mm = pupil_mm};
        placido_image seen = seen_with(&scene, &eye, longitudinal, 1, 31, 1, BUCKETS);
        placido_image plain = seen_with(&scene, &eye, NULL, 0, 31, 1, BUCKETS);
        assert_near(worst_error(&seen, pupil_mm, spectra[s]), 0, 4e-3);
        assert_true(worst_error(&plain, pupil_mm, spectra[s]) > 0.15);
        placido_image_free(&seen);
        placido_image_free(&plain);
      }
      placido_scene_free(&scene);
    }
  }
}

/* Through 6 mm an edge is blue outside and yellow inside: blue is 0.4 D out of focus, green
 * hardly. */
static void edges_have_blue_fringes(void **state) {
  (void)state;
  placido_scene scene = half_white(3, PLACIDO_SPECTRUM_DISPLAY_SRGB);
  const placido_eye eye = {.pupil_mm = 6};
  placido_image seen = seen_with(&scene, &eye, longitudinal, 1, 9, 1, BUCKETS);
  size_t outside = WIDTH / 2 * WIDTH + EDGE - 6, inside = WIDTH / 2 * WIDTH + EDGE + 5;
  double fringe = (double)(placido_image_plane(&seen, 2)[outside] -
                           placido_image_plane(&seen, 1)[outside]);
  double missing = (double)(placido_image_plane(&seen, 1)[inside] -
                            placido_image_plane(&seen, 2)[inside]);
  assert_true(fringe > 0.1);
  assert_near(missing, fringe, 1e-3);
  placido_image_free(&seen);
  placido_scene_free(&scene);
}

/* Yellow of 589 nm: the eye was focused in it, and nothing is spread. */
static void line_has_no_colours_to_part(void **state) {
  (void)state;
  placido_strokes strokes;
  placido_scene scene = half_white(3, PLACIDO_SPECTRUM_LINE);
  scene.conditions.wavelength_nm = 589;
  const placido_eye eye = {.pupil_mm = 6};
  placido_answer answer = asked(longitudinal[0], &scene, &eye, &strokes);
  assert_false(answer.applies);
  assert_int_equal(strokes.lights, 0);
  assert_non_null(strstr(answer.reason, "589 nm"));
  placido_image seen = seen_with(&scene, &eye, longitudinal, 1, 9, 1, BUCKETS);
  placido_image plain = seen_with(&scene, &eye, NULL, 0, 9, 1, BUCKETS);
  assert_memory_equal(seen.data, plain.data, 3 * WIDTH * WIDTH * sizeof *seen.data);
  placido_image_free(&seen);
  placido_image_free(&plain);
  placido_scene_free(&scene);
}

/* What the planner's sketch gets has the light's mean, to the fit of V in blue, and nearly its
 * spread of focus: means over cells have less. */
static void strokes_sketch_the_light(void **state) {
  (void)state;
  const placido_eye eye = {.pupil_mm = 4};
  for (int planes = 1; planes <= 3; planes += 2) {
    placido_strokes strokes;
    placido_scene scene = half_white(planes, PLACIDO_SPECTRUM_DISPLAY_SRGB);
    placido_answer answer = asked(longitudinal[0], &scene, &eye, &strokes);
    assert_true(answer.applies && answer.strokes->lights > 0);
    assert_int_equal(strokes.lights, planes);
    for (int k = 0; k < planes; k++) {
      double few[2] = {0, 0}, many[2] = {0, 0}, sum = 0;
      for (int nm = FIRST_NM; nm <= LAST_NM; nm++) {
        double power[3];
        placido_spectrum_power(power, planes, PLACIDO_SPECTRUM_DISPLAY_SRGB, nm);
        double weight = tabled_efficiency(nm) * power[k];
        sum += weight;
        many[0] += weight * thibos_D(nm);
        many[1] += weight * thibos_D(nm) * thibos_D(nm);
      }
      for (int i = 0; i < strokes.light[k].count; i++) {
        const placido_wave *wave = &strokes.light[k].waves[i];
        few[0] += wave->weight * wave->defocus_D;
        few[1] += wave->weight * wave->defocus_D * wave->defocus_D;
      }
      assert_near(few[0], many[0] / sum, 0.011);
      double rms_D = sqrt(many[1] / sum);
      assert_near(sqrt(few[1]), rms_D, 0.06 * rms_D);
    }
    placido_scene_free(&scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(edge_is_spread_as_in_closed_form),
    cmocka_unit_test(edges_have_blue_fringes),
    cmocka_unit_test(line_has_no_colours_to_part),
    cmocka_unit_test(strokes_sketch_the_light),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
