/* Every number that goes into an examination moved by the least that it can, and by its own
 * standard deviation: what comes out moves in proportion, by no more than the fit itself says.
 *
 * Let X be a result and ∇X its derivatives by the edge points, whose length the fit tells as the
 * noise's part of its error bar over the noise: |∇X| = per_px. Errors δ in N points change X by at
 * most |∇X| |δ| = per_px √N rms(δ) (Cauchy and Schwarz). A point moved by one ulp is such an error;
 * and so is what rounding leaves in a residual, 71 operations on numbers as large as a point's
 * place (test_arithmetic_rays.c), once before and once after. */
#include "base/random.h"
#include "tests/stability/seen.h"
#include "tests/stability/table.h"
#include "tests/support/truth.h"

#include <float.h>
#include <math.h>
#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <placido/simulate.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

#define MERIDIANS 90
#define NOISE_PX 0.02
#define AXIS_SIGMA_MM 0.05
#define PUPIL_MM 5.0
#define ROUNDINGS 71

/* What may be moved of the instrument, along a mode of its uncertainty each. */
enum { FOCAL, PRINCIPAL, CAMERA_X, CAMERA_Z, DISTORTION, ONE_RADIUS, ONE_HEIGHT, ALL_RADII, MODES };

/* `relative`: a standard deviation over what it is compared with, which is how far the second order
 * lags behind the first: a focal length of 10800 px, the 240 px that the mires reach from the
 * middle, the cornea's radius of 7.8 mm, the camera's 120 mm; of k1 times the field's squared
 * angle, 1e-3; of one edge against the others what the loss makes of it, whose weights change by up
 * to δ / (3 noise) where it moves by δ: 0.002 mm are 0.8 of the noise. */
static const struct {
  const char *name, *unit;
  double sigma, relative;
} modes[MODES] = {[FOCAL] = {"focal length", "px", 5, 5 / 10800.0},
                  [PRINCIPAL] = {"principal point", "px", 0.5, 0.5 / 240},
                  [CAMERA_X] = {"camera's x", "mm", 0.02, 0.02 / 7.8},
                  [CAMERA_Z] = {"camera's z", "mm", 0.1, 0.1 / 120},
                  [DISTORTION] = {"distortion k1", "", 0.01, 1e-3},
                  [ONE_RADIUS] = {"an edge's radius", "mm", 0.002, 0.27},
                  [ONE_HEIGHT] = {"an edge's z", "mm", 0.002, 0.27},
                  [ALL_RADII] = {"all edges' radii", "mm", 0.01, 0.01 / 7.8}};

static struct bench {
  placido_surface *eye;
  placido_instrument instrument;
  placido_uncertainty geometry;
  placido_mires points;
  double axis_z_mm;
  placido_fit *fit;
  placido_mires used; /* the points as the fit left them */
  placido_wavefront front;
  struct seen seen;
  double per_px[RESULTS];
  size_t points_used;
} bench;

