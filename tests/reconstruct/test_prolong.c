/* A spline carried over to finer knots, and what that is for: fine knots that are asked for on a
 * severe keratoconus, whose fit from the conicoid alone found folds where there are none. */
#include "reconstruct/solve/engine/prolong.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <stdlib.h>
#include <string.h>

#define MERIDIANS 180
#define NOISE_PX 0.02

static double polynomial(double x, double y, int degree) {
  return 0.3 - x + 0.2 * pow(x, degree) - 0.1 * pow(y, degree) + 0.05 * x * x * y;
}

/* Coefficients of a grid for the polynomial are its blossom at each one's knots (Ramshaw 1989): the
 * mean product over them, by elementary symmetric functions. How far off it is on other knots. */
static double worst_of(int degree, double from_mm, double to_mm) {
  const placido_grid from = placido_grid_covering(3, from_mm, degree);
  const placido_grid to = placido_grid_covering(2, to_mm, degree);
  double *known = calloc((size_t)(from.side * from.side), sizeof *known);
  double *found = calloc((size_t)(to.side * to.side), sizeof *found);
  double worst = 0;
  double knots[8], line[64], cubic[64], square[64];
  assert_true(from.side <= 64);
  for (int i = 0; i < from.side; i++) {
    double e[8] = {1};
    for (int k = 0; k < degree; k++) {
      knots[k] = (i - degree + 1 + k) * from_mm - from.half_mm;
      for (int n = degree; n > 0; n--) {
        e[n] += e[n - 1] * knots[k];
      }
    }
    line[i] = e[1] / degree;
    square[i] = e[2] / (degree * (degree - 1) / 2.0);
    cubic[i] = e[degree];
  }
  for (int j = 0; j < from.side; j++) {
    for (int i = 0; i < from.side; i++) {
      known[j * from.side + i] =
          0.3 - line[i] + 0.2 * cubic[i] - 0.1 * cubic[j] + 0.05 * square[i] * line[j];
    }
  }
  assert_int_equal(placido_grid_prolong(found, &to, known, &from, NULL), PLACIDO_OK);
  for (double y = -0.9; y < 1; y += 0.23) {
    for (double x = -0.9; x < 1; x += 0.23) {
      placido_basis basis;
      double out[6];
      assert_true(placido_grid_basis(&to, x, y, &basis));
      placido_grid_value(&to, found, &basis, out);
      worst = fmax(worst, fabs(out[0] - polynomial(x, y, degree)));
    }
  }
  free(known);
  free(found);
  return worst;
}

/* The largest value within 3 mm is about 50 for degree 5; sums of some hundred terms. */
static void test_polynomials_are_carried_over_exactly(void **state) {
  (void)state;
  assert_true(worst_of(5, 0.5, 0.25) < 1e-12);
  assert_true(worst_of(5, 0.5, 0.35) < 1e-12);
  assert_true(worst_of(3, 0.5, 0.3) < 1e-12);
}

/* Error over 6 mm with knots as asked; noise alone leaves 0.01 um (test_fit). */
static double error_um(const char *eye, double knot_mm, placido_notes *notes) {
  placido_instrument instrument;
  placido_surface *truth;
  placido_jet jet;
  placido_fit *fit;
  placido_error err = {0};
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_eye(&truth, eye, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(truth, 0, 0, &jet));
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  const placido_fit_options options = {
      .axis_z_mm = placido_surface_vertex_z_mm(truth) - jet.sag, .knot_mm = knot_mm, .threads = 2};
  int status = placido_fit_new(&fit, &mires, &instrument, &options, notes, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  truth_error error = truth_compare(fit, truth, 0, 6);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_surface_free(truth);
  return error.elevation_um;
}

static void test_fine_knots_find_the_cone(void **state) {
  (void)state;
  assert_true(error_um("keratoconus-severe", 0.25, NULL) < 0.05);
  assert_true(error_um("keratoconus-severe", 0.35, NULL) < 0.05);
}

/* Knots too coarse for the cornea: the program says so. */
static void test_coarse_knots_are_told(void **state) {
  (void)state;
  placido_notes notes = {0};
  error_um("post-prk", 1, &notes);
  bool told = false;
  for (size_t i = 0; i < notes.count && !told; i++) {
    told = strstr(notes.lines[i], "knots this coarse do not fit");
  }
  assert_true(told);
  placido_notes_clear(&notes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_polynomials_are_carried_over_exactly),
      cmocka_unit_test(test_fine_knots_find_the_cone),
      cmocka_unit_test(test_coarse_knots_are_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
