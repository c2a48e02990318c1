/* Linear propagation against Monte Carlo: what a fit claims of its covariance, source by source, is
 * how some 200 fits scatter whose noise, distance or instrument was drawn anew. */
#include "base/random.h"
#include "tests/stability/drawn_eye.h"
#include "tests/stability/table.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/index.h>
#include <placido/phantom.h>
#include <placido/wavefront.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SANITIZE_ADDRESS__
#define DRAWS 20
#else
#define DRAWS 200 /* of noise; half as many of distance and geometry, whose claims are no draws */
#endif
#define CLAIMANTS 9 /* fits that are asked what they claim: the middle one's counts */
#define KNOT_MM 0.6 /* quick, and fine enough for these corneas */
#define NOISE_PX 0.02
#define MERIDIANS 180     /* that tell the noise of neighbours apart */
#define FEW_MERIDIANS 40
/* Small, so that even a Strehl ratio follows in proportion. */
#define DISTANCE_MM 0.002
#define WORKSHOP 0.02
#define COARSER 4 /* pixels than the built-in instrument's */
#define PUPIL_MM 5.0
/* Of any figure in its unit: what a cause does less than this, as a distance to the coma of a
 * cornea that is nearly symmetric, is lost in where iterations end. */
#define NOTHING 1e-5
#define SEED 20

/* Beyond so many standard normal deviations on either side a variance is not that claimed: 1 of
 * 16,000 right ones, and there are some 140. */
#define SCORE_MOST 4.0

#define PLACES 5
static const double places_mm[PLACES][2] = {
    {0.6, 0.3}, {-1.2, 0.8}, {1.1, -1.6}, {-2.2, -1.2}, {0.4, 2.9}};

enum figure {
  HEIGHT = 0,
  AXIAL = PLACES,
  K1 = 2 * PLACES,
  K2,
  ASTIGMATISM, /* Zernike terms */
  COMA,
  SPHERICAL,
  STREHL,
  FIGURES
};

static const char *const names[FIGURES - K1] = {"K1", "K2",          "Z(2, 2)",
                                                "Z(3, -1)", "Z(4, 0)", "Strehl"};
static const int terms[3] = {5, 7, 12}; /* OSA indices */

/* What one source is about. */
struct bench {
  placido_surface *eye;
  placido_instrument instrument;
  placido_uncertainty geometry;
  double axis_z_mm;
  bool gap;
  placido_wavefront front; /* that terms are told by */
};

/* Every other edge: enough, and soon fitted. A quarter of the pixels, so that meridians lie as
 * close together as pictures' do, where a fit sees whether neighbours err alike. */
static placido_instrument cone(void) {
  placido_instrument in;
  assert_int_equal(placido_phantom_instrument(&in, "cone24", NULL), PLACIDO_OK);
  in.width_px /= COARSER;
  in.height_px /= COARSER;
  for (int i = 0; i < 2; i++) {
    in.focal_px[i] /= COARSER;
    in.principal_px[i] = (in.principal_px[i] + 0.5) / COARSER - 0.5;
  }
  in.edge_count /= 2;
  for (int k = 0; k < in.edge_count; k++) {
    in.edges[k] = in.edges[2 * k];
  }
  return in;
}

static bool in_the_gap(int edge, double deg) {
  return edge > 12 && deg > 180 && deg < 250;
}

/* The workshop's, whose focal lengths and principal points are in pixels. */
static placido_uncertainty workshop(const placido_instrument *instrument) {
  placido_uncertainty u = drawn_workshop(instrument, WORKSHOP);
  for (int m = 0; m < u.mode_count; m++) {
    for (int k = 0; k < 4; k++) {
      u.factor[m * u.parameter_count + k] /= COARSER;
    }
  }
  return u;
}

static struct bench bench_of(const char *eye, bool gap) {
  struct bench bench = {.instrument = cone(), .gap = gap};
  placido_jet jet;
  const placido_eye pupil = {.pupil_mm = PUPIL_MM};
  assert_int_equal(placido_phantom_eye(&bench.eye, eye, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(bench.eye, 0, 0, &jet));
  bench.axis_z_mm = placido_surface_vertex_z_mm(bench.eye) - jet.sag;
  bench.geometry = workshop(&bench.instrument);
  assert_int_equal(placido_wavefront_new(&bench.front, bench.eye, &pupil, NULL, NULL, NULL),
                   PLACIDO_OK);
  return bench;
}

static void bench_free(struct bench *bench) {
  placido_wavefront_free(&bench->front);
  placido_uncertainty_free(&bench->geometry);
  placido_surface_free(bench->eye);
}

static double height_um(const placido_surface *surface, double x, double y) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, x, y, &jet));
  return 1e3 * (placido_surface_vertex_z_mm(surface) - jet.sag);
}

/* The mean height of the central 3 mm, from which heights count. */
static double level_um(const placido_surface *surface) {
  double sum = 0;
  int n = 0;
  for (int j = -6; j <= 6; j++) {
    for (int i = -6; i <= 6; i++) {
      if (hypot(i, j) <= 6) {
        sum += height_um(surface, i / 4.0, j / 4.0);
        n++;
      }
    }
  }
  return sum / n;
}

