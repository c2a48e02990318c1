/* The spline, the normal equations and the order statistics on their own. */
#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/engine/normal.h"
#include "reconstruct/solve/engine/sightlines.h"
#include "tests/support/near.h"

#include <stdlib.h>

static double wave(int i) {
  return sin(1.7 * i + 0.3 * i * i);
}

static void check_derivatives(int degree) {
  placido_grid grid = placido_grid_covering(2, 0.4, degree);
  double *c = calloc((size_t)(grid.side * grid.side), sizeof *c);
  for (int i = 0; i < grid.side * grid.side; i++) {
    c[i] = wave(i);
  }
  double x = 0.73, y = -1.11, e = 1e-5, here[6], near[4][6];
  const double moves[4][2] = {{e, 0}, {-e, 0}, {0, e}, {0, -e}};
  placido_basis basis;
  assert_true(placido_grid_basis(&grid, x, y, &basis));
  placido_grid_value(&grid, c, &basis, here);
  for (int i = 0; i < 4; i++) {
    assert_true(placido_grid_basis(&grid, x + moves[i][0], y + moves[i][1], &basis));
    placido_grid_value(&grid, c, &basis, near[i]);
  }
  /* the differences' own error is third derivative · e² / 6, some 1e-8 here */
  assert_near(here[1], (near[0][0] - near[1][0]) / (2 * e), 1e-6);
  assert_near(here[2], (near[2][0] - near[3][0]) / (2 * e), 1e-6);
  assert_near(here[3], (near[0][1] - near[1][1]) / (2 * e), 1e-6);
  assert_near(here[4], (near[0][2] - near[1][2]) / (2 * e), 1e-6);
  assert_near(here[5], (near[2][2] - near[3][2]) / (2 * e), 1e-6);
  free(c);
}

static void the_spline_s_derivatives_agree_with_differences(void **state) {
  (void)state;
  check_derivatives(5);
  check_derivatives(3);
}

static void check_sums(int degree) {
  placido_grid grid = placido_grid_covering(1.9, 0.35, degree);
  assert_true(grid.half_mm >= 1.9);
  placido_basis basis;
  for (double x = -grid.half_mm; x <= grid.half_mm; x += grid.half_mm / 7) {
    assert_true(placido_grid_basis(&grid, x, grid.half_mm, &basis));
    double sum = 0, slope = 0;
    for (int i = 0; i < PLACIDO_SPLINE_ORDER; i++) {
      sum += basis.x[0][i];
      slope += basis.x[1][i];
    }
    assert_near(sum, 1, 1e-14);
    assert_near(slope, 0, 1e-12);
  }
  assert_false(placido_grid_basis(&grid, grid.half_mm * 1.0001, 0, &basis));
  assert_false(placido_grid_basis(&grid, NAN, 0, &basis));
}

static void the_basis_sums_to_one_up_to_the_border(void **state) {
  (void)state;
  check_sums(5);
  check_sums(3);
}

/* A cell's polynomial is the spline in it. */
static void check_polynomial(int degree) {
  placido_grid grid = placido_grid_covering(2, 0.4, degree);
  double *c = calloc((size_t)(grid.side * grid.side), sizeof *c);
  for (int i = 0; i < grid.side * grid.side; i++) {
    c[i] = wave(i);
  }
  for (double at = -1.93; at < 2; at += 0.31) {
    int column, row;
    double x, y, polynomial[PLACIDO_SPLINE_CELL], value[6], sum = 0;
    placido_basis basis;
    assert_true(placido_grid_locate(&grid, at, 0.7 * at, &column, &row, &x, &y));
    assert_true(placido_grid_basis(&grid, at, 0.7 * at, &basis));
    assert_int_equal(basis.column, column);
    assert_int_equal(basis.row, row);
    placido_grid_value(&grid, c, &basis, value);
    placido_grid_polynomial(&grid, c, column, row, polynomial);
    for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
      sum += polynomial[k] * pow(y, k / PLACIDO_SPLINE_ORDER) * pow(x, k % PLACIDO_SPLINE_ORDER);
    }
    assert_near(sum, value[0], 1e-14);
  }
  free(c);
}

static void the_cell_s_polynomial_is_the_spline(void **state) {
  (void)state;
  check_polynomial(5);
  check_polynomial(3);
}

/* Some rays onto a bowl, all around and beyond the spline. */
static void make_samples(placido_sample *samples, size_t count, const placido_edge *edge) {
  for (size_t i = 0; i < count; i++) {
    double x = 2.4 * wave((int)i), y = 2.4 * wave((int)i + 500);
    samples[i] = (placido_sample){.ray = {.origin = {x, y, 100},
                                          .direction = {-0.002 * x, -0.001 * y, -1},
                                          .direction_u = {1e-4, 0, 0},
                                          .direction_v = {0, -1e-4, 0}},
                                  .edge = edge,
                                  .point = i,
                                  .t = 100,
                                  .used = true,
                                  .noise = 1};
  }
}

