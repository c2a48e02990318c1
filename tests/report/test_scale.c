/* Colour classes: fixed steps, fixed centres, and colours that a colour-blind person can tell
 * apart. */
#include "report/palette.h"
#include "report/scale.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static const placido_map_kind power = {.name = "axial", .unit = "D", .step = 1};
static const placido_map_kind height = {.name = "elevation", .unit = "µm", .step = 5};
static const placido_map_kind gaussian = {.name = "gaussian", .unit = "1/mm²", .step = 0.001};

static double linear(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

static double root(double t) { return t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116; }

/* CIELAB of linear sRGB. */
static void to_lab(double lab[3], const double c[3]) {
  double x = root((0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2]) / 0.95047);
  double y = root(0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2]);
  double z = root((0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2]) / 1.08883);
  lab[0] = 116 * y - 16;
  lab[1] = 500 * (x - y);
  lab[2] = 200 * (y - z);
}

/* What a dichromat sees, in linear sRGB: Viénot, Brettel and Mollon (1999), with the matrices
 * that follow from their equations for sRGB primaries. */
static const double deuteranope[3][3] = {
    {0.29275, 0.70725, 0}, {0.29275, 0.70725, 0}, {-0.02234, 0.02234, 1}};
static const double protanope[3][3] = {
    {0.11238, 0.88762, 0}, {0.11238, 0.88762, 0}, {0.00401, -0.00401, 1}};
static const double trichromat[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static void see(double lab[3], placido_rgb colour, const double eye[3][3]) {
  double c[3] = {linear(colour.r), linear(colour.g), linear(colour.b)}, seen[3];
  for (int k = 0; k < 3; k++) {
    seen[k] = fmax(eye[k][0] * c[0] + eye[k][1] * c[1] + eye[k][2] * c[2], 0);
  }
  to_lab(lab, seen);
}

static double difference(placido_rgb a, placido_rgb b, const double eye[3][3]) {
  double p[3], q[3];
  see(p, a, eye);
  see(q, b, eye);
  return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
              (p[2] - q[2]) * (p[2] - q[2]));
}

/* 5 units of CIELAB are over twice the just noticeable difference (2.3, Mahy et al. 1994). */
static void assert_classes_differ(const placido_scale *scale, const double eye[3][3]) {
  for (int k = 1; k < scale->classes; k++) {
    assert_true(
        difference(placido_scale_colour(scale, k - 1), placido_scale_colour(scale, k), eye) > 5);
  }
}

static void neighbouring_classes_differ_for_every_eye(void **state) {
  (void)state;
  const placido_scale scales[] = {placido_scale_of_kind(&power, 40, 46),
                                  placido_scale_of_kind(&height, -10, 10),
                                  placido_scale_from_zero(1)};
  for (int k = 0; k < 3; k++) {
    assert_classes_differ(&scales[k], trichromat);
    assert_classes_differ(&scales[k], deuteranope);
    assert_classes_differ(&scales[k], protanope);
  }
}

static void steep_and_flat_never_look_alike(void **state) {
  (void)state;
  placido_scale scale = placido_scale_of_kind(&power, 40, 46);
  for (int k = 0; k < scale.classes / 2; k++) {
    placido_rgb flat = placido_scale_colour(&scale, k);
    placido_rgb steep = placido_scale_colour(&scale, scale.classes - 1 - k);
    assert_true(difference(flat, steep, deuteranope) > 20);
    assert_true(difference(flat, steep, protanope) > 20);
    assert_true(steep.r > steep.b); /* warm is steep */
    assert_true(flat.b > flat.r);
  }
}

static double lightness(placido_rgb colour) {
  double lab[3];
  see(lab, colour, trichromat);
  return lab[0];
}

static void lightness_falls_away_from_the_middle(void **state) {
  (void)state;
  for (int k = 1; k <= 10; k++) {
    double nearer = 0.1 * (k - 1), farther = 0.1 * k;
    assert_true(lightness(placido_palette_diverging(farther)) <
                lightness(placido_palette_diverging(nearer)));
    assert_true(lightness(placido_palette_diverging(-farther)) <
                lightness(placido_palette_diverging(-nearer)));
    assert_true(lightness(placido_palette_sequential(farther)) <
                lightness(placido_palette_sequential(nearer)));
  }
}

