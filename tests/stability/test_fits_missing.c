/* Edge points that are missing, mires that are few, knots that no data reach: what is covered is as
 * good as its error bars say, and what is not has error bars that know it. */
#include "tests/stability/fits.h"

#include <stdio.h>

#define MERIDIANS 90

/* A number in 0 .. 1 that depends on the key alone (SplitMix64). */
static double chance(size_t key) {
  uint64_t z = ((uint64_t)key + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

/* Three sectors, as a nose, a lid and a hand would hide. */
static bool outside_sectors(const placido_mire_point *point, size_t index, double share) {
  (void)index;
  return fmod(point->meridian_deg + 10, 120) >= 120 * share;
}

/* An arc of every edge, each at a place of its own. */
static bool outside_arcs(const placido_mire_point *point, size_t index, double share) {
  (void)index;
  double start = 360 * chance((size_t)point->edge);
  return fmod(point->meridian_deg - start + 360, 360) >= 360 * share;
}

static bool by_chance(const placido_mire_point *point, size_t index, double share) {
  (void)point;
  return chance(index + 1000) >= share;
}

static const struct {
  const char *name;
  fits_choice *keep;
} patterns[] = {{"sectors", outside_sectors}, {"arcs", outside_arcs}, {"at random", by_chance}};

static const double shares[] = {0.05, 0.1, 0.2, 0.3, 0.45, 0.6};

/* The gap's row: nothing was measured there and nobody shows it, yet the error bars hold. */
static void add_gap(const char *name, const placido_fit *fit, const fits_error *e, double share) {
  const struct stability_row row = {.name = name,
                                    .condition = placido_fit_summary_get(fit).condition,
                                    .perturbation = share,
                                    .in_unit = "%",
                                    .change = e->open_over_sigma,
                                    .out_unit = "sigma",
                                    .bound = fits_bound(e->open_points),
                                    .extended = NAN};
  stability_add(&row);
}

/* Of independent points the fit's information is the sum, so with a share gone the usual (median)
 * error bar of what is still covered grows by 1/sqrt(1 - share), and by the factor of 1.25 that the
 * noise found from the residuals may be off by on either side. The gaps' own borders are fewer than
 * the half that a median looks at. */
static void error_bars_grow_by_what_is_missing(const fits_eye *eye, int pattern) {
  placido_fit *whole = fits_of(eye, NULL, NULL);
  double sigma_um = fits_compare(whole, eye).sigma_um;
  placido_fit_free(whole);
  for (size_t k = 0; k < sizeof shares / sizeof shares[0]; k++) {
    char name[64];
    placido_mires some = fits_some(eye, patterns[pattern].keep, shares[k]);
    placido_fit *fit = fits_of(eye, &some, NULL);
    fits_error e = fits_compare(fit, eye);
    snprintf(name, sizeof name, "%.0f %% missing %s", 100 * shares[k], patterns[pattern].name);
    fits_add(name, fit, &e, 0, 100 * shares[k], "%");
    snprintf(name, sizeof name, "%.0f %% missing %s, median sigma", 100 * shares[k],
             patterns[pattern].name);
    const struct stability_row row = {.name = name,
                                      .condition = placido_fit_summary_get(fit).condition,
                                      .perturbation = 100 * shares[k],
                                      .in_unit = "%",
                                      .change = e.sigma_um / sigma_um,
                                      .out_unit = "times",
                                      .bound = 1.25 * 1.25 / sqrt(1 - shares[k]),
                                      .extended = NAN};
    stability_add(&row);
    if (e.open_points > 0) {
      snprintf(name, sizeof name, "%.0f %% missing %s, in the gaps", 100 * shares[k],
               patterns[pattern].name);
      add_gap(name, fit, &e, 100 * shares[k]);
    }
    placido_fit_free(fit);
    placido_mires_free(&some);
  }
}

static void missing_points_cost_what_linear_theory_says(void **state) {
  (void)state;
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  for (int p = 0; p < 3; p++) {
    error_bars_grow_by_what_is_missing(&eye, p);
  }
  fits_eye_free(&eye);
}

/* The eye under every so many-th edge of its instrument. */
static fits_eye with_few_edges(int edges, int meridians) {
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, 1);
  const placido_instrument all = eye.instrument;
  for (int k = 0; k < edges; k++) {
    int from = edges > 1 ? (k * (all.edge_count - 1) + (edges - 1) / 2) / (edges - 1) : 24;
    eye.instrument.edges[k] = all.edges[from];
  }
  eye.instrument.edge_count = edges;
  placido_mires_free(&eye.mires);
  eye.mires = truth_points(eye.truth, &eye.instrument, meridians, FITS_NOISE_PX, NULL);
  return eye;
}

/* From two edges on there is a surface whose error bars are true, if large: the smoothness stands
 * in for what was not measured, and says how much that is worth. One edge is refused. */
static void few_mires_say_how_little_they_know(void **state) {
  (void)state;
  static const int counts[] = {2, 3, 4, 6, 8, 12, 24};
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
    char name[64];
    fits_eye eye = with_few_edges(counts[i], 180);
    placido_fit *fit = fits_of(&eye, NULL, NULL);
    fits_error e = fits_compare(fit, &eye);
    snprintf(name, sizeof name, "%d edges on 180 meridians", counts[i]);
    fits_add(name, fit, &e, 0, counts[i], "edges");
    placido_fit_free(fit);
    fits_eye_free(&eye);
  }
  fits_eye one = with_few_edges(1, 360), two = with_few_edges(2, 90);
  placido_fit_options options = {.axis_z_mm = one.axis_z_mm};
  fits_add_refusal("1 edge on 360 meridians", &one.instrument, &one.mires, &options,
                   PLACIDO_QUALITY, "one edge");
  fits_add_refusal("2 edges on 90 meridians", &two.instrument, &two.mires, &options,
                   PLACIDO_QUALITY, "only 180 edge points, at least 200 are needed");
  fits_eye_free(&one);
  fits_eye_free(&two);
}

