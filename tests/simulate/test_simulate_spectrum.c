/* Lights and the wavelengths that stand for them, against colorimetry and against sums over every
 * nanometre. */
#include "simulate/spectrum/spectrum.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

enum { FIRST_NM = 380, LAST_NM = 780 };

static const enum placido_spectrum broad[] = {
  PLACIDO_SPECTRUM_DISPLAY_SRGB, PLACIDO_SPECTRUM_EQUAL_ENERGY, PLACIDO_SPECTRUM_DAYLIGHT,
  PLACIDO_SPECTRUM_INCANDESCENT};
enum { BROAD = sizeof broad / sizeof *broad };

static const double primaries_xy[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
static const double primaries_luminance[3] = {0.2126, 0.7152, 0.0722};

static double lobe(double nm, double height, double peak_nm, double below, double above) {
  double steps = (nm - peak_nm) * (nm < peak_nm ? below : above);
  return height * exp(-0.5 * steps * steps);
}

/* The colour matching functions of the CIE, 1931, as fitted by Wyman, Sloan and Shirley (2013). */
static void match(double xyz[3], double nm) {
  xyz[0] = lobe(nm, 0.362, 442, 0.0624, 0.0374) + lobe(nm, 1.056, 599.8, 0.0264, 0.0323) -
           lobe(nm, 0.065, 501.1, 0.0490, 0.0382);
  xyz[1] = lobe(nm, 0.821, 568.8, 0.0213, 0.0247) + lobe(nm, 0.286, 530.9, 0.0613, 0.0322);
  xyz[2] = lobe(nm, 1.217, 437, 0.0845, 0.0278) + lobe(nm, 0.681, 459, 0.0385, 0.0725);
}

static void integrate(double xyz[3], enum placido_spectrum spectrum, int planes, int plane) {
  xyz[0] = xyz[1] = xyz[2] = 0;
  for (int nm = FIRST_NM; nm <= LAST_NM; nm++) {
    double power[3], matched[3];
    placido_spectrum_power(power, planes, spectrum, nm);
    match(matched, nm);
    for (int k = 0; k < 3; k++) {
      xyz[k] += power[plane] * matched[k];
    }
  }
}

static void assert_chromaticity(enum placido_spectrum spectrum, int planes, int plane, double x,
                                double y, double tolerance) {
  double xyz[3];
  integrate(xyz, spectrum, planes, plane);
  double sum = xyz[0] + xyz[1] + xyz[2];
  assert_near(xyz[0] / sum, x, tolerance);
  assert_near(xyz[1] / sum, y, tolerance);
}

/* V at wavelengths of the CIE's table; the fit is good to 0.01. */
static void efficiency_is_that_of_the_cie(void **state) {
  (void)state;
  static const struct { double nm, v; } table[] = {
    {450, 0.0380}, {480, 0.1390}, {510, 0.5030}, {530, 0.8620}, {555, 1.0000},
    {580, 0.8700}, {610, 0.5030}, {640, 0.1750}, {680, 0.0170}};
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    assert_near(placido_luminous_efficiency(table[i].nm), table[i].v, 0.011);
  }
}

/* The fits of the matching functions move chromaticities by up to 0.002, those of the standard have
 * two digits. */
static void display_has_the_primaries_and_white_of_srgb(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    assert_chromaticity(PLACIDO_SPECTRUM_DISPLAY_SRGB, 3, k, primaries_xy[k][0],
                        primaries_xy[k][1], 0.003);
  }
  assert_chromaticity(PLACIDO_SPECTRUM_DISPLAY_SRGB, 1, 0, 0.3127, 0.3290, 0.003);
}

static void white_lights_have_their_chromaticities(void **state) {
  (void)state;
  assert_chromaticity(PLACIDO_SPECTRUM_EQUAL_ENERGY, 1, 0, 1 / 3.0, 1 / 3.0, 0.001);
  assert_chromaticity(PLACIDO_SPECTRUM_DAYLIGHT, 1, 0, 0.3127, 0.3290, 0.001);
  assert_chromaticity(PLACIDO_SPECTRUM_INCANDESCENT, 1, 0, 0.4476, 0.4074, 0.003);
}

/* Illuminant A by Planck's law at 2856 K with today's constant: relative power at two wavelengths
 * of CIE 15's table. */