static void the_smallest_fixed_step_that_holds_the_values_is_chosen(void **state) {
  (void)state;
  assert_true(placido_scale_of_kind(&power, 41, 46).step == 0.5);
  assert_true(placido_scale_of_kind(&power, 41, 50).step == 1.0);
  assert_true(placido_scale_of_kind(&power, 41, 56).step == 1.5);
  assert_true(placido_scale_of_kind(&power, 10, 90).step == 1.5);
  assert_true(placido_scale_of_kind(&height, -3, 20).step == 2);
  assert_true(placido_scale_of_kind(&height, -3, 40).step == 5);
  assert_true(placido_scale_of_kind(&height, -100, 0).step == 10);
  assert_true(placido_scale_of_kind(&height, -100, 300).step == 20);
  assert_true(placido_scale_of_kind(&gaussian, 0.012, 0.02).step == 0.001);
}

static void powers_are_centred_where_corneas_are(void **state) {
  (void)state;
  placido_scale scale = placido_scale_of_kind(&power, 41, 46);
  assert_int_equal(placido_scale_class(&scale, 43.49), 9);
  assert_int_equal(placido_scale_class(&scale, 43.51), 10);
}

/* An exact sphere's elevation is rounding noise about 0, which must not flicker between two
 * colours. */
static void no_elevation_is_the_middle_of_a_class(void **state) {
  (void)state;
  placido_scale scale = placido_scale_of_kind(&height, 0, 0);
  assert_int_equal(placido_scale_class(&scale, 1e-9), placido_scale_class(&scale, -1e-9));
  assert_int_equal(placido_scale_class(&scale, 0), 10);
}

static void the_last_classes_are_open(void **state) {
  (void)state;
  placido_scale scale = placido_scale_of_kind(&power, 41, 46);
  assert_int_equal(placido_scale_class(&scale, 1e300), 19);
  assert_int_equal(placido_scale_class(&scale, -1e300), 0);
  assert_int_equal(placido_scale_step(&scale, 50.2), 23);
  assert_int_equal(placido_scale_step(&scale, 1e300), 30);
  assert_int_equal(placido_scale_step(&scale, -1e300), -10);
}

static void bounds_are_written_with_the_decimals_of_the_scale(void **state) {
  (void)state;
  char text[64];
  placido_scale scale = placido_scale_of_kind(&power, 41, 46);
  placido_scale_write(text, sizeof text, &scale, 10);
  assert_string_equal(text, "43.5");
  placido_scale_write(text, sizeof text, &scale, 11);
  assert_string_equal(text, "44.0");
  scale = placido_scale_of_kind(&height, 0, 0);
  placido_scale_write(text, sizeof text, &scale, 10);
  assert_string_equal(text, "−1");
  scale = placido_scale_from_zero(0.19);
  placido_scale_write(text, sizeof text, &scale, 5);
  assert_string_equal(text, "0.10");
}

static void a_scale_from_zero_has_round_steps_and_holds_its_highest(void **state) {
  (void)state;
  const double highs[] = {0.003, 0.1, 0.11, 0.5, 7, 12345};
  for (int k = 0; k < 6; k++) {
    placido_scale scale = placido_scale_from_zero(highs[k]);
    double mantissa = scale.step / pow(10, floor(log10(scale.step) + 1e-9));
    assert_true(fabs(mantissa - 1) < 1e-6 || fabs(mantissa - 2) < 1e-6 ||
                fabs(mantissa - 5) < 1e-6);
    assert_in_range(scale.classes, 2, 10);
    assert_true(scale.classes * scale.step >= highs[k] * (1 - 1e-9));
  }
  assert_in_range(placido_scale_from_zero(0).classes, 2, 10);
  assert_in_range(placido_scale_from_zero(NAN).classes, 2, 10);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbouring_classes_differ_for_every_eye),
      cmocka_unit_test(steep_and_flat_never_look_alike),
      cmocka_unit_test(lightness_falls_away_from_the_middle),
      cmocka_unit_test(the_smallest_fixed_step_that_holds_the_values_is_chosen),
      cmocka_unit_test(powers_are_centred_where_corneas_are),
      cmocka_unit_test(no_elevation_is_the_middle_of_a_class),
      cmocka_unit_test(the_last_classes_are_open),
      cmocka_unit_test(bounds_are_written_with_the_decimals_of_the_scale),
      cmocka_unit_test(a_scale_from_zero_has_round_steps_and_holds_its_highest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