/* All rays at once find what each of them finds alone, and one that misses is no number. */
static void a_bundle_is_its_rays(void **state) {
  (void)state;
  enum { COUNT = 300 };
  static placido_sample together[COUNT], alone[COUNT];
  const placido_edge edge = {.radius_mm = 20, .z_mm = 50};
  const placido_conicoid base = {7.8, -0.2, 0.1, -0.1, 0};
  const placido_part part = {.kind = PLACIDO_PART_BICONIC,
                             .as.biconic = {7.8, -0.2, 7.8, -0.2, 0, 0.1, -0.1}};
  placido_grid grid = placido_grid_covering(1.8, 0.4, PLACIDO_SPLINE_DEGREE);
  double *c = calloc((size_t)(grid.side * grid.side), sizeof *c);
  for (int i = 0; i < grid.side * grid.side; i++) {
    c[i] = 1e-3 * wave(i);
  }
  placido_surface *surface;
  placido_sightlines sightlines;
  assert_int_equal(placido_surface_new(&surface, 0, 9, &part, 1, NULL, NULL), PLACIDO_OK);
  make_samples(together, COUNT, &edge);
  make_samples(alone, COUNT, &edge);
  assert_int_equal(placido_sightlines_new(&sightlines, together, COUNT, NULL), PLACIDO_OK);
  assert_int_equal(placido_sightlines_fit_grid(&sightlines, &grid, NULL), PLACIDO_OK);
  const placido_target target = {base, &grid, c};
  const placido_shape shape = {surface, &grid, c};
  placido_sightlines_trace(&sightlines, &target, 2);
  placido_sightlines_tell(&sightlines);
  placido_sightlines_tell_all(&sightlines, &target, 2);
  size_t missed = 0;
  for (size_t i = 0; i < COUNT; i++) {
    placido_sample_trace(&alone[i], &shape);
    assert_int_equal(isnan(together[i].residual_px), isnan(alone[i].residual_px));
    missed += isnan(alone[i].residual_px);
    if (!isnan(alone[i].residual_px)) {
      /* px, where a picture's noise is 0.02; mm; and slopes, of which 1e-6 is noise */
      assert_near(together[i].residual_px, alone[i].residual_px, 1e-5);
      assert_near(together[i].hit.x, alone[i].hit.x, 1e-9);
      assert_near(together[i].hit.p, alone[i].hit.p, 1e-8);
      assert_near(together[i].miss.by_p, alone[i].miss.by_p, 1e-6 * fabs(alone[i].miss.by_p));
    }
  }
  assert_true(missed > 0 && missed < COUNT / 2);
  placido_sightlines_free(&sightlines);
  placido_surface_free(surface);
  free(c);
}

/* A cell's block from some rows, as the fit adds them. */
static void add_rows(placido_normal *normal, int column, int row, int seed) {
  double block[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL] = {0}, right[PLACIDO_SPLINE_CELL] = {0};
  for (int s = 0; s < 50; s++) {
    double line[PLACIDO_SPLINE_CELL];
    for (int i = 0; i < PLACIDO_SPLINE_CELL; i++) {
      line[i] = wave(seed + 37 * s + i);
      right[i] += line[i];
    }
    for (int i = 0; i < PLACIDO_SPLINE_CELL; i++) {
      for (int j = 0; j <= i; j++) {
        block[i * PLACIDO_SPLINE_CELL + j] += line[i] * line[j];
      }
    }
  }
  placido_normal_add(normal, column, row, block, right);
}

/* The selected inverse must be the inverse: column by column against plain solutions. */
static void check_inverse(int degree) {
  placido_grid grid = placido_grid_covering(1.2, 0.4, degree);
  int n = grid.side * grid.side;
  placido_normal *normal;
  assert_int_equal(placido_normal_new(&normal, &grid, NULL), PLACIDO_OK);
  double *zero = calloc((size_t)n, sizeof *zero), *x = calloc((size_t)n, sizeof *x);
  placido_normal_clear(normal);
  for (int row = 0; row < grid.cells; row++) {
    for (int column = 0; column < grid.cells; column++) {
      add_rows(normal, column, row, 1000 * row + column);
    }
  }
  placido_normal_smooth(normal, 1e-3, zero);
  assert_int_equal(placido_normal_solve(normal, 0, x, NULL), PLACIDO_OK);
  double *inverse;
  assert_int_equal(placido_normal_inverse(normal, &inverse, NULL), PLACIDO_OK);
  for (int trial = 0; trial < 6; trial++) {
    int column = trial % grid.cells, row = (trial * 2) % grid.cells;
    double v[PLACIDO_SPLINE_CELL], direct = 0;
    double *right = calloc((size_t)n, sizeof *right);
    for (int i = 0; i < grid.order * grid.order; i++) {
      v[i] = wave(trial * 100 + i);
      right[(row + i / grid.order) * grid.side + column + i % grid.order] = v[i];
    }
    assert_int_equal(placido_normal_solve_more(normal, right, 1, x, NULL), PLACIDO_OK);
    for (int i = 0; i < n; i++) {
      direct += right[i] * x[i];
    }
    double selected = placido_normal_variance(normal, inverse, column, row, v);
    assert_near(selected, direct, 1e-9 * direct);
    free(right);
  }
  placido_memory_free(inverse);
  placido_normal_free(normal);
  free(zero);
  free(x);
}

