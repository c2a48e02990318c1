/* Orders of convergence of the fit: of the spline in its knots, of Gauss-Newton in its steps. */
#include "order.h"
#include "base/memory.h"
#include "reconstruct/solve/engine/assemble.h"
#include "reconstruct/solve/engine/conic.h"
#include "table.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <stdlib.h>
#include <string.h>

enum { REFINEMENTS = 4 };

/* Something with all derivatives, of the size of one in a few millimetres. */
static void wave_at(double x, double y, double out[6]) {
  double a = 1.1, b = 0.8, s = sin(a * x + b * y + 0.3), c = cos(a * x + b * y + 0.3);
  const double values[6] = {s, a * c, b * c, -a * a * s, -a * b * s, -b * b * s};
  for (int i = 0; i < 6; i++) {
    out[i] = values[i];
  }
}

/* Adds one cell's share of the least squares for exact heights of the wave. */
static void add_cell(placido_normal *normal, const placido_grid *grid, int column, int row) {
  double block[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL] = {0}, right[PLACIDO_SPLINE_CELL] = {0};
  enum { POINTS = 8 }; /* a side */
  for (int p = 0; p < POINTS * POINTS; p++) {
    double x = (column + (p % POINTS + 0.5) / POINTS) * grid->knot_mm - grid->half_mm;
    double y = (row + (p / POINTS + 0.5) / POINTS) * grid->knot_mm - grid->half_mm;
    double values[6], line[PLACIDO_SPLINE_CELL];
    placido_basis basis;
    assert_true(placido_grid_basis(grid, x, y, &basis));
    wave_at(x, y, values);
    for (int k = 0; k < grid->order * grid->order; k++) {
      line[k] = basis.y[0][k / grid->order] * basis.x[0][k % grid->order];
      right[k] += line[k] * values[0];
      for (int m = 0; m <= k; m++) {
        block[k * PLACIDO_SPLINE_CELL + m] += line[k] * line[m];
      }
    }
  }
  placido_normal_add(normal, column, row, block, right);
}

/* The largest errors of value and second derivatives within the inner half. */
static void errors_of(double *value, double *bend, const placido_grid *grid,
                      const double *coefficients) {
  *value = *bend = 0;
  for (double y = -1; y <= 1; y += 0.0317) {
    for (double x = -1; x <= 1; x += 0.0317) {
      placido_basis basis;
      double found[6], exact[6];
      assert_true(placido_grid_basis(grid, x, y, &basis));
      placido_grid_value(grid, coefficients, &basis, found);
      wave_at(x, y, exact);
      *value = fmax(*value, fabs(found[0] - exact[0]));
      for (int k = 3; k < 6; k++) {
        *bend = fmax(*bend, fabs(found[k] - exact[k]));
      }
    }
  }
}

/* Least squares by splines of degree p are off by order knot^(p + 1) in value and by two orders
 * less in the second derivatives (de Boor, A Practical Guide to Splines, XII). The knots go from
 * 0.5 to 0.25 of the wave's radian: the next order's share, (1.36 h)² of the leading one's relative
 * coefficient of some 1/10, bends the slope by a tenth; how knots fall on the places where the
 * error is largest by some hundredths more: a third of an order. */
static void the_spline_converges(int degree, const char *value_name, const char *bend_name) {
  static const double knots_mm[REFINEMENTS] = {0.5, 0.4, 0.3125, 0.25};
  double values[REFINEMENTS], bends[REFINEMENTS];
  for (int i = 0; i < REFINEMENTS; i++) {
    placido_grid grid = placido_grid_covering(2.5, knots_mm[i], degree);
    size_t n = (size_t)grid.side * (size_t)grid.side;
    double *coefficients = calloc(n, sizeof *coefficients);
    placido_normal *normal;
    assert_int_equal(placido_normal_new(&normal, &grid, NULL), PLACIDO_OK);
    placido_normal_clear(normal);
    for (int row = 0; row < grid.cells; row++) {
      for (int column = 0; column < grid.cells; column++) {
        add_cell(normal, &grid, column, row);
      }
    }
    assert_int_equal(placido_normal_solve(normal, 0, coefficients, NULL), PLACIDO_OK);
    errors_of(&values[i], &bends[i], &grid, coefficients);
    placido_normal_free(normal);
    free(coefficients);
  }
  order_add(value_name, knots_mm, values, REFINEMENTS, degree + 1, 0.35);
  order_add(bend_name, knots_mm, bends, REFINEMENTS, degree - 1, 0.35);
}

