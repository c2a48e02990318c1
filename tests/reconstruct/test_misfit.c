/* A misfit in one place: found among noise, and what it is for: a narrow cone gets knots as fine as
 * it needs, though all other points are content. */
#include "base/random.h"
#include "reconstruct/solve/doubt/misfit.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <string.h>

enum { EDGES = 24, MERIDIANS = 120, POINTS = EDGES * MERIDIANS };
#define NOISE_PX 0.02

static placido_sample samples[POINTS];
static placido_mire_point points[POINTS];

/* Noise all over the cornea; in the square about (2.5, 0.5) a hill of so many times the noise. */
static double worst_of(double hill, placido_place *place) {
  static const placido_edge edges[EDGES];
  const placido_mires mires = {
      .edge_count = EDGES, .meridian_count = MERIDIANS, .count = POINTS, .points = points};
  double worst;
  for (int i = 0; i < POINTS; i++) {
    double r_mm = 0.2 * (i / MERIDIANS + 1), turn = i % MERIDIANS * 2 * 3.14159265358979 / MERIDIANS;
    placido_sample *s = &samples[i];
    points[i] = (placido_mire_point){.edge = i / MERIDIANS,
                                     .meridian_deg = i % MERIDIANS * 360.0 / MERIDIANS};
    *s = (placido_sample){.edge = &edges[i / MERIDIANS], .point = (size_t)i, .used = true};
    s->hit.x = r_mm * cos(turn);
    s->hit.y = r_mm * sin(turn);
    double away_mm = hypot(s->hit.x - 2.5, s->hit.y - 0.5);
    s->residual_px = NOISE_PX * placido_random_normal(1, 0, (uint64_t)i) +
                     hill * NOISE_PX * (away_mm < 0.7);
  }
  assert_int_equal(placido_misfit_worst(&worst, place, samples, POINTS, &mires, 1, NULL),
                   PLACIDO_OK);
  return worst;
}

static void test_noise_is_no_misfit(void **state) {
  (void)state;
  assert_true(worst_of(0, NULL) < PLACIDO_MISFIT_LOCAL);
}

/* A constant of five times the noise: the median of magnitudes is five, over 0.6745 of the noise. */
static void test_a_hill_is_found(void **state) {
  (void)state;
  placido_place place;
  double worst = worst_of(5, &place);
  assert_near(worst, 5 / 0.6745, 0.3 * 5 / 0.6745);
  assert_near(place.x_mm, 2.5, 1e-12);
  assert_near(place.y_mm, 0.5, 1e-12);
}

/* 100 um high and 0.65 mm wide: with knots every 0.5 mm errors were ten times their bars. */
static void test_a_narrow_cone_gets_finer_knots(void **state) {
  (void)state;
  placido_instrument instrument;
  placido_surface *truth;
  placido_jet jet;
  placido_fit *fit;
  const placido_part parts[2] = {
      {PLACIDO_PART_BICONIC, {.biconic = {7.7, -0.3, 7.7, -0.3, 0, 0, 0}}},
      {PLACIDO_PART_BUMP, {.bump = {0.1, 0.65, 0.65, 0.4, -0.8, 0}}}};
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_surface_new(&truth, 0, 5.6, parts, 2, NULL, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(truth, 0, 0, &jet));
  placido_mires mires = truth_points(truth, &instrument, 360, NOISE_PX, NULL);
  const placido_fit_options options = {.axis_z_mm = -jet.sag, .threads = 2};
  assert_int_equal(placido_fit_new(&fit, &mires, &instrument, &options, NULL, NULL), PLACIDO_OK);
  truth_error error = truth_compare(fit, truth, 0, 4);
  assert_true(placido_fit_summary_get(fit).knot_mm < 0.5);
  assert_true(error.over_sigma < 2);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_noise_is_no_misfit),
                                     cmocka_unit_test(test_a_hill_is_found),
                                     cmocka_unit_test(test_a_narrow_cone_gets_finer_knots)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
