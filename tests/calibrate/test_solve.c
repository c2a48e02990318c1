/* The joint solution from edge points whose errors are known: nothing is invented, and the standard
 * deviations that it gives are those of its errors. */
#include "acquire/calibrate/covariance.h"
#include "acquire/calibrate/setup.h"
#include "base/memory.h"
#include "tests/calibrate/balls.h"

#include <placido/phantom.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

#define BALLS 3
#define HEIGHTS 3
#define VIEWS (BALLS * HEIGHTS)
#define MERIDIANS 12
#define ORDINARY (2 * HEIGHTS + 1) /* the view of the 7.8 mm ball in the middle */
#define Z_SIGMA_MM 0.005

typedef struct scene {
  placido_instrument nominal, truth;
  placido_uncertainty prior;
  placido_mires mires[VIEWS];
  placido_calibrate_problem problem;
  placido_calibrate_solver solver;
} scene;

/* The edges' exact places by the phantom's own trace, each moved across the edge by `noise_px`
 * times a normal number. */
static void see(placido_mires *mires, const placido_surface *ball, const scene *s,
                const double at_mm[3], double noise_px, chance *c) {
  double scale = s->truth.focal_px[0] / (s->truth.position_mm[2] - at_mm[2]);
  double centre[2] = {
      s->truth.principal_px[0] + scale * (0.9 * at_mm[0] - s->truth.position_mm[0]),
      s->truth.principal_px[1] - scale * (0.9 * at_mm[1] - s->truth.position_mm[1])};
  *mires = (placido_mires){.centre_u_px = centre[0],
                           .centre_v_px = centre[1],
                           .edge_count = s->truth.edge_count,
                           .meridian_count = MERIDIANS};
  mires->points = placido_memory_new((size_t)mires->edge_count * MERIDIANS,
                                     sizeof *mires->points, NULL);
  assert_non_null(mires->points);
  for (int edge = 0; edge < mires->edge_count; edge++) {
    for (int m = 0; m < MERIDIANS; m++) {
      double angle = 2 * M_PI * m / MERIDIANS, position[2], error = noise_px * chance_normal(c);
      if (placido_phantom_edge_at(ball, &s->truth, edge, centre, angle * 180 / M_PI, position)) {
        mires->points[mires->count++] =
            (placido_mire_point){.edge = edge,
                                 .meridian_deg = angle * 180 / M_PI,
                                 .u_px = position[0] + error * cos(angle),
                                 .v_px = position[1] - error * sin(angle),
                                 .used = true};
      }
    }
  }
}

static void solve(scene *s, uint64_t seed, double noise_px, double z_error_mm) {
  static const double radii_mm[BALLS] = {6.5, 9.5, 7.8};
  chance c = {88172645463325252u + 1000003 * seed};
  *s = (scene){.prior = {0}};
  assert_int_equal(placido_phantom_instrument(&s->nominal, "cone24", NULL), PLACIDO_OK);
  s->truth = balls_spoil(&s->nominal, &c);
  assert_int_equal(placido_calibrate_prior(&s->prior, &s->nominal, NULL), PLACIDO_OK);
  assert_int_equal(
      placido_calibrate_problem_new(&s->problem, &s->nominal, &s->prior, BALLS, VIEWS, NULL),
      PLACIDO_OK);
  for (int v = 0; v < VIEWS; v++) {
    int b = v / HEIGHTS;
    double at_mm[3] = {0.3 * chance_even(&c), 0.3 * chance_even(&c), -1.0 + v % HEIGHTS};
    placido_surface *ball = balls_new(radii_mm[b], at_mm[0], at_mm[1], at_mm[2]);
    see(&s->mires[v], ball, s, at_mm, noise_px, &c);
    placido_surface_free(ball);
    placido_calibrate_ball_set(&s->problem, b, radii_mm[b], 0.001);
    placido_calibrate_view_set(&s->problem, v, &s->mires[v], b,
                               at_mm[2] + z_error_mm * chance_normal(&c), Z_SIGMA_MM);
  }
  assert_int_equal(placido_calibrate_solver_new(&s->solver, &s->problem, NULL), PLACIDO_OK);
  assert_int_equal(placido_calibrate_solver_run(&s->solver, NULL), PLACIDO_OK);
}

