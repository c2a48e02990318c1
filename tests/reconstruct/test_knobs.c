/* The fit's knobs: the spline's degree, and when Gauss-Newton ends. */
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MERIDIANS 90
#define NOISE_PX 0.02 /* of an edge in a good picture */

static placido_instrument cone(void) {
  placido_instrument instrument;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  return instrument;
}

static placido_surface *eye_of(const char *name) {
  placido_surface *eye;
  assert_int_equal(placido_phantom_eye(&eye, name, NULL), PLACIDO_OK);
  return eye;
}

static double axis_z_of(const placido_surface *surface) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, 0, 0, &jet));
  return placido_surface_vertex_z_mm(surface) - jet.sag;
}

/* An eye and exact points of it, which take longer than a fit. */
struct sight {
  placido_instrument instrument;
  placido_surface *eye;
  placido_mires exact, noisy;
};

static struct sight look_at(const char *name) {
  struct sight s = {.instrument = cone(), .eye = eye_of(name)};
  s.exact = truth_points(s.eye, &s.instrument, MERIDIANS, 0, NULL);
  s.noisy = truth_points(s.eye, &s.instrument, MERIDIANS, NOISE_PX, NULL);
  return s;
}

static void look_away(struct sight *s) {
  placido_surface_free(s->eye);
  placido_mires_free(&s->exact);
  placido_mires_free(&s->noisy);
}

/* The fit to some points with these options, at the eye's distance. */
static placido_fit *fit_of(const struct sight *s, const placido_mires *points,
                           placido_fit_options options) {
  placido_mires mires = *points; /* a fit marks points */
  placido_fit *fit;
  placido_error err = {0};
  mires.points = calloc(mires.count, sizeof *mires.points);
  memcpy(mires.points, points->points, mires.count * sizeof *mires.points);
  options.axis_z_mm = axis_z_of(s->eye);
  options.threads = 1;
  int status = placido_fit_new(&fit, &mires, &s->instrument, &options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  free(mires.points);
  return fit;
}

static void assert_same_bits(const placido_fit *a, const placido_fit *b) {
  for (double at = -3; at < 3; at += 0.37) {
    placido_jet one, other;
    assert_true(placido_surface_at(placido_fit_surface(a), at, 0.4 * at, &one));
    assert_true(placido_surface_at(placido_fit_surface(b), at, 0.4 * at, &other));
    assert_memory_equal(&one, &other, sizeof one);
  }
}

/* The rms difference of two fits within 6 mm over the first one's sigma of height. */
static double apart(const placido_fit *a, const placido_fit *b) {
  double sum = 0;
  int n = 0;
  for (double y = -3; y <= 3; y += 0.25) {
    for (double x = -3; x <= 3; x += 0.25) {
      placido_jet one, other;
      double sigma_um, sigma_D;
      placido_fit_sigma_at(a, x, y, &sigma_um, &sigma_D);
      if (hypot(x, y) < 3 && hypot(x, y) > 0.5) {
        assert_true(placido_surface_at(placido_fit_surface(a), x, y, &one));
        assert_true(placido_surface_at(placido_fit_surface(b), x, y, &other));
        sum += pow(1e3 * (one.sag - other.sag) / sigma_um, 2);
        n++;
      }
    }
  }
  return sqrt(sum / n);
}

/* A cubic spline of the usual knots follows ordinary eyes to a fraction of their noise, and what it
 * claims covers its error as that of the quintic one does: one draw scatters by 15 %. */
static void a_cubic_spline_s_error_bars_cover_its_error(void **state) {
  (void)state;
  static const char *const eyes[] = {"normal", "irregular"};
  for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
    struct sight s = look_at(eyes[i]);
    placido_fit *cubic = fit_of(&s, &s.noisy, (placido_fit_options){.degree = 3});
    placido_fit *quintic = fit_of(&s, &s.noisy, (placido_fit_options){.degree = 5});
    truth_error e = truth_compare(cubic, s.eye, 0, 8);
    print_message("%s: %.4f um, over sigma %.2f; %.2f sigma from the quintic one\n", eyes[i],
                  e.elevation_um, e.over_sigma, apart(quintic, cubic));
    assert_true(e.over_sigma > 0.7 && e.over_sigma < 1.4);
    assert_true(e.covered > 0.97);
    assert_true(apart(quintic, cubic) < 0.5);
    placido_fit_free(cubic);
    placido_fit_free(quintic);
    look_away(&s);
  }
}

/* A cone is finer than the usual knots for a cubic spline. Its error goes with knot⁴: half of them
 * make it 16 times smaller where the smoothing leaves it alone; a quarter of that is asked for. */
static void finer_knots_help_a_cubic_spline(void **state) {
  (void)state;
  struct sight s = look_at("keratoconus");
  double error_um[2];
  for (int i = 0; i < 2; i++) {
    const placido_fit_options options = {.degree = 3, .knot_mm = i ? 0.25 : 0.5};
    placido_fit *fit = fit_of(&s, &s.exact, options);
    error_um[i] = truth_compare(fit, s.eye, 0, 6).elevation_um;
    placido_fit_free(fit);
  }
  print_message("%.4f um, %.4f um\n", error_um[0], error_um[1]);
  assert_true(error_um[1] < error_um[0] / 4);
  look_away(&s);
}