static void incandescent_light_is_illuminant_a(void **state) {
  (void)state;
  static const struct { double nm, percent; } table[] = {
    {400, 14.7080}, {560, 100}, {700, 198.261}};
  for (int i = 0; i < 3; i++) {
    double power;
    placido_spectrum_power(&power, 1, PLACIDO_SPECTRUM_INCANDESCENT, table[i].nm);
    assert_near(100 * power, table[i].percent, 1e-3);
  }
}

/* Grey things reflect the light as it is; white's luminance is parted as on a display, and the
 * bands have about the colours of a display. */
static void bands_part_the_light(void **state) {
  (void)state;
  for (int s = 1; s < BROAD; s++) {
    for (int nm = FIRST_NM; nm <= LAST_NM; nm += 10) {
      double parts[3], whole;
      placido_spectrum_power(parts, 3, broad[s], nm);
      placido_spectrum_power(&whole, 1, broad[s], nm);
      assert_near(parts[0] + parts[1] + parts[2], whole, 1e-12 * whole);
    }
  }
  double whole[3], part[3];
  integrate(whole, PLACIDO_SPECTRUM_DAYLIGHT, 1, 0);
  for (int k = 0; k < 3; k++) {
    integrate(part, PLACIDO_SPECTRUM_DAYLIGHT, 3, k);
    assert_near(part[1] / whole[1], primaries_luminance[k], 0.001);
    assert_chromaticity(PLACIDO_SPECTRUM_DAYLIGHT, 3, k, primaries_xy[k][0], primaries_xy[k][1],
                        0.022);
  }
}

/* Refraction against 555 nm: differences of the published curve, two digits (Thibos et al.
 * 1992). */
static void focus_follows_thibos(void **state) {
  (void)state;
  static const struct { double nm, refraction_D; } curve[] = {
    {400, -1.72}, {450, -1.00}, {486, -0.64}, {500, -0.53}, {555, -0.17}, {656, 0.25}, {700, 0.38}};
  for (size_t i = 0; i < sizeof curve / sizeof *curve; i++) {
    double expected_D = -0.17 - curve[i].refraction_D;
    assert_near(placido_chromatic_defocus(curve[i].nm, 555), expected_D, 0.011);
  }
}

/* A light by the nanometre. */
typedef struct truth {
  double weight[LAST_NM - FIRST_NM + 1], defocus_D[LAST_NM - FIRST_NM + 1];
  double mean_nm, mean_D;
} truth;

static truth true_light(enum placido_spectrum spectrum, int planes, int plane) {
  truth t = {.mean_nm = 0};
  double sum = 0;
  for (int nm = FIRST_NM; nm <= LAST_NM; nm++) {
    double power[3], matched[3];
    placido_spectrum_power(power, planes, spectrum, nm);
    match(matched, nm);
    t.weight[nm - FIRST_NM] = power[plane] * matched[1];
    t.defocus_D[nm - FIRST_NM] = 633.46 * (1 / (nm - 214.102) - 1 / (555 - 214.102));
    sum += t.weight[nm - FIRST_NM];
  }
  for (int nm = FIRST_NM; nm <= LAST_NM; nm++) {
    t.weight[nm - FIRST_NM] /= sum;
    t.mean_nm += t.weight[nm - FIRST_NM] * nm;
    t.mean_D += t.weight[nm - FIRST_NM] * t.defocus_D[nm - FIRST_NM];
  }
  return t;
}

/* Of all light, however few waves stand for it: what is left out, beyond 390 and 730 nm, is up to
 * 5e-4 of it. */
static void waves_keep_the_lights_means(void **state) {
  (void)state;
  for (int s = 0; s < BROAD; s++) {
    const placido_conditions conditions = {.spectrum = broad[s]};
    for (int planes = 1; planes <= 3; planes += 2) {
      for (int n = 1; n <= PLACIDO_WAVES_MAX; n++) {
        placido_light lights[PLACIDO_VIEW_LIGHTS];
        assert_int_equal(placido_spectrum_lights(lights, &conditions, planes, n, 555), planes);
        for (int k = 0; k < planes; k++) {
          double weight = 0, nm = 0, defocus_D = 0, before_nm = 0;
          truth t = true_light(broad[s], planes, k);
          assert_int_equal(lights[k].count, n);
          for (int i = 0; i < n; i++) {
            const placido_wave *wave = &lights[k].waves[i];
            assert_true(wave->weight > 0 && wave->wavelength_nm > before_nm);
            weight += wave->weight;
            nm += wave->weight * wave->wavelength_nm;
            defocus_D += wave->weight * wave->defocus_D;
            before_nm = wave->wavelength_nm;
          }
          assert_near(weight, 1, 1e-12);
          assert_near(nm, t.mean_nm, 0.1);
          assert_near(defocus_D, t.mean_D, 1e-3);
        }
      }
    }
  }
}