static void forget(scene *s) {
  for (int v = 0; v < VIEWS; v++) {
    placido_mires_free(&s->mires[v]);
  }
  placido_calibrate_solver_free(&s->solver);
  placido_calibrate_problem_free(&s->problem);
  placido_uncertainty_free(&s->prior);
}

static void exact_points_give_the_exact_instrument(void **state) {
  (void)state;
  scene s;
  solve(&s, 1, 0, 0);
  placido_calibrate_geometry g = placido_calibrate_geometry_of(&s.problem, s.solver.q, 0);
  double sum = 0;
  for (size_t i = 0; i < s.mires[0].count; i++) {
    placido_calibrate_row row;
    assert_true(placido_calibrate_row_at(&row, &g, &s.mires[0].points[i], false));
    sum += row.residual_px * row.residual_px;
  }
  assert_true(sqrt(sum / (double)s.mires[0].count) < 5e-4); /* from 4 px at the start */
  /* Points are taken to be no better than 0.005 px, which leaves the focal length 30 px and the
   * edges 0.03 and 0.06 mm; what is left of the errors is the prior's pull within that. */
  assert_true(fabs(g.instrument.focal_px[0] - s.truth.focal_px[0]) < 30);
  assert_true(fabs(g.instrument.principal_px[0] - s.truth.principal_px[0]) < 0.1);
  for (int k = 0; k < s.truth.edge_count; k++) {
    assert_true(fabs(g.instrument.edges[k].radius_mm - s.truth.edges[k].radius_mm) < 0.03);
    assert_true(fabs(g.instrument.edges[k].z_mm - s.truth.edges[k].z_mm) < 0.06);
  }
  forget(&s);
}

/* Root mean square of error over standard deviation, over parameters [first, last). */
static double mean_z(const scene *s, const placido_calibration *c, int first, int last) {
  placido_calibrate_geometry g = placido_calibrate_geometry_of(&s->problem, s->solver.q, 0);
  placido_instrument truth = s->truth;
  double sum = 0;
  for (int i = first; i < last; i++) {
    double error = *placido_instrument_parameter(&g.instrument, i) -
                   *placido_instrument_parameter(&truth, i);
    sum += pow(error / c->uncertainty.sigma[i], 2);
  }
  return sqrt(sum / (last - first));
}

static void errors_are_as_large_as_they_are_said_to_be(void **state) {
  (void)state;
  double camera = 0, edges = 0;
  const int seeds = 2;
  for (int seed = 1; seed <= seeds; seed++) {
    scene s;
    placido_ball_result balls[BALLS];
    placido_calibration c = {.ball_count = BALLS, .balls = balls};
    solve(&s, (uint64_t)seed, 0.02, Z_SIGMA_MM);
    assert_int_equal(placido_calibrate_covariance(&c, &s.solver, ORDINARY, NULL), PLACIDO_OK);
    assert_true(fabs(s.solver.sigma_px / 0.02 - 1) < 0.06); /* 5,000 points tell it to 2 % */
    camera += pow(mean_z(&s, &c, 0, PLACIDO_UNCERTAINTY_CAMERA), 2) / seeds;
    edges += pow(mean_z(&s, &c, PLACIDO_UNCERTAINTY_CAMERA, c.uncertainty.parameter_count), 2) /
             seeds;
    placido_uncertainty_free(&c.uncertainty);
    forget(&s);
  }
  /* Chi-square per parameter; those of one instrument hang together, so that two of them have
   * few degrees of freedom. Taking derivatives at the noisy points gave 16 to 25 here. */
  assert_in_range((int)(100 * camera), 20, 250);
  assert_in_range((int)(100 * edges), 5, 250);
}