static double axial_D(const placido_surface *surface, double x, double y) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, x, y, &jet));
  double r = hypot(x, y), s = (jet.sx * x + jet.sy * y) / r;
  return 337.5 * s / (r * sqrt(1 + s * s));
}

static double index_of(const placido_index_value *values, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return values[i].value;
    }
  }
  return NAN;
}

static double strehl_of(const placido_wavefront *front, const double *terms_um) {
  size_t count;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(figures[i].name, "strehl_555nm") == 0) {
      return figures[i].at(front, terms_um);
    }
  }
  return NAN;
}

static void figures_of(double values[FIGURES], const struct bench *bench,
                       const placido_surface *surface) {
  placido_index_value indices[PLACIDO_INDICES_MAX];
  double terms_um[PLACIDO_WAVEFRONT_TERMS], level = level_um(surface);
  size_t count;
  for (int i = 0; i < PLACES; i++) {
    values[HEIGHT + i] = height_um(surface, places_mm[i][0], places_mm[i][1]) - level;
    values[AXIAL + i] = axial_D(surface, places_mm[i][0], places_mm[i][1]);
  }
  assert_int_equal(placido_indices_find(indices, &count, surface, NULL, NULL), PLACIDO_OK);
  values[K1] = index_of(indices, count, "simk_flat_D");
  values[K2] = index_of(indices, count, "simk_steep_D");
  assert_int_equal(placido_wavefront_again(terms_um, &bench->front, surface, NULL), PLACIDO_OK);
  for (int i = 0; i < 3; i++) {
    values[ASTIGMATISM + i] = terms_um[terms[i]];
  }
  values[STREHL] = strehl_of(&bench->front, terms_um);
}

/* The variances that one fit claims: what the source's variants change; of heights and axial powers
 * by noise, which stands as draws among the variants, what the fit tells. */
static void find_claims(double variances[FIGURES], const struct bench *bench,
                        const placido_fit *fit, enum placido_sigma_source source) {
  double middle[FIGURES], moved[FIGURES];
  const bool by_noise = source == PLACIDO_SIGMA_NOISE;
  memset(variances, 0, FIGURES * sizeof *variances);
  figures_of(middle, bench, placido_fit_surface(fit));
  for (int i = 0; i < PLACES && by_noise; i++) {
    double sigma_um, sigma_D;
    placido_fit_sigma_at(fit, places_mm[i][0], places_mm[i][1], &sigma_um, &sigma_D);
    variances[HEIGHT + i] = sigma_um * sigma_um;
    variances[AXIAL + i] = sigma_D * sigma_D;
  }
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    placido_surface *variant;
    if (placido_fit_variant_source(fit, v) != source) {
      continue;
    }
    assert_int_equal(placido_fit_variant(&variant, fit, v, NULL), PLACIDO_OK);
    figures_of(moved, bench, variant);
    for (int f = by_noise ? K1 : 0; f < FIGURES; f++) {
      variances[f] += pow(moved[f] - middle[f], 2);
    }
    placido_surface_free(variant);
  }
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* A fit sees in its own residuals what whole edges have in common and counts that on top of the
 * noise; of independent noise one in some ten fits believes so. The middle claim is that of noise
 * alone. */
static double middle_claim(double claims[CLAIMANTS][FIGURES], int figure) {
  double values[CLAIMANTS];
  for (int i = 0; i < CLAIMANTS; i++) {
    values[i] = claims[i][figure];
  }
  qsort(values, CLAIMANTS, sizeof *values, by_value);
  return values[CLAIMANTS / 2];
}

/* How a ratio of two variances, of n and m degrees of freedom, lies among right ones: as a standard
 * normal number (Paulson, Ann. Math. Stat. 13 (1942) 233). */
static double score_of(double ratio, double n, double m) {
  double a = 2 / (9 * n), b = 2 / (9 * m), root = cbrt(ratio);
  return ((1 - b) * root - (1 - a)) / sqrt(b * root * root + a);
}

/* Running mean and sum of squared differences from it (Welford 1962). */
struct scatter {
  double mean[FIGURES], squares[FIGURES];
};

static void add_values(struct scatter *scatter, const double values[FIGURES], int draw) {
  for (int f = 0; f < FIGURES; f++) {
    double off = values[f] - scatter->mean[f];
    scatter->mean[f] += off / (draw + 1);
    scatter->squares[f] += off * (values[f] - scatter->mean[f]);
  }
}

static placido_mires points_of(const struct bench *bench, enum placido_sigma_source source,
                               int draw) {
  placido_instrument real = bench->instrument;
  for (int m = 0; source == PLACIDO_SIGMA_GEOMETRY && m < bench->geometry.mode_count; m++) {
    placido_uncertainty_apply(&real, &real, &bench->geometry, m,
                              placido_random_normal(SEED, (uint64_t)draw, (uint64_t)m));
  }
  return truth_points(bench->eye, &real,
                      source == PLACIDO_SIGMA_NOISE ? MERIDIANS : FEW_MERIDIANS, 0,
                      bench->gap ? in_the_gap : NULL);
}

