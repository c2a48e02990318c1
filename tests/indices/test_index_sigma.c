/* The indices' error bars are true: the errors of many noisy measurements, and of many distances,
 * are as large as claimed. */
#include "base/memory.h"
#include "base/random.h"
#include "reconstruct/surface/surface.h"
#include "tests/indices/found.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <string.h>

#define MERIDIANS 72
#define NOISE_PX 0.1
#define DRAWS 32
#define KNOT_MM 0.7 /* coarse, and quick: the noise is what is asked about */

/* Of different kinds: means, axes, slopes, fits, places, extremes. */
static const char *const names[] = {"simk_flat_D",
                                    "simk_cylinder_D",
                                    "simk_flat_axis_deg",
                                    "central_k_D",
                                    "mean_axial_3_6mm_D",
                                    "asphericity_q",
                                    "apical_radius_mm",
                                    "asphericity_q_flat_8mm",
                                    "best_fit_sphere_radius_mm",
                                    "inferior_superior_D",
                                    "csi_D",
                                    "clmi_D",
                                    "vertex_x_mm",
                                    "max_tangential_D"};
#define NAMES (sizeof names / sizeof names[0])

struct bench {
  placido_surface *eye;
  placido_instrument instrument;
  placido_mires exact;
  found_indices truth;
};

static struct bench bench_new(const char *name) {
  struct bench bench;
  assert_int_equal(placido_phantom_eye(&bench.eye, name, NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_instrument(&bench.instrument, "cone24", NULL), PLACIDO_OK);
  bench.exact = truth_points(bench.eye, &bench.instrument, MERIDIANS, 0, NULL);
  bench.truth = found_of(bench.eye, NULL);
  return bench;
}

static void bench_free(struct bench *bench) {
  placido_mires_free(&bench->exact);
  placido_surface_free(bench->eye);
}

/* The exact points moved across their edges by noise. */
static placido_mires draw(const struct bench *bench, uint64_t seed, double sigma_px) {
  placido_mires mires = bench->exact;
  mires.points = placido_memory_new(mires.count, sizeof *mires.points, NULL);
  assert_non_null(mires.points);
  memcpy(mires.points, bench->exact.points, mires.count * sizeof *mires.points);
  for (size_t i = 0; i < mires.count; i++) {
    placido_mire_point *p = &mires.points[i];
    double du = p->u_px - mires.centre_u_px, dv = p->v_px - mires.centre_v_px;
    double off = sigma_px * placido_random_normal(seed, 0, i) / hypot(du, dv);
    p->u_px += off * du;
    p->v_px += off * dv;
    p->sigma_px = sigma_px;
  }
  return mires;
}

static double axis_z_of(const placido_surface *surface) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, 0, 0, &jet));
  return placido_surface_vertex_z_mm(surface) - jet.sag;
}