static placido_fit *fit_of(placido_mires *mires, const placido_instrument *instrument,
                           double axis_z_mm) {
  placido_fit *fit;
  placido_error err = {0};
  const placido_fit_options options = {.axis_z_mm = axis_z_mm,
                                       .axis_z_sigma_mm = AXIS_SIGMA_MM,
                                       .geometry = &bench.geometry,
                                       .knot_mm = 0.5,
                                       .threads = 2};
  int status = placido_fit_new(&fit, mires, instrument, &options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  return fit;
}

/* Roots of the sums of squares of what a source's variants change. */
static void responses(double out[RESULTS], enum placido_sigma_source source) {
  memset(out, 0, RESULTS * sizeof *out);
  for (int v = 0; v < placido_fit_variant_count(bench.fit); v++) {
    if (placido_fit_variant_source(bench.fit, v) == source) {
      placido_surface *variant;
      struct seen seen;
      assert_int_equal(placido_fit_variant(&variant, bench.fit, v, NULL), PLACIDO_OK);
      seen_of(&seen, variant, &bench.front);
      for (int k = 0; k < RESULTS; k++) {
        double change = seen_change(&seen, &bench.seen, k);
        out[k] += change * change;
      }
      placido_surface_free(variant);
    }
  }
  for (int k = 0; k < RESULTS; k++) {
    out[k] = sqrt(out[k]);
  }
}

static double noise_at(uint64_t key) {
  return placido_random_normal(8, 0, key);
}

/* By how much rounding alone may move results, in the sense of the file's comment: half an ulp of
 * the largest places of points an operation. */
static double rounding_px(void) {
  return 2 * ROUNDINGS * 1024 * DBL_EPSILON / 2;
}

static void add_row(const char *what, int result, double perturbation, const char *unit,
                    double condition, double change, double bound) {
  char name[80];
  snprintf(name, sizeof name, "%s: %s", what, seen_results[result].name);
  const struct stability_row row = {.name = name,
                                    .condition = condition,
                                    .perturbation = perturbation,
                                    .in_unit = unit,
                                    .change = change,
                                    .out_unit = seen_results[result].unit,
                                    .bound = bound,
                                    .extended = NAN};
  stability_add(&row);
}

/* Points that one of two fits used and the other one did not: decisions that flipped. */
static size_t flips(const placido_mires *a, const placido_mires *b) {
  size_t count = 0;
  for (size_t i = 0; i < a->count; i++) {
    count += a->points[i].used != b->points[i].used;
  }
  return count;
}

static void add_flips(const char *what, size_t count, double most) {
  char name[80];
  snprintf(name, sizeof name, "%s: decisions flipped", what);
  const struct stability_row row = {.name = name,
                                    .condition = NAN,
                                    .perturbation = NAN,
                                    .change = (double)count,
                                    .out_unit = "points",
                                    .bound = most,
                                    .extended = NAN};
  stability_add(&row);
}

/* Refits and compares; gives the number of flips. */
static size_t refit(struct seen *seen, placido_mires *mires, const placido_instrument *instrument,
                    double axis_z_mm) {
  placido_fit *fit = fit_of(mires, instrument, axis_z_mm);
  seen_of(seen, placido_fit_surface(fit), &bench.front);
  placido_fit_free(fit);
  return flips(mires, &bench.used);
}

/* No decision hangs on one ulp: a residual would have to lie within some 1e-13 px of a threshold.
 */
static void edges_by_an_ulp(void **state) {
  (void)state;
  placido_mires moved = truth_copy(&bench.points);
  struct seen seen;
  double squares = 0;
  for (size_t i = 0; i < moved.count; i++) {
    placido_mire_point *p = &moved.points[i];
    double u = p->u_px, v = p->v_px;
    p->u_px = nextafter(u, noise_at(2 * i) > 0 ? 1e9 : -1e9);
    p->v_px = nextafter(v, noise_at(2 * i + 1) > 0 ? 1e9 : -1e9);
    squares += (p->u_px - u) * (p->u_px - u) + (p->v_px - v) * (p->v_px - v);
  }
  double rms_px = sqrt(squares / (double)moved.count);
  size_t flipped = refit(&seen, &moved, &bench.instrument, bench.axis_z_mm);
  for (int k = 0; k < RESULTS; k++) {
    add_row("edge points by an ulp", k, rms_px, "px", bench.per_px[k],
            seen_change(&seen, &bench.seen, k),
            bench.per_px[k] * sqrt((double)bench.points_used) * (rms_px + rounding_px()));
  }
  add_flips("edge points by an ulp", flipped, 0);
  placido_mires_free(&moved);
}

/* Independent errors of the points' own size, across and along the edges: a result changes by a
 * normal amount with per_px times that for its standard deviation, and by 5 of them once in 2
 * million; a root mean square over a zone hangs on at least ten independent modes, and is no more
 * than 1.2 times that, beyond which a single number's 5 holds. Half of the points' errors along an
 * edge say nothing. Where points lie just at the limit, decisions flip: with 5 spreads for a limit
 * and errors as large as a spread those are few, below the share of a normal distribution beyond 5
 * less 3. */
static void edges_by_their_sigma(void **state) {
  (void)state;
  placido_mires moved = truth_copy(&bench.points);
  struct seen seen;
  for (size_t i = 0; i < moved.count; i++) {
    moved.points[i].u_px += NOISE_PX * noise_at(1000000 + 2 * i);
    moved.points[i].v_px += NOISE_PX * noise_at(1000001 + 2 * i);
  }
  size_t flipped = refit(&seen, &moved, &bench.instrument, bench.axis_z_mm);
  for (int k = 0; k < RESULTS; k++) {
    add_row("edge points by their sigma", k, NOISE_PX, "px", bench.per_px[k],
            seen_change(&seen, &bench.seen, k), 5 * bench.per_px[k] * NOISE_PX);
  }
  add_flips("edge points by their sigma", flipped, 0.023 * (double)moved.count);
  placido_mires_free(&moved);
}

/* One point alone: at most |∂X/∂u| of it, which is at most per_px. */
static void one_edge_point(void **state) {
  (void)state;
  static const double steps[] = {1e-9, 1e-6, 1e-3};
  for (size_t s = 0; s < sizeof steps / sizeof steps[0]; s++) {
    placido_mires moved = truth_copy(&bench.points);
    struct seen seen;
    char name[48];
    moved.points[moved.count / 3].u_px += steps[s];
    size_t flipped = refit(&seen, &moved, &bench.instrument, bench.axis_z_mm);
    snprintf(name, sizeof name, "one point by %g px", steps[s]);
    double rounding = sqrt((double)bench.points_used) * rounding_px();
    for (int k = 0; k < RESULTS; k++) {
      add_row(name, k, steps[s], "px", bench.per_px[k], seen_change(&seen, &bench.seen, k),
              bench.per_px[k] * (steps[s] + rounding));
    }
    add_flips(name, flipped, s == 2 ? 1 : 0); /* a mm's thousandth may cost itself its place */
    placido_mires_free(&moved);
  }
}

/* The fit's own step of a source, scaled, and what a real refit gives. The second order is the
 * first one's relative size times what the step does to the surface as a whole, in the result's
 * unit: it does not vanish where the first order does by symmetry. Twice that, as results are
 * curved, too.
 *
 * The fit judges the points' noise by their residuals. Where points move by `apart_px` against
 * others, their weights change by apart / noise at most, and results as by random errors of that
 * size, which per_px has; three standard deviations of that. */
static void compare_step(const char *name, const char *unit, double step, double sigma,
                         const double response[RESULTS], const struct seen *seen, double relative,
                         double apart_px) {
  double rounding = sqrt((double)bench.points_used) * rounding_px();
  for (int k = 0; k < RESULTS; k++) {
    double whole = strcmp(seen_results[k].unit, "D") == 0 ? response[AXIAL] : response[ELEVATION];
    double bound = step / sigma * (response[k] + 2 * relative * whole);
    add_row(name, k, step, unit, response[k] / sigma, seen_change(seen, &bench.seen, k),
            bound + bench.per_px[k] * (rounding + 3 * apart_px));
  }
}

static void distance(void **state) {
  (void)state;
  double response[RESULTS];
  responses(response, PLACIDO_SIGMA_DISTANCE);
  for (int k = 0; k < 2; k++) {
    struct seen seen;
    placido_mires points = truth_copy(&bench.points);
    double z = k == 0 ? nextafter(bench.axis_z_mm, 1) : bench.axis_z_mm + AXIS_SIGMA_MM;
    double step = z - bench.axis_z_mm;
    size_t flipped = refit(&seen, &points, &bench.instrument, z);
    const char *name = k == 0 ? "distance by an ulp" : "distance by its sigma";
    compare_step(name, "mm", step, AXIS_SIGMA_MM, response, &seen, step / 7.8, 0);
    add_flips(name, flipped, k == 0 ? 0 : 0.023 * (double)points.count);
    placido_mires_free(&points);
  }
}

/* A mode's variant has its response. Modes come in their order behind the noise and the distance.
 */
static void mode_response(double out[RESULTS], int mode) {
  int at = 0;
  for (int v = 0; v < placido_fit_variant_count(bench.fit); v++) {
    if (placido_fit_variant_source(bench.fit, v) == PLACIDO_SIGMA_GEOMETRY && at++ == mode) {
      placido_surface *variant;
      struct seen seen;
      assert_int_equal(placido_fit_variant(&variant, bench.fit, v, NULL), PLACIDO_OK);
      seen_of(&seen, variant, &bench.front);
      for (int k = 0; k < RESULTS; k++) {
        out[k] = seen_change(&seen, &bench.seen, k);
      }
      placido_surface_free(variant);
    }
  }
  assert_int_equal(at > mode, 1);
}

/* How far the edge that a mode moves alone comes in the picture; the others move all edges alike.
 */
static double apart_px_of(int mode, const placido_instrument *moved) {
  double before[2], after[2];
  int edge = mode == ONE_RADIUS ? 20 : 33;
  if (mode != ONE_RADIUS && mode != ONE_HEIGHT) {
    return 0;
  }
  const double *centre = bench.instrument.principal_px;
  assert_true(placido_phantom_edge_at(bench.eye, &bench.instrument, edge, centre, 10, before));
  assert_true(placido_phantom_edge_at(bench.eye, moved, edge, centre, 10, after));
  return hypot(after[0] - before[0], after[1] - before[1]);
}

/* One ulp of a parameter is DBL_EPSILON of its value. */
static void geometry(void **state) {
  (void)state;
  static const double values[MODES] = {10800, 512, 0, 120, 0, 30, 50, 50};
  for (int mode = 0; mode < MODES; mode++) {
    double response[RESULTS];
    mode_response(response, mode);
    for (int k = 0; k < 2; k++) {
      double amount = k == 0 ? values[mode] * DBL_EPSILON / modes[mode].sigma : 1;
      if (amount == 0) {
        continue; /* next to 0 there is no ulp that counts */
      }
      placido_instrument instrument;
      placido_mires points = truth_copy(&bench.points);
      struct seen seen;
      char name[48];
      placido_uncertainty_apply(&instrument, &bench.instrument, &bench.geometry, mode, amount);
      size_t flipped = refit(&seen, &points, &instrument, bench.axis_z_mm);
      snprintf(name, sizeof name, "%s by %s", modes[mode].name, k == 0 ? "an ulp" : "its sigma");
      compare_step(name, modes[mode].unit, amount * modes[mode].sigma, modes[mode].sigma, response,
                   &seen, k == 0 ? 0 : modes[mode].relative,
                   k == 0 ? 0 : apart_px_of(mode, &instrument));
      add_flips(name, flipped, k == 0 ? 0 : 0.023 * (double)points.count);
      placido_mires_free(&points);
    }
  }
}

static void in_proportion(void **state) {
  (void)state;
  assert_int_equal(stability_print("perturbed: what goes in moved, what comes out"), 0);
}

static void fill_geometry(void) {
  double *f = bench.geometry.factor;
  int edges = bench.instrument.edge_count, count = bench.geometry.parameter_count;
  f[FOCAL * count] = f[FOCAL * count + 1] = modes[FOCAL].sigma;
  f[PRINCIPAL * count + 2] = modes[PRINCIPAL].sigma;
  f[CAMERA_X * count + 9] = modes[CAMERA_X].sigma;
  f[CAMERA_Z * count + 11] = modes[CAMERA_Z].sigma;
  f[DISTORTION * count + 4] = modes[DISTORTION].sigma;
  f[ONE_RADIUS * count + PLACIDO_UNCERTAINTY_CAMERA + 20] = modes[ONE_RADIUS].sigma;
  f[ONE_HEIGHT * count + PLACIDO_UNCERTAINTY_CAMERA + edges + 33] = modes[ONE_HEIGHT].sigma;
  for (int k = 0; k < edges; k++) {
    f[ALL_RADII * count + PLACIDO_UNCERTAINTY_CAMERA + k] = modes[ALL_RADII].sigma;
  }
}

static int set_up(void **state) {
  (void)state;
  placido_jet jet;
  const placido_eye behind = {.pupil_mm = PUPIL_MM};
  assert_int_equal(placido_phantom_instrument(&bench.instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_eye(&bench.eye, "astigmatic", NULL), PLACIDO_OK);
  assert_int_equal(
      placido_uncertainty_new(&bench.geometry, bench.instrument.edge_count, MODES, NULL),
      PLACIDO_OK);
  fill_geometry();
  assert_true(placido_surface_at(bench.eye, 0, 0, &jet));
  bench.axis_z_mm = placido_surface_vertex_z_mm(bench.eye) - jet.sag + 0.01; /* no round number */
  bench.points = truth_points(bench.eye, &bench.instrument, MERIDIANS, NOISE_PX, NULL);
  bench.used = truth_copy(&bench.points);
  bench.fit = fit_of(&bench.used, &bench.instrument, bench.axis_z_mm);
  placido_fit_summary summary = placido_fit_summary_get(bench.fit);
  assert_false(summary.axis_z_solved);
  bench.points_used = summary.points_used;
  assert_int_equal(placido_wavefront_new(&bench.front, placido_fit_surface(bench.fit), &behind,
                                         NULL, NULL, NULL),
                   PLACIDO_OK);
  seen_of(&bench.seen, placido_fit_surface(bench.fit), &bench.front);
  responses(bench.per_px, PLACIDO_SIGMA_NOISE);
  for (int k = 0; k < RESULTS; k++) {
    bench.per_px[k] /= summary.sigma_px;
  }
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  placido_fit_free(bench.fit);
  placido_wavefront_free(&bench.front);
  placido_uncertainty_free(&bench.geometry);
  placido_mires_free(&bench.points);
  placido_mires_free(&bench.used);
  placido_surface_free(bench.eye);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edges_by_an_ulp), cmocka_unit_test(edges_by_their_sigma),
      cmocka_unit_test(one_edge_point),  cmocka_unit_test(distance),
      cmocka_unit_test(geometry),        cmocka_unit_test(in_proportion),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
