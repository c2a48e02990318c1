/* Exact edge points mirrored, turned by quarters, and moved: the fitted surface follows to
 * rounding.
 *
 * The points' places take no more than a rounding each, and the fit does the same sums in another
 * order: both act as errors of 71 roundings in every residual (test_arithmetic_rays.c,
 * test_perturbed.c) before and after, which change a result by per_px √N of that, per_px being the
 * noise's part of its error bar over the noise. */
#include "tests/stability/table.h"
#include "tests/stability/zone.h"
#include "tests/support/named_index.h"
#include "tests/support/truth.h"

#include <float.h>
#include <math.h>
#include <placido/index.h>
#include <placido/phantom.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

/* Mirrored and by a quarter every third meridian comes to be a third one, and every third point a
 * third point: the fit begins with those, and what it begins with is to be turned as well. */
#define MERIDIANS 48
#define NOISE_PX 0.02
#define MIDDLE_PX 512.0 /* of a square picture, so that every turn has one */
#define ROUNDINGS 71

static struct bench {
  placido_instrument instrument;
  placido_mires points;
  placido_fit *fit;
  placido_mires used;
  struct zone zone;
  double per_px[2]; /* of height, and of axial power */
} bench;

static placido_fit *fit_of(placido_mires *mires, const placido_instrument *instrument,
                           double axis_z_mm) {
  placido_fit *fit;
  placido_error err = {0};
  const placido_fit_options options = {.axis_z_mm = axis_z_mm, .knot_mm = 0.5, .threads = 2};
  int status = placido_fit_new(&fit, mires, instrument, &options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  return fit;
}

static double bound_of(int which) {
  double rounding_px = 2 * ROUNDINGS * 1024 * DBL_EPSILON / 2;
  double points = (double)placido_fit_summary_get(bench.fit).points_used;
  return bench.per_px[which] * sqrt(points) * rounding_px;
}

static void add_row(const char *what, const char *result, double condition, double change,
                    const char *unit, double bound) {
  char name[80];
  snprintf(name, sizeof name, "%s: %s", what, result);
  const struct stability_row row = {.name = name,
                                    .condition = condition,
                                    .perturbation = 1024 * DBL_EPSILON,
                                    .in_unit = "px",
                                    .change = change,
                                    .out_unit = unit,
                                    .bound = bound,
                                    .extended = NAN};
  stability_add(&row);
}

static int by_place(const void *a, const void *b) {
  const placido_mire_point *p = a, *q = b;
  return p->edge != q->edge
             ? p->edge - q->edge
             : (p->meridian_deg > q->meridian_deg) - (p->meridian_deg < q->meridian_deg);
}

/* The points where turn · (x, y) takes them, y upwards; in the order that lists of mires have. */
static placido_mires turned(const double turn[2][2]) {
  placido_mires mires = truth_copy(&bench.points);
  for (size_t i = 0; i < mires.count; i++) {
    placido_mire_point *p = &mires.points[i];
    double x = p->u_px - MIDDLE_PX, y = MIDDLE_PX - p->v_px;
    p->u_px = MIDDLE_PX + (turn[0][0] * x + turn[0][1] * y);
    p->v_px = MIDDLE_PX - (turn[1][0] * x + turn[1][1] * y);
    double deg =
        turn[0][0] * turn[1][1] - turn[0][1] * turn[1][0] > 0 ? p->meridian_deg : -p->meridian_deg;
    double shift =
        round(atan2(turn[1][0], turn[0][0]) * 180 / M_PI); /* of what was on the x axis */
    p->meridian_deg = fmod(deg + shift + 720, 360);
  }
  qsort(mires.points, mires.count, sizeof *mires.points, by_place);
  return mires;
}

/* Compares a fit of moved points, seen where the first one's places have gone. */
static void compare(const char *name, placido_mires *mires, const placido_instrument *instrument,
                    double axis_z_mm, const double turn[2][2], double level_um) {
  placido_fit *fit = fit_of(mires, instrument, axis_z_mm);
  const placido_fit_summary now = placido_fit_summary_get(fit),
                            then = placido_fit_summary_get(bench.fit);
  struct zone zone;
  zone_see(&zone, placido_fit_surface(fit), turn);
  add_row(name, "height, rms", bench.per_px[0],
          zone_difference(zone.height_um, bench.zone.height_um), "um", bound_of(0));
  add_row(name, "axial power, rms", bench.per_px[1],
          zone_difference(zone.axial_D, bench.zone.axial_D), "D", bound_of(1));
  /* a height is wrong by 4 ulps of its z, that of the axis as well */
  double z_um =
      1e3 * fmax(fabs(axis_z_mm), fabs(placido_surface_vertex_z_mm(placido_fit_surface(fit))));
  add_row(name, "mean height", bench.per_px[0],
          fabs(zone.level_um - level_um - bench.zone.level_um), "um",
          bound_of(0) + 8 * DBL_EPSILON * z_um);
  add_row(name, "points used", NAN, fabs((double)now.points_used - (double)then.points_used),
          "points", 0);
  placido_fit_free(fit);
}

static const struct symmetry {
  const char *name;
  double turn[2][2];
} symmetries[] = {{"the same again", {{1, 0}, {0, 1}}},
                  {"mirrored, OD to OS", {{-1, 0}, {0, 1}}},
                  {"upside down", {{1, 0}, {0, -1}}},
                  {"turned by 90 degrees", {{0, -1}, {1, 0}}},
                  {"turned by 180 degrees", {{-1, 0}, {0, -1}}},
                  {"turned by 270 degrees", {{0, 1}, {-1, 0}}},
                  {"mirrored at the diagonal", {{0, 1}, {1, 0}}}};

static void symmetric_eyes(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof symmetries / sizeof symmetries[0]; k++) {
    placido_mires mires = turned(symmetries[k].turn);
    compare(symmetries[k].name, &mires, &bench.instrument, 0, symmetries[k].turn, 0);
    placido_mires_free(&mires);
  }
}