static placido_fit *fit_of(placido_mires *mires, const struct bench *bench, double axis_z_mm,
                           double axis_z_sigma_mm) {
  placido_fit *fit;
  placido_error err = {0};
  placido_fit_options options = {
      .axis_z_mm = axis_z_mm, .axis_z_sigma_mm = axis_z_sigma_mm, .knot_mm = KNOT_MM};
  if (placido_fit_new(&fit, mires, &bench->instrument, &options, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  return fit;
}

/* The error's square over that of the claimed sigma. */
static double square_over(const placido_index_value *value, double truth) {
  bool is_axis = strstr(value->name, "axis_deg") != NULL;
  double error = value->value - truth;
  error = is_axis ? remainder(error, 180) : error;
  return error * error / (value->sigma * value->sigma);
}

/* The root mean square of 32 normal numbers scatters by 1/8, and so does a sigma of 32 variants:
 * one index's ratio by 0.18, and the farthest of 14 by up to 0.45. */
static void errors_by_noise_are_within_what_is_claimed(void **state) {
  (void)state;
  struct bench bench = bench_new("astigmatic");
  double sums[NAMES] = {0}, all = 0;
  for (int d = 0; d < DRAWS; d++) {
    placido_mires mires = draw(&bench, 100 + (uint64_t)d, NOISE_PX);
    placido_fit *fit = fit_of(&mires, &bench, axis_z_of(bench.eye), 0);
    found_indices found = found_of(placido_fit_surface(fit), fit);
    for (size_t i = 0; i < NAMES; i++) {
      const placido_index_value *value = found_index(&found, names[i]);
      sums[i] += square_over(value, found_value(&bench.truth, names[i])) / DRAWS;
      assert_near(value->budget[PLACIDO_SIGMA_NOISE], value->sigma, 1e-12); /* nothing else */
      assert_true(isnan(value->budget[PLACIDO_SIGMA_GEOMETRY]));
    }
    placido_fit_free(fit);
    placido_mires_free(&mires);
  }
  for (size_t i = 0; i < NAMES; i++) {
    print_message("%-26s error/sigma %.3f\n", names[i], sqrt(sums[i]));
    all += sums[i] / NAMES;
  }
  for (size_t i = 0; i < NAMES; i++) {
    assert_true(sqrt(sums[i]) > 0.6 && sqrt(sums[i]) < 1.45);
  }
  assert_true(sqrt(all) > 0.8 && sqrt(all) < 1.2);
  bench_free(&bench);
}

/* The coefficients of a fitted surface's spline, and how many there are. */
static const double *coefficients_of(const placido_surface *surface, size_t *count) {
  *count = 0;
  for (size_t i = 0; i < surface->term_count; i++) {
    const placido_part *part = &surface->terms[i].part;
    if (part->kind == PLACIDO_PART_BSPLINE) {
      *count = (size_t)part->as.bspline.columns * (size_t)part->as.bspline.rows;
      return part->as.bspline.coefficients_mm;
    }
  }
  fail_msg("no spline");
  return NULL;
}

/* A cornea drawn from what the measurement leaves open: every variant's step by a normal amount. */
static placido_surface *draw_cornea(const placido_fit *fit, uint64_t seed) {
  size_t count;
  const placido_surface *middle = placido_fit_surface(fit);
  const double *from = coefficients_of(middle, &count);
  double *change = placido_memory_new(count, sizeof *change, NULL);
  placido_surface *cornea;
  assert_non_null(change);
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    placido_surface *variant;
    double amount = placido_random_normal(seed, 0, (uint64_t)v);
    assert_int_equal(placido_fit_variant(&variant, fit, v, NULL), PLACIDO_OK);
    const double *to = coefficients_of(variant, &count);
    for (size_t i = 0; i < count; i++) {
      change[i] += amount * (to[i] - from[i]);
    }
    placido_surface_free(variant);
  }
  assert_int_equal(placido_surface_bend(&cornea, middle, change, NULL), PLACIDO_OK);
  placido_memory_free(change);
  return cornea;
}

/* Whatever the fit's covariance is: corneas drawn from it scatter in every index as sigma says. The
 * standard deviation of 64 draws is known to 1/11. */
static void corneas_that_are_open_scatter_as_claimed(void **state) {
  (void)state;
  enum { CORNEAS = 64 };
  struct bench bench = bench_new("irregular");
  placido_mires mires = draw(&bench, 9, NOISE_PX);
  placido_fit *fit = fit_of(&mires, &bench, axis_z_of(bench.eye), 0.02);
  found_indices middle = found_of(placido_fit_surface(fit), fit);
  double sums[NAMES] = {0};
  for (int d = 0; d < CORNEAS; d++) {
    placido_surface *cornea = draw_cornea(fit, 1000 + (uint64_t)d);
    found_indices found = found_of(cornea, NULL);
    for (size_t i = 0; i < NAMES; i++) {
      placido_index_value value = *found_index(&found, names[i]);
      value.sigma = found_index(&middle, names[i])->sigma;
      sums[i] += square_over(&value, found_value(&middle, names[i])) / CORNEAS;
    }
    placido_surface_free(cornea);
  }
  for (size_t i = 0; i < NAMES; i++) {
    print_message("%-26s scatter/sigma %.3f\n", names[i], sqrt(sums[i]));
  }
  for (size_t i = 0; i < NAMES; i++) {
    assert_true(sqrt(sums[i]) > 0.75 && sqrt(sums[i]) < 1.3);
  }
  placido_fit_free(fit);
  placido_mires_free(&mires);
  bench_free(&bench);
}

/* One standard deviation of distance moves every index by the distance's part of its budget. */
static void an_error_of_distance_is_as_large_as_claimed(void **state) {
  (void)state;
  static const char *const by_distance[] = {"simk_flat_D",        "central_k_D",
                                            "mean_axial_3_6mm_D", "asphericity_q",
                                            "apical_radius_mm",   "best_fit_sphere_radius_mm"};
  const double sigma_mm = 0.05;
  struct bench bench = bench_new("astigmatic");
  placido_mires mires = draw(&bench, 1, 0.003);
  placido_fit *fit = fit_of(&mires, &bench, axis_z_of(bench.eye) + sigma_mm, sigma_mm);
  found_indices found = found_of(placido_fit_surface(fit), fit);
  for (size_t i = 0; i < sizeof by_distance / sizeof by_distance[0]; i++) {
    const placido_index_value *value = found_index(&found, by_distance[i]);
    double error = fabs(value->value - found_value(&bench.truth, by_distance[i]));
    /* to first order; the points' small noise and the second order of 50 µm are left */
    assert_near(error / value->budget[PLACIDO_SIGMA_DISTANCE], 1, 0.1);
    assert_near(hypot(value->budget[PLACIDO_SIGMA_DISTANCE], value->budget[PLACIDO_SIGMA_NOISE]),
                value->sigma, 1e-12 * value->sigma);
  }
  placido_fit_free(fit);
  placido_mires_free(&mires);
  bench_free(&bench);
}

/* A sphere's axis may be anywhere, and so it is told. */
static void what_is_not_defined_has_the_widest_error(void **state) {
  (void)state;
  struct bench bench = bench_new("sphere");
  placido_mires mires = draw(&bench, 5, NOISE_PX);
  placido_fit *fit = fit_of(&mires, &bench, axis_z_of(bench.eye), 0);
  found_indices found = found_of(placido_fit_surface(fit), fit);
  const placido_index_value *axis = found_index(&found, "simk_flat_axis_deg");
  assert_true(isfinite(axis->value));
  assert_true(axis->sigma > 20);
  assert_true(axis->sigma <= 180 / sqrt(12) + 1e-9);
  placido_indices_of_mires(found.values, &found.count, fit, &mires, &bench.instrument, NULL);
  const placido_index_value *line = found_index(&found, "placido_sl");
  assert_true(line->sigma > 10); /* of 150 */
  placido_fit_free(fit);
  placido_mires_free(&mires);
  bench_free(&bench);
}

/* The Placido indices of the fit, too. */
static void placido_indices_have_true_error_bars(void **state) {
  (void)state;
  static const char *const rows[] = {"placido_pi_1", "placido_pi_2", "placido_sl"};
  struct bench bench = bench_new("irregular");
  static placido_mire_rings rings;
  placido_mire_rings_find(&rings, bench.eye, &bench.exact, &bench.instrument);
  found_indices truth = {.count = 0};
  placido_indices_of_rings(truth.values, &truth.count, &rings);
  double sum = 0;
  for (int d = 0; d < DRAWS / 2; d++) {
    placido_mires mires = draw(&bench, 500 + (uint64_t)d, NOISE_PX);
    placido_fit *fit = fit_of(&mires, &bench, axis_z_of(bench.eye), 0);
    found_indices found = {.count = 0};
    assert_int_equal(
        placido_indices_of_mires(found.values, &found.count, fit, &mires, &bench.instrument, NULL),
        PLACIDO_OK);
    for (int i = 0; i < 3; i++) {
      sum += square_over(found_index(&found, rows[i]), found_value(&truth, rows[i]));
    }
    placido_fit_free(fit);
    placido_mires_free(&mires);
  }
  double ratio = sqrt(sum / (3 * DRAWS / 2));
  print_message("Placido indices: error/sigma %.3f\n", ratio);
  assert_true(ratio > 0.7 && ratio < 1.35); /* 48 numbers, not independent */
  bench_free(&bench);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  struct bench bench = bench_new("sphere");
  placido_mires mires = draw(&bench, 5, NOISE_PX);
  placido_fit *fit = fit_of(&mires, &bench, axis_z_of(bench.eye), 0);
  static found_indices found;
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status != PLACIDO_OK; n = 2 * n + 1) {
    assert_true(n < 1000000);
    placido_memory_fail_at(n);
    status = placido_indices_find(found.values, &found.count, placido_fit_surface(fit), fit, NULL);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK || (status == PLACIDO_MEMORY && found.count == 0));
  }
  size_t before = found.count;
  status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status != PLACIDO_OK; n = 2 * n + 1) {
    assert_true(n < 1000000);
    placido_memory_fail_at(n);
    status =
        placido_indices_of_mires(found.values, &found.count, fit, &mires, &bench.instrument, NULL);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK || (status == PLACIDO_MEMORY && found.count == before));
  }
  placido_fit_free(fit);
  placido_mires_free(&mires);
  bench_free(&bench);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(errors_by_noise_are_within_what_is_claimed),
      cmocka_unit_test(corneas_that_are_open_scatter_as_claimed),
      cmocka_unit_test(an_error_of_distance_is_as_large_as_claimed),
      cmocka_unit_test(what_is_not_defined_has_the_widest_error),
      cmocka_unit_test(placido_indices_have_true_error_bars),
      cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