/* The file of a cubic fit's surface reads back as the surface. */
static void a_cubic_surface_is_saved(void **state) {
  (void)state;
  const char *path = "test_knobs.surface.json";
  struct sight s = look_at("irregular");
  placido_surface *loaded;
  placido_fit *fit = fit_of(&s, &s.noisy, (placido_fit_options){.degree = 3});
  assert_int_equal(placido_surface_save(placido_fit_surface(fit), path, NULL), PLACIDO_OK);
  assert_int_equal(placido_surface_load(&loaded, path, NULL, NULL), PLACIDO_OK);
  for (double at = -3; at < 3; at += 0.37) {
    placido_jet one, other;
    assert_true(placido_surface_at(placido_fit_surface(fit), at, 0.4 * at, &one));
    assert_true(placido_surface_at(loaded, at, 0.4 * at, &other));
    assert_memory_equal(&one, &other, sizeof one);
  }
  remove(path);
  placido_surface_free(loaded);
  placido_fit_free(fit);
  look_away(&s);
}

/* A start of the same degree saves steps; one of another degree is passed over, as is another knot
 * spacing. */
static void a_start_of_another_degree_is_passed_over(void **state) {
  (void)state;
  struct sight s = look_at("irregular");
  placido_fit *quintic = fit_of(&s, &s.noisy, (placido_fit_options){.degree = 5});
  placido_fit *cubic = fit_of(&s, &s.noisy, (placido_fit_options){.degree = 3});
  placido_fit *from_quintic =
      fit_of(&s, &s.noisy, (placido_fit_options){.degree = 3, .start = quintic});
  placido_fit *from_cubic =
      fit_of(&s, &s.noisy, (placido_fit_options){.degree = 3, .start = cubic});
  assert_same_bits(cubic, from_quintic);
  assert_true(placido_fit_summary_get(from_cubic).steps < placido_fit_summary_get(cubic).steps);
  assert_true(apart(cubic, from_cubic) < 0.2);
  placido_fit_free(quintic);
  placido_fit_free(cubic);
  placido_fit_free(from_quintic);
  placido_fit_free(from_cubic);
  look_away(&s);
}

/* The last step moves residuals by less than the tolerance, in units of their noise, in the root
 * mean square over N points; those over U unknowns, whose share of the noise is sqrt(U / N), by
 * tolerance · sqrt(N / U) of their own sigmas. Here that root is 3: 4320 points, some 480 unknowns
 * in reach of them. Finer ones take more steps. */
static void a_tolerance_is_kept(void **state) {
  (void)state;
  static const double tolerances[] = {0.5, 0.05, 1e-3, 1e-5};
  struct sight s = look_at("irregular");
  placido_fit *usual = fit_of(&s, &s.noisy, (placido_fit_options){0});
  placido_fit *finest = fit_of(&s, &s.noisy, (placido_fit_options){.tolerance = 1e-6});
  placido_fit_summary summary = placido_fit_summary_get(finest);
  int before = 0;
  for (size_t i = 0; i < sizeof tolerances / sizeof tolerances[0]; i++) {
    placido_fit *fit = fit_of(&s, &s.noisy, (placido_fit_options){.tolerance = tolerances[i]});
    int steps = placido_fit_summary_get(fit).steps;
    double off = apart(finest, fit);
    print_message("tolerance %g: %d steps, %.2g sigma off\n", tolerances[i], steps, off);
    assert_true(off <= 3 * tolerances[i]);
    assert_true(steps >= before);
    before = steps;
    placido_fit_free(fit);
  }
  print_message("usual: %d steps, %.2g sigma off; finest: %d steps\n",
                placido_fit_summary_get(usual).steps, apart(finest, usual), summary.steps);
  assert_true(apart(finest, usual) < 0.1);
  assert_true(summary.steps >= before);
  placido_fit_free(usual);
  placido_fit_free(finest);
  look_away(&s);
}

static void other_degrees_and_tolerances_are_refused(void **state) {
  (void)state;
  static const placido_fit_options wrong[] = {
      {.degree = 4}, {.degree = 1}, {.degree = -3}, {.degree = 7},
      {.tolerance = 1e-7}, {.tolerance = 1.5}, {.tolerance = -0.1}, {.tolerance = NAN}};
  placido_instrument instrument = cone();
  placido_surface *eye = eye_of("normal");
  placido_mires mires = truth_points(eye, &instrument, 24, NOISE_PX, NULL);
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    placido_fit *fit;
    placido_error err = {0};
    assert_int_equal(placido_fit_new(&fit, &mires, &instrument, &wrong[i], NULL, &err),
                     PLACIDO_INPUT);
    assert_null(fit);
    assert_true(strstr(err.text, "expected") != NULL);
  }
  placido_mires_free(&mires);
  placido_surface_free(eye);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cubic_spline_s_error_bars_cover_its_error),
      cmocka_unit_test(finer_knots_help_a_cubic_spline),
      cmocka_unit_test(a_cubic_surface_is_saved),
      cmocka_unit_test(a_start_of_another_degree_is_passed_over),
      cmocka_unit_test(a_tolerance_is_kept),
      cmocka_unit_test(other_degrees_and_tolerances_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