static placido_fit *fit_of(const struct bench *bench, enum placido_sigma_source source,
                           const placido_mires *exact, int draw) {
  placido_fit_options options = {.axis_z_mm = bench->axis_z_mm, .knot_mm = KNOT_MM};
  placido_mires mires = *exact;
  placido_fit *fit;
  placido_error err = {0};
  mires.points = malloc(mires.count * sizeof *mires.points);
  assert_non_null(mires.points);
  memcpy(mires.points, exact->points, mires.count * sizeof *mires.points);
  if (source == PLACIDO_SIGMA_NOISE) {
    drawn_noise(&mires, SEED, 1000 + (uint64_t)draw, NOISE_PX);
  }
  if (source == PLACIDO_SIGMA_DISTANCE) {
    options.axis_z_sigma_mm = DISTANCE_MM;
    options.axis_z_mm += DISTANCE_MM * placido_random_normal(SEED, 5000, (uint64_t)draw);
  }
  options.geometry = source == PLACIDO_SIGMA_GEOMETRY ? &bench->geometry : NULL;
  if (placido_fit_new(&fit, &mires, &bench->instrument, &options, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  placido_mires_free(&mires);
  return fit;
}

/* The claims of variants by noise are of 32 draws themselves; all others are sums without a scatter
 * worth telling (a million degrees of freedom). */
static double freedom_of(enum placido_sigma_source source, int figure) {
  return source == PLACIDO_SIGMA_NOISE && figure >= K1 ? PLACIDO_NOISE_VARIANTS : 1e6;
}

static int draws_of(enum placido_sigma_source source) {
  return source == PLACIDO_SIGMA_NOISE ? DRAWS : DRAWS / 2;
}

static void tell(const char *eye, enum placido_sigma_source source, int figure, double claimed,
                 double shown) {
  static const char *const sources[] = {"noise", "distance", "geometry"};
  static const double put_in[] = {NOISE_PX, DISTANCE_MM, WORKSHOP};
  static const char *const put_unit[] = {"px", "mm", "workshop"};
  char name[64], what[24];
  if (figure < K1) {
    snprintf(what, sizeof what, "%s %d", figure < AXIAL ? "height" : "axial", figure % PLACES);
  } else {
    snprintf(what, sizeof what, "%s", names[figure - K1]);
  }
  snprintf(name, sizeof name, "%s, %s: %s, %.2f", eye, sources[source], what,
           sqrt(shown / claimed));
  stability_add(&(struct stability_row){
      .name = name,
      .condition = NAN,
      .perturbation = put_in[source],
      .in_unit = put_unit[source],
      .change = fabs(score_of(shown / claimed, draws_of(source) - 1, freedom_of(source, figure))),
      .bound = SCORE_MOST,
      .out_unit = "sigma",
      .extended = NAN});
}

static void check(const char *name, const struct bench *bench, enum placido_sigma_source source) {
  struct scatter scatter = {{0}, {0}};
  double claims[CLAIMANTS][FIGURES], values[FIGURES];
  placido_mires exact = points_of(bench, source, 0);
  for (int d = 0; d < draws_of(source); d++) {
    if (source == PLACIDO_SIGMA_GEOMETRY && d > 0) {
      placido_mires_free(&exact);
      exact = points_of(bench, source, d);
    }
    placido_fit *fit = fit_of(bench, source, &exact, d);
    figures_of(values, bench, placido_fit_surface(fit));
    add_values(&scatter, values, d);
    if (d < CLAIMANTS) {
      find_claims(claims[d], bench, fit, source);
    }
    placido_fit_free(fit);
  }
  for (int f = 0; f < FIGURES; f++) {
    double claimed = middle_claim(claims, f);
    if (sqrt(claimed) > NOTHING) {
      tell(name, source, f, claimed, scatter.squares[f] / (draws_of(source) - 1));
    }
  }
  placido_mires_free(&exact);
}

static void check_eye(const char *name, const char *eye, bool gap) {
  struct bench bench = bench_of(eye, gap);
  for (int source = 0; source < PLACIDO_SIGMA_SOURCES; source++) {
    check(name, &bench, (enum placido_sigma_source)source);
  }
  bench_free(&bench);
}

static void a_normal_eye_scatters_as_claimed(void **state) {
  (void)state;
  check_eye("normal", "normal", false);
}

static void a_keratoconus_scatters_as_claimed(void **state) {
  (void)state;
  check_eye("keratoconus", "keratoconus", false);
}

static void an_eye_with_a_gap_scatters_as_claimed(void **state) {
  (void)state;
  check_eye("gap", "normal", true);
}

static void all_within(void **state) {
  (void)state;
  assert_int_equal(stability_print("linear propagation: scatter of fits over claim"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_normal_eye_scatters_as_claimed),
                                     cmocka_unit_test(a_keratoconus_scatters_as_claimed),
                                     cmocka_unit_test(an_eye_with_a_gap_scatters_as_claimed),
                                     cmocka_unit_test(all_within)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
