/* The fit on edge points that the phantom's exact forward trace gives: nothing that the fit
 * itself wrote. */
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <stdlib.h>

#define MERIDIANS 180
#define NOISE_PX 0.02 /* of an edge in a good picture */

static placido_instrument cone(void) {
  placido_instrument instrument;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  return instrument;
}

static placido_surface *conicoid(double r, double q, double cx, double cy) {
  placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {r, q, r, q, 0, cx, cy}};
  placido_surface *surface;
  placido_jet jet;
  assert_int_equal(placido_surface_new(&surface, 0, 6, &part, 1, NULL, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(surface, 0, 0, &jet));
  return surface;
}

static double axis_z_of(const placido_surface *surface) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, 0, 0, &jet));
  return placido_surface_vertex_z_mm(surface) - jet.sag;
}

static placido_fit *fit_of(placido_mires *mires, const placido_instrument *instrument,
                           double axis_z_mm, double sigma_mm) {
  placido_fit *fit;
  placido_error err = {0};
  placido_fit_options options = {.axis_z_mm = axis_z_mm, .axis_z_sigma_mm = sigma_mm, .threads = 2};
  int status = placido_fit_new(&fit, mires, instrument, &options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  return fit;
}

/* Exact points of eyes that the start does not resemble: what is left is the spline's own error,
 * far below what noise adds to any picture. */
static void exact_points_give_the_surface_back(void **state) {
  (void)state;
  static const struct {
    const char *eye;
    double elevation_um, axial_D;
  } eyes[] = {
      {"sphere", 1e-3, 1e-3},
      {"normal", 1e-3, 1e-3},
      {"astigmatic", 2e-3, 1e-3},
      {"decentred", 1e-3, 1e-3},
      {"irregular", 5e-3, 2e-3},
      {"keratoconus", 1e-2, 5e-3},
  };
  placido_instrument instrument = cone();
  for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
    placido_surface *truth;
    assert_int_equal(placido_phantom_eye(&truth, eyes[i].eye, NULL), PLACIDO_OK);
    placido_mires mires = truth_points(truth, &instrument, MERIDIANS, 0, NULL);
    placido_fit *fit = fit_of(&mires, &instrument, axis_z_of(truth), 0);
    truth_error e = truth_compare(fit, truth, 0, 8);
    print_message("%s: %.5f um, %.5f D, %.3f covered\n", eyes[i].eye, e.elevation_um, e.axial_D,
                  e.covered);
    assert_true(e.elevation_um < eyes[i].elevation_um);
    assert_true(e.axial_D < eyes[i].axial_D);
    assert_true(e.covered > 0.97);
    placido_fit_free(fit);
    placido_mires_free(&mires);
    placido_surface_free(truth);
  }
}

/* With independent noise the error over its claimed sigma is of order one: rms over the map of one
 * draw scatters by some 15 %, as only the spline's few tens of free modes under the map are
 * independent. */