/* Picture and principal point moved by whole pixels; the instrument and the eye along the axis. */
static void moved_eyes(void **state) {
  (void)state;
  placido_instrument instrument = bench.instrument;
  placido_mires mires = truth_copy(&bench.points);
  instrument.principal_px[0] += 64;
  instrument.principal_px[1] -= 37;
  for (size_t i = 0; i < mires.count; i++) {
    mires.points[i].u_px += 64;
    mires.points[i].v_px -= 37;
  }
  mires.centre_u_px += 64;
  mires.centre_v_px -= 37;
  compare("picture moved", &mires, &instrument, 0, NULL, 0);
  placido_mires_free(&mires);
  instrument = bench.instrument;
  mires = truth_copy(&bench.points);
  instrument.position_mm[2] += 4;
  for (int k = 0; k < instrument.edge_count; k++) {
    instrument.edges[k].z_mm += 4;
  }
  compare("everything moved along the axis", &mires, &instrument, 4, NULL, 4000);
  placido_mires_free(&mires);
}

/* Simulated keratometry of the other eye: the same powers, the axis on the other side; turned by a
 * quarter, 90 degrees on. */
static void keratometry(void **state) {
  (void)state;
  static placido_index_value before[PLACIDO_INDICES_MAX], after[PLACIDO_INDICES_MAX];
  static const char *const names[] = {"simk_steep_D", "simk_flat_D", "simk_steep_axis_deg"};
  size_t count, again;
  double sigma_px = placido_fit_summary_get(bench.fit).sigma_px;
  assert_int_equal(
      placido_indices_find(before, &count, placido_fit_surface(bench.fit), bench.fit, NULL),
      PLACIDO_OK);
  for (size_t k = 1; k < 4; k += 2) {
    placido_mires mires = turned(symmetries[k].turn);
    placido_fit *fit = fit_of(&mires, &bench.instrument, 0);
    assert_int_equal(placido_indices_find(after, &again, placido_fit_surface(fit), NULL, NULL),
                     PLACIDO_OK);
    for (size_t i = 0; i < 3; i++) {
      const placido_index_value *a = named_index(before, count, names[i]);
      const placido_index_value *b = named_index(after, again, names[i]);
      double per_px = a->budget[PLACIDO_SIGMA_NOISE] / sigma_px;
      double expected = i < 2 ? a->value : k == 1 ? 180 - a->value : a->value + 90;
      double change = i < 2 ? b->value - expected : remainder(b->value - expected, 180);
      add_row(symmetries[k].name, names[i], per_px, fabs(change), a->unit,
              per_px / bench.per_px[0] * bound_of(0) + 8 * DBL_EPSILON * fabs(expected));
    }
    placido_fit_free(fit);
    placido_mires_free(&mires);
  }
}

static void everything_follows(void **state) {
  (void)state;
  assert_int_equal(stability_print("metamorphic: fits of exact points"), 0);
}

static int set_up(void **state) {
  (void)state;
  placido_surface *eye;
  placido_sigma budget[PLACIDO_SIGMA_SOURCES];
  const placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.9, -0.2, 7.5, -0.3, 25, 0, 0}},
      {.kind = PLACIDO_PART_BUMP, .as.bump = {0.01, 1.2, 1, 0.6, -0.9, 15}}};
  assert_int_equal(placido_phantom_instrument(&bench.instrument, "cone24", NULL), PLACIDO_OK);
  bench.instrument.principal_px[0] = bench.instrument.principal_px[1] = MIDDLE_PX;
  bench.instrument.focal_px[1] = bench.instrument.focal_px[0];
  bench.instrument.width_px = bench.instrument.height_px = (int)(2 * MIDDLE_PX);
  assert_int_equal(placido_surface_new(&eye, 0, 6, parts, 2, NULL, NULL), PLACIDO_OK);
  bench.points = truth_points(eye, &bench.instrument, MERIDIANS, NOISE_PX, NULL);
  bench.used = truth_copy(&bench.points);
  bench.fit = fit_of(&bench.used, &bench.instrument, 0);
  zone_see(&bench.zone, placido_fit_surface(bench.fit), NULL);
  placido_fit_budget(bench.fit, ZONE_MM, budget);
  bench.per_px[0] = budget[PLACIDO_SIGMA_NOISE].z_um / placido_fit_summary_get(bench.fit).sigma_px;
  bench.per_px[1] =
      budget[PLACIDO_SIGMA_NOISE].axial_D / placido_fit_summary_get(bench.fit).sigma_px;
  placido_surface_free(eye);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  placido_fit_free(bench.fit);
  placido_mires_free(&bench.points);
  placido_mires_free(&bench.used);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(symmetric_eyes),
      cmocka_unit_test(moved_eyes),
      cmocka_unit_test(keratometry),
      cmocka_unit_test(everything_follows),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