static void the_selected_inverse_gives_the_variances(void **state) {
  (void)state;
  check_inverse(5);
  check_inverse(3);
}

/* The penalty must leave a paraboloid alone, so that no sphere, cylinder or tilt is biased: with
 * its coefficients as the start there is nothing to do. */
static void check_smoothing(int degree) {
  placido_grid grid = placido_grid_covering(1.2, 0.4, degree);
  int n = grid.side * grid.side;
  placido_normal *normal;
  assert_int_equal(placido_normal_new(&normal, &grid, NULL), PLACIDO_OK);
  double *c = calloc((size_t)n, sizeof *c), *step = calloc((size_t)n, sizeof *step);
  for (int j = 0; j < grid.side; j++) {
    for (int i = 0; i < grid.side; i++) {
      c[j * grid.side + i] = 0.3 + 0.1 * i - 0.2 * j + 0.01 * i * i + 0.02 * i * j - 0.03 * j * j;
    }
  }
  placido_normal_clear(normal);
  add_rows(normal, 0, 0, 5); /* something to be positive definite */
  placido_normal_clear(normal);
  placido_normal_smooth(normal, 1, c);
  for (int row = 0; row < grid.cells; row++) {
    double block[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL] = {0};
    double right[PLACIDO_SPLINE_CELL] = {0};
    for (int i = 0; i < PLACIDO_SPLINE_CELL; i++) {
      block[i * PLACIDO_SPLINE_CELL + i] = 1;
    }
    for (int column = 0; column < grid.cells; column++) {
      placido_normal_add(normal, column, row, block, right);
    }
  }
  assert_int_equal(placido_normal_solve(normal, 0, step, NULL), PLACIDO_OK);
  for (int i = 0; i < n; i++) {
    assert_near(step[i], 0, 1e-10);
  }
  placido_normal_free(normal);
  free(c);
  free(step);
}

static void smoothing_leaves_quadratics_alone(void **state) {
  (void)state;
  check_smoothing(5);
  check_smoothing(3);
}

static void nothing_known_is_refused(void **state) {
  (void)state;
  placido_grid grid = placido_grid_covering(1.2, 0.4, PLACIDO_SPLINE_DEGREE);
  placido_normal *normal;
  placido_error err = {0};
  assert_int_equal(placido_normal_new(&normal, &grid, NULL), PLACIDO_OK);
  double *step = calloc((size_t)(grid.side * grid.side), sizeof *step);
  placido_normal_clear(normal);
  assert_int_equal(placido_normal_solve(normal, 0, step, &err), PLACIDO_QUALITY);
  placido_normal_free(normal);
  free(step);
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void the_quantile_is_an_element_of_the_sorted_list(void **state) {
  (void)state;
  double list[101], sorted[101];
  for (size_t count = 1; count <= 101; count++) {
    for (double share = 0; share <= 1; share += 0.25) {
      for (size_t i = 0; i < count; i++) {
        list[i] = sorted[i] = floor(10 * wave((int)i)); /* with many ties */
      }
      qsort(sorted, count, sizeof *sorted, by_value);
      assert_near(placido_quantile(list, count, share),
                  sorted[(size_t)(share * (double)(count - 1))], 0);
    }
  }
  assert_true(isnan(placido_quantile(list, 0, 0.5)));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_spline_s_derivatives_agree_with_differences),
      cmocka_unit_test(the_basis_sums_to_one_up_to_the_border),
      cmocka_unit_test(the_cell_s_polynomial_is_the_spline),
      cmocka_unit_test(a_bundle_is_its_rays),
      cmocka_unit_test(the_selected_inverse_gives_the_variances),
      cmocka_unit_test(smoothing_leaves_quadratics_alone),
      cmocka_unit_test(nothing_known_is_refused),
      cmocka_unit_test(the_quantile_is_an_element_of_the_sorted_list),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