static bool beyond(const placido_mire_point *point, size_t index, double edge) {
  (void)index;
  return point->edge >= edge;
}

static bool within(const placido_mire_point *point, size_t index, double edge) {
  (void)index;
  return point->edge < edge;
}

static bool on_one_side(const placido_mire_point *point, size_t index, double deg) {
  (void)index;
  return point->meridian_deg < deg;
}

/* Knots that no data reach are held by the smoothness: neither singular nor taken for measured. */
static void knots_without_data_are_held(void **state) {
  (void)state;
  static const struct {
    const char *name;
    fits_choice *keep;
    double limit, knot_mm;
  } cases[] = {
      {"finest knots, 90 meridians", beyond, 0, 0.15},
      {"knots of 0.25 mm, nothing within edge 24", beyond, 24, 0.25},
      {"knots of 0.25 mm, nothing beyond edge 16", within, 16, 0.25},
      {"knots of 0.5 mm, 40 degrees only", on_one_side, 40, 0.5},
      {"widest knots", beyond, 0, 2},
  };
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    placido_mires some = fits_some(&eye, cases[i].keep, cases[i].limit);
    placido_fit_options options = {.knot_mm = cases[i].knot_mm};
    placido_fit *fit = fits_of(&eye, &some, &options);
    fits_error e = fits_compare(fit, &eye);
    fits_add(cases[i].name, fit, &e, 0, cases[i].knot_mm, "mm");
    assert_true(e.points > 10);
    placido_fit_free(fit);
    placido_mires_free(&some);
  }
  fits_eye_free(&eye);
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Fits: points that are missing"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(missing_points_cost_what_linear_theory_says),
      cmocka_unit_test(few_mires_say_how_little_they_know),
      cmocka_unit_test(knots_without_data_are_held),
      cmocka_unit_test(the_table_is_good),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