static void error_bars_cover_the_error(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_surface *truth = conicoid(7.6, -0.3, 0.1, -0.2);
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  placido_fit *fit = fit_of(&mires, &instrument, axis_z_of(truth), 0);
  placido_fit_summary summary = placido_fit_summary_get(fit);
  truth_error e = truth_compare(fit, truth, 0, 8);
  assert_near(summary.sigma_px, NOISE_PX, 0.05 * NOISE_PX);
  print_message("error over sigma %.2f\n", e.over_sigma);
  assert_true(e.over_sigma > 0.7 && e.over_sigma < 1.4);
  assert_true(e.elevation_um < 0.02);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

static bool in_the_nose(int edge, double deg) {
  return edge > 20 && deg > 170 && deg < 240;
}

/* A hidden sector is not covered, its border is not the worse for it, and nothing is claimed in it.
 */
static void hidden_mires_leave_a_hole(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_surface *truth;
  assert_int_equal(placido_phantom_eye(&truth, "keratoconus", NULL), PLACIDO_OK);
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, in_the_nose);
  placido_fit *fit = fit_of(&mires, &instrument, axis_z_of(truth), 0);
  const placido_surface *found = placido_fit_surface(fit);
  truth_error e = truth_compare(fit, truth, 0, 8);
  assert_true(e.elevation_um < 0.05);
  assert_false(placido_surface_covered(found, 3.5 * cos(3.6), 3.5 * sin(3.6)));
  assert_true(placido_surface_covered(found, 3.5 * cos(1), 3.5 * sin(1)));
  assert_true(placido_surface_covered(found, 0, 0));
  assert_true(e.covered > 0.8 && e.covered < 0.95);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

/* One point in a hundred numbered two mires too far out: found and set aside. */
static void wrong_numbers_are_set_aside(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_surface *truth = conicoid(7.8, -0.2, 0, 0);
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  size_t planted = 0;
  for (size_t i = 50; i < mires.count; i += 101) {
    mires.points[i].u_px += 15;
    planted++;
  }
  placido_fit *fit = fit_of(&mires, &instrument, 0, 0);
  truth_error e = truth_compare(fit, truth, 0, 8);
  assert_true(e.elevation_um < 0.02);
  size_t caught = 0;
  for (size_t i = 50; i < mires.count; i += 101) {
    caught += !mires.points[i].used;
  }
  /* where the mire runs along u, 15 px of u hardly leave it: those are harmless */
  assert_true(caught > 0.85 * (double)planted);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

/* Every edge turned by 40 degrees about the axis: the surface turns with them. */
static void a_turned_eye_gives_a_turned_surface(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  instrument.principal_px[0] = 640;
  instrument.principal_px[1] = 512;
  placido_part part = {.kind = PLACIDO_PART_BICONIC,
                       .as.biconic = {7.9, -0.1, 7.4, -0.3, 20, 0, 0}};
  placido_surface *straight, *turned;
  assert_int_equal(placido_surface_new(&straight, 0, 6, &part, 1, NULL, NULL), PLACIDO_OK);
  part.as.biconic.axis_deg += 40;
  assert_int_equal(placido_surface_new(&turned, 0, 6, &part, 1, NULL, NULL), PLACIDO_OK);
  placido_mires a = truth_points(straight, &instrument, MERIDIANS, 0, NULL);
  placido_mires b = truth_points(turned, &instrument, MERIDIANS, 0, NULL);
  placido_fit *fit_a = fit_of(&a, &instrument, 0, 0), *fit_b = fit_of(&b, &instrument, 0, 0);
  double angle = 40 * M_PI / 180, worst = 0;
  for (double r = 0.5; r < 4; r += 0.5) {
    for (double phi = 0; phi < 6.2; phi += 0.3) {
      placido_jet ja, jb;
      assert_true(placido_surface_at(placido_fit_surface(fit_a), r * cos(phi), r * sin(phi), &ja));
      assert_true(placido_surface_at(placido_fit_surface(fit_b), r * cos(phi + angle),
                                     r * sin(phi + angle), &jb));
      double z = placido_surface_vertex_z_mm(placido_fit_surface(fit_a)) - ja.sag;
      double w = placido_surface_vertex_z_mm(placido_fit_surface(fit_b)) - jb.sag;
      worst = fmax(worst, fabs(z - w));
    }
  }
  assert_true(worst < 5e-6); /* mm: both are off the truth by some nanometres of their own */
  placido_fit_free(fit_a);
  placido_fit_free(fit_b);
  placido_mires_free(&a);
  placido_mires_free(&b);
  placido_surface_free(straight);
  placido_surface_free(turned);
}

/* A distance 0.1 mm wrong is invisible in the residual, biases the power, and the error bars say
 * so when they are told. */
static void the_distance_s_uncertainty_is_carried_on(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_surface *truth = conicoid(7.8, -0.2, 0, 0);
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, 0, NULL);
  placido_fit *right = fit_of(&mires, &instrument, 0, 0.1);
  double sigma_um, sigma_D;
  placido_fit_sigma_at(right, 2, 1, &sigma_um, &sigma_D);
  placido_fit *wrong = fit_of(&mires, &instrument, 0.1, 0);
  placido_jet a, b;
  assert_true(placido_surface_at(placido_fit_surface(right), 2, 1, &a));
  assert_true(placido_surface_at(placido_fit_surface(wrong), 2, 1, &b));
  double r = hypot(2, 1), sa = (2 * a.sx + a.sy) / r, sb = (2 * b.sx + b.sy) / r;
  double bias_D = 337.5 / r * (sb / sqrt(1 + sb * sb) - sa / sqrt(1 + sa * sa));
  assert_true(placido_fit_summary_get(wrong).rms_px < 0.01);
  assert_true(fabs(bias_D) > 0.05);
  assert_near(sigma_D, fabs(bias_D), 0.05 * fabs(bias_D));
  placido_fit_free(right);
  placido_fit_free(wrong);
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

static void what_cannot_be_a_cornea_is_refused(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_surface *truth = conicoid(7.8, -0.2, 0, 0);
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  placido_fit *fit;
  placido_error err = {0};
  placido_fit_options options = {.threads = 1};
  size_t count = mires.count;
  mires.count = 150;
  assert_int_equal(placido_fit_new(&fit, &mires, &instrument, &options, NULL, &err),
                   PLACIDO_QUALITY);
  assert_null(fit);
  mires.count = count;
  for (size_t i = 0; i < count; i++) { /* every point somewhere else */
    mires.points[i].u_px = 400 + (double)((i * 7919) % 480);
    mires.points[i].v_px = 300 + (double)((i * 104729) % 420);
  }
  assert_int_equal(placido_fit_new(&fit, &mires, &instrument, &options, NULL, &err),
                   PLACIDO_QUALITY);
  assert_null(fit);
  assert_true(err.text[0] != '\0');
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

/* An impossible distance or knots beyond reason end in a sentence, not in a surface. */
static void absurd_options_are_refused(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_surface *truth = conicoid(7.8, -0.2, 0, 0);
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  static const struct {
    placido_fit_options options;
    int status;
  } cases[] = {
      {{.axis_z_mm = 50}, PLACIDO_QUALITY},
      {{.axis_z_mm = -60}, PLACIDO_QUALITY},
      {{.knot_mm = 0.1}, PLACIDO_INPUT},
      {{.knot_mm = NAN}, PLACIDO_INPUT},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    placido_fit *fit;
    assert_int_equal(placido_fit_new(&fit, &mires, &instrument, &cases[i].options, NULL, NULL),
                     cases[i].status);
    assert_null(fit);
  }
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

static void threads_change_no_bit(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_surface *truth;
  assert_int_equal(placido_phantom_eye(&truth, "keratoconus", NULL), PLACIDO_OK);
  placido_jet first;
  for (int threads = 1; threads <= 4; threads *= 2) {
    placido_mires mires = truth_points(truth, &instrument, 90, NOISE_PX, NULL);
    placido_fit *fit;
    placido_fit_options options = {.axis_z_mm = axis_z_of(truth), .threads = threads};
    assert_int_equal(placido_fit_new(&fit, &mires, &instrument, &options, NULL, NULL), PLACIDO_OK);
    placido_jet jet;
    assert_true(placido_surface_at(placido_fit_surface(fit), 1.3, -0.7, &jet));
    if (threads == 1) {
      first = jet;
    }
    assert_memory_equal(&jet, &first, sizeof jet);
    placido_fit_free(fit);
    placido_mires_free(&mires);
  }
  placido_surface_free(truth);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exact_points_give_the_surface_back),
      cmocka_unit_test(error_bars_cover_the_error),
      cmocka_unit_test(hidden_mires_leave_a_hole),
      cmocka_unit_test(wrong_numbers_are_set_aside),
      cmocka_unit_test(a_turned_eye_gives_a_turned_surface),
      cmocka_unit_test(the_distance_s_uncertainty_is_carried_on),
      cmocka_unit_test(what_cannot_be_a_cornea_is_refused),
      cmocka_unit_test(absurd_options_are_refused),
      cmocka_unit_test(threads_change_no_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