static void splines_converge_as_their_degree_says(void **state) {
  (void)state;
  the_spline_converges(5, "quintic spline, value by knots", "quintic spline, second derivative");
  the_spline_converges(3, "cubic spline, value by knots", "cubic spline, second derivative");
}

/* The whole fit to exact points of a cone, 1.25 mm wide. Mires tell slopes: a cubic spline's are of
 * order knot³, and axial power with them. Elevation, in which slopes' errors cancel from knot to
 * knot, is an order better where mires are dense among the knots, as they are for the quintic
 * spline: knot⁶. How knots fall about the cone changes a single error by some 30 %, over knots that
 * go down to a half that is up to 0.3 of an order either way at both ends: 0.6 is allowed. */
static void the_fit_converges(const placido_instrument *instrument,
                              const placido_surface *eye, const placido_mires *points, int degree,
                              const char *name) {
  static const double knots_mm[REFINEMENTS] = {0.7, 0.56, 0.44, 0.35};
  double errors[REFINEMENTS];
  placido_jet jet;
  assert_true(placido_surface_at(eye, 0, 0, &jet));
  for (int i = 0; i < REFINEMENTS; i++) {
    const placido_fit_options options = {
        .axis_z_mm = placido_surface_vertex_z_mm(eye) - jet.sag,
        .knot_mm = knots_mm[i],
        .smoothing = 1, /* out of the way */
        .degree = degree,
        .tolerance = 1e-4};
    placido_mires mires = *points; /* a fit marks points */
    placido_fit *fit;
    mires.points = calloc(mires.count, sizeof *mires.points);
    memcpy(mires.points, points->points, mires.count * sizeof *mires.points);
    assert_int_equal(placido_fit_new(&fit, &mires, instrument, &options, NULL, NULL), PLACIDO_OK);
    truth_error error = truth_compare(fit, eye, 0, 6);
    errors[i] = degree == 5 ? error.elevation_um : error.axial_D;
    placido_fit_free(fit);
    free(mires.points);
  }
  order_add(name, knots_mm, errors, REFINEMENTS, degree == 5 ? 6 : 3, 0.6);
}

static void fits_converge_as_their_splines(void **state) {
  (void)state;
  placido_instrument instrument;
  placido_surface *eye;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_eye(&eye, "keratoconus", NULL), PLACIDO_OK);
  placido_mires points = truth_points(eye, &instrument, 120, 0, NULL);
  the_fit_converges(&instrument, eye, &points, 5, "quintic fit to a cone's mires, elevation");
  the_fit_converges(&instrument, eye, &points, 3, "cubic fit to a cone's mires, axial power");
  placido_mires_free(&points);
  placido_surface_free(eye);
}

/* A fit under way to the points of an eye, on knots of half a millimetre. */
struct iteration {
  placido_instrument instrument;
  placido_surface *eye;
  placido_mires mires;
  placido_sample *samples;
  placido_sightlines rays;
  placido_grid grid;
  placido_refinement r;
};