/* What the modes leave out of the covariance hardly moves the mires: their effects are compared in
 * the picture of the 7.8 mm ball. */
static void check_modes(const scene *s, const placido_calibration *c) {
  const placido_mires *mires = &s->mires[ORDINARY];
  placido_calibrate_geometry g =
      placido_calibrate_geometry_of(&s->problem, s->solver.q, ORDINARY);
  double effect_px[2] = {0, 0};
  const int modes[2] = {0, c->uncertainty.mode_count - 1};
  for (int k = 0; k < 2; k++) {
    placido_calibrate_geometry moved = g;
    placido_uncertainty_apply(&moved.instrument, &g.instrument, &c->uncertainty, modes[k], 1);
    for (size_t i = 0; i < mires->count; i++) {
      placido_calibrate_row before, after;
      assert_true(placido_calibrate_row_at(&before, &g, &mires->points[i], false));
      assert_true(placido_calibrate_row_at(&after, &moved, &mires->points[i], false));
      effect_px[k] += pow(after.residual_px - before.residual_px, 2) / (double)mires->count;
    }
  }
  assert_true(sqrt(effect_px[1]) < 0.05 * sqrt(effect_px[0]));
  assert_true(sqrt(effect_px[1]) < 0.002); /* a tenth of the noise of one point */
}

/* Without any distance the whole may be shifted along the axis: the solution must say so. */
static void an_unknown_zero_is_told(void **state) {
  (void)state;
  scene s;
  placido_ball_result balls[BALLS];
  placido_calibration c = {.ball_count = BALLS, .balls = balls};
  solve(&s, 3, 0.02, Z_SIGMA_MM);
  assert_int_equal(placido_calibrate_covariance(&c, &s.solver, ORDINARY, NULL), PLACIDO_OK);
  check_modes(&s, &c);
  const double known = c.undetermined[0].share;
  placido_uncertainty_free(&c.uncertainty);
  for (int v = 0; v < VIEWS; v++) {
    s.problem.views[v].sigma_mm[2] = 5;
  }
  assert_int_equal(placido_calibrate_solver_run(&s.solver, NULL), PLACIDO_OK);
  assert_int_equal(placido_calibrate_covariance(&c, &s.solver, ORDINARY, NULL), PLACIDO_OK);
  assert_true(c.undetermined_count > 0);
  assert_true(c.undetermined[0].share > 0.95);
  assert_true(c.undetermined[0].share >= known);
  const double *sigma = c.uncertainty.sigma + PLACIDO_UNCERTAINTY_CAMERA + s.truth.edge_count;
  /* 48 heights of 0.2 mm each hold their common shift to 0.03 mm; nothing else does */
  assert_true(sigma[20] > 0.02);
  placido_uncertainty_free(&c.uncertainty);
  forget(&s);
}

/* Every allocation failing in turn: told, and nothing is lost (the sanitizer counts). */
static void memory_that_runs_out_is_told(void **state) {
  (void)state;
  placido_instrument nominal;
  int status = PLACIDO_MEMORY;
  assert_int_equal(placido_phantom_instrument(&nominal, "cone24", NULL), PLACIDO_OK);
  for (unsigned long n = 1; status == PLACIDO_MEMORY && n < 100; n++) {
    placido_calibrate_problem problem;
    placido_calibrate_solver solver = {0};
    placido_memory_fail_at(n);
    status = placido_calibrate_problem_new(&problem, &nominal, NULL, 1, 3, NULL);
    if (status == PLACIDO_OK) {
      status = placido_calibrate_solver_new(&solver, &problem, NULL);
    }
    placido_memory_fail_at(0);
    placido_calibrate_solver_free(&solver);
    placido_calibrate_problem_free(&problem);
  }
  assert_int_equal(status, PLACIDO_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exact_points_give_the_exact_instrument),
      cmocka_unit_test(errors_are_as_large_as_they_are_said_to_be),
      cmocka_unit_test(an_unknown_zero_is_told),
      cmocka_unit_test(memory_that_runs_out_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