/* Light of an edge `at_arcmin` beside it, through a perfect pupil: a disc for each wave. */
static double edge(double at_arcmin, double pupil_mm, double defocus_D) {
  double radius = fmax(3.43775 * pupil_mm / 2 * fabs(defocus_D), 1e-9);
  double t = fmin(fmax(at_arcmin / radius, -1), 1);
  return 0.5 + (t * sqrt(1 - t * t) + asin(t)) / acos(-1);
}

/* The largest error of an edge in buckets of half a minute: means of five places. */
static double edge_error(const truth *t, const placido_light *light, double pupil_mm) {
  double most = 0;
  for (double at = -12; at <= 12; at += 0.1) {
    double error = 0;
    for (int part = -2; part <= 2; part++) {
      double place = at + 0.1 * part;
      for (int i = 0; i <= LAST_NM - FIRST_NM; i++) {
        error -= t->weight[i] * edge(place, pupil_mm, t->defocus_D[i]) / 5;
      }
      for (int i = 0; i < light->count; i++) {
        const placido_wave *wave = &light->waves[i];
        error += wave->weight * edge(place, pupil_mm, wave->defocus_D) / 5;
      }
    }
    most = fmax(most, fabs(error));
  }
  return most;
}

/* An edge through 4 mm without other aberrations, the hardest case: what is in focus has a corner
 * there. With 5, 9, 15 and 31 waves all lights are as good as this; one wave is 0.28 off. */
static void few_waves_stand_for_a_light(void **state) {
  (void)state;
  static const struct { int waves; double error; } cases[] = {
    {5, 0.015}, {9, 0.004}, {15, 0.0015}, {31, 0.0005}};
  for (int s = 0; s < BROAD; s++) {
    const placido_conditions conditions = {.spectrum = broad[s]};
    for (int planes = 1; planes <= 3; planes += 2) {
      for (int k = 0; k < planes; k++) {
        truth t = true_light(broad[s], planes, k);
        for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
          placido_light lights[PLACIDO_VIEW_LIGHTS];
          placido_spectrum_lights(lights, &conditions, planes, cases[c].waves, 555);
          double error = edge_error(&t, &lights[k], 4);
          if (!(error < cases[c].error)) {
            print_error("light %d, plane %d of %d, %d waves\n", s, k, planes, cases[c].waves);
          }
          assert_near(error, 0, cases[c].error);
        }
      }
    }
  }
}

static void line_is_one_wave_in_focus(void **state) {
  (void)state;
  const placido_conditions conditions = {.spectrum = PLACIDO_SPECTRUM_LINE, .wavelength_nm = 589};
  placido_light lights[PLACIDO_VIEW_LIGHTS];
  double focus_nm = placido_spectrum_focus_nm(&conditions);
  assert_int_equal(placido_spectrum_lights(lights, &conditions, 3, 9, focus_nm), 1);
  assert_int_equal(lights[0].count, 1);
  assert_near(lights[0].waves[0].wavelength_nm, 589, 0);
  assert_near(lights[0].waves[0].weight, 1, 0);
  assert_near(lights[0].waves[0].defocus_D, 0, 0);
}

/* Alpha is no colour. */
static void alpha_has_no_light(void **state) {
  (void)state;
  const placido_conditions conditions = {.spectrum = PLACIDO_SPECTRUM_DISPLAY_SRGB};
  placido_light lights[PLACIDO_VIEW_LIGHTS];
  assert_int_equal(placido_spectrum_lights(lights, &conditions, 4, 3, 555), 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(efficiency_is_that_of_the_cie),
    cmocka_unit_test(display_has_the_primaries_and_white_of_srgb),
    cmocka_unit_test(white_lights_have_their_chromaticities),
    cmocka_unit_test(incandescent_light_is_illuminant_a),
    cmocka_unit_test(bands_part_the_light),
    cmocka_unit_test(focus_follows_thibos),
    cmocka_unit_test(waves_keep_the_lights_means),
    cmocka_unit_test(few_waves_stand_for_a_light),
    cmocka_unit_test(line_is_one_wave_in_focus),
    cmocka_unit_test(alpha_has_no_light),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