static void begin(struct iteration *it, const char *eye, double noise_px, double smoothing,
                  double base_mm) {
  placido_jet jet;
  placido_conicoid base;
  assert_int_equal(placido_phantom_instrument(&it->instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_eye(&it->eye, eye, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(it->eye, 0, 0, &jet));
  double axis_z_mm = placido_surface_vertex_z_mm(it->eye) - jet.sag;
  it->mires = truth_points(it->eye, &it->instrument, 72, noise_px, NULL);
  assert_int_equal(placido_samples_new(&it->samples, &it->mires, &it->instrument, axis_z_mm, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_sightlines_new(&it->rays, it->samples, it->mires.count, NULL),
                   PLACIDO_OK);
  if (base_mm > 0) {
    base = (placido_conicoid){base_mm, 0, 0, 0, axis_z_mm};
  } else {
    assert_int_equal(placido_conic_fit(&base, &it->rays, axis_z_mm, 1, NULL), PLACIDO_OK);
  }
  it->grid = placido_grid_covering(5.2, 0.5, 5);
  assert_int_equal(placido_refinement_new(&it->r, &base, &it->grid, &it->rays, smoothing, 1, 1,
                                          NULL),
                   PLACIDO_OK);
}

static void end(struct iteration *it) {
  placido_refinement_free(&it->r);
  placido_sightlines_free(&it->rays);
  placido_memory_free(it->samples);
  placido_mires_free(&it->mires);
  placido_surface_free(it->eye);
}

/* Root mean square. */
static double distance(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return sqrt(sum / (double)count);
}

/* Takes single steps; apart[k] is the root mean square of what residuals lack after step k from
 * those after the last one, over sigma_px. */
static void steps(struct iteration *it, double *apart, int count) {
  const double *residual_px = it->r.rays->numbers[PLACIDO_RAY_RESIDUAL_PX];
  size_t n = it->mires.count;
  double *all = calloc(n * (size_t)(count + 1), sizeof *all);
  for (int k = 0; k <= count; k++) {
    assert_int_equal(placido_refinement_run(&it->r, 1, NULL), PLACIDO_OK);
    for (size_t i = 0; i < n; i++) {
      all[(size_t)k * n + i] = residual_px[i];
    }
  }
  for (int k = 0; k < count; k++) {
    apart[k] = distance(all + (size_t)k * n, all + (size_t)count * n, n) / it->r.sigma_px;
  }
  free(all);
}

/* Where points leave no residuals Gauss-Newton is Newton's method: what a step leaves is of the
 * square of what it starts from. Starts lie on the way from the solution to a sphere that is much
 * too steep, where rays are off by some 10 px; a quarter for what the third order adds at the
 * farthest, and what weights that lag behind (below) and the knots' own residuals of 1e-4 px leave
 * of the nearest. */
static void exact_points_are_met_quadratically(void **state) {
  (void)state;
  static const double shares[REFINEMENTS] = {0.4, 0.28, 0.2, 0.14};
  struct iteration it = {0};
  double far[REFINEMENTS], left[REFINEMENTS], apart[8];
  begin(&it, "normal", 0, 1, 7);
  steps(&it, apart, 8);
  size_t n = (size_t)it.grid.side * (size_t)it.grid.side, rays = it.mires.count;
  const double *residual_px = it.rays.numbers[PLACIDO_RAY_RESIDUAL_PX];
  double *solution = calloc(n, sizeof *solution), *last = calloc(rays, sizeof *last);
  memcpy(solution, it.r.coefficients, n * sizeof *solution);
  memcpy(last, residual_px, rays * sizeof *last);
  for (int k = 0; k < REFINEMENTS; k++) {
    for (size_t i = 0; i < n; i++) {
      it.r.coefficients[i] = (1 - shares[k]) * solution[i];
    }
    it.r.traced = false;
    placido_refinement_trace(&it.r);
    far[k] = distance(residual_px, last, rays);
    assert_int_equal(placido_refinement_run(&it.r, 1, NULL), PLACIDO_OK);
    left[k] = distance(residual_px, last, rays);
  }
  order_add("Gauss-Newton on exact points, a step", far, left, REFINEMENTS, 2, 0.25);
  free(solution);
  free(last);
  end(&it);
}

/* With noise the weights w = 1 / sqrt(1 + r²/9) of residuals r (in sigmas), which lag a step
 * behind, make it linear: the pseudo-Huber loss has the second derivative w³ and the step takes w
 * for it, so that of an error (JᵀwJ)⁻¹ Jᵀ(w - w³)J is left. Its largest eigenvalue, which is what
 * steps come down to, lies below the largest 1 - w² of a point, and above the mean, 0.08 for normal
 * noise. The slope of one error over the one before is 1 but for what other modes still add at the
 * first of these steps. */
static void noisy_points_are_met_linearly(void **state) {
  (void)state;
  enum { STEPS = 12, FIRST = 4, LAST = 10 };
  struct iteration it = {0};
  double apart[STEPS], most = 0;
  begin(&it, "irregular", 0.05, 1e3, 0);
  steps(&it, apart, STEPS);
  for (size_t i = 0; i < it.mires.count; i++) {
    double r = it.rays.numbers[PLACIDO_RAY_RESIDUAL_PX][i] / it.r.sigma_px;
    most = fmax(most, r * r / (9 + r * r));
  }
  double found = pow(apart[LAST] / apart[FIRST], 1.0 / (LAST - FIRST));
  order_add("Gauss-Newton on noisy points, by step", apart + FIRST, apart + FIRST + 1, LAST - FIRST,
            1, 0.15);
  stability_add(&(struct stability_row){.name = "Gauss-Newton on noisy points, contraction",
                                        .condition = NAN,
                                        .perturbation = 0.05,
                                        .in_unit = "px noise",
                                        .change = found,
                                        .out_unit = "a step",
                                        .bound = most,
                                        .extended = NAN});
  assert_true(found > 0.08);
  end(&it);
}

static void all_orders_are_as_expected(void **state) {
  (void)state;
  assert_int_equal(stability_print("Orders of convergence: fit"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(splines_converge_as_their_degree_says),
      cmocka_unit_test(fits_converge_as_their_splines),
      cmocka_unit_test(exact_points_are_met_quadratically),
      cmocka_unit_test(noisy_points_are_met_linearly),
      cmocka_unit_test(all_orders_are_as_expected),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
