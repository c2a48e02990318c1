/* Variants of a fit against its error bars: the same covariance twice, as steps and as sigmas. */
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <stdlib.h>

#define MERIDIANS 60
#define NOISE_PX 0.03
#define STEP_MM 0.25 /* of the grid whose mean is the level that heights count from */
#define LEVEL_MM 1.5
#define ZONE_MM 2.0

static placido_mires points_of(placido_instrument *instrument, double *axis_z_mm) {
  placido_surface *truth;
  placido_jet jet;
  assert_int_equal(placido_phantom_instrument(instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_eye(&truth, "keratoconus", NULL), PLACIDO_OK);
  assert_true(placido_surface_at(truth, 0, 0, &jet));
  *axis_z_mm = placido_surface_vertex_z_mm(truth) - jet.sag;
  placido_mires mires = truth_points(truth, instrument, MERIDIANS, NOISE_PX, NULL);
  placido_surface_free(truth);
  return mires;
}

/* A fit with noise alone, or with all three sources; the geometry is a focal length and two edges.
 */
static placido_fit *fit_of(bool all, int degree) {
  placido_instrument instrument;
  placido_uncertainty geometry;
  placido_error err = {0};
  double axis_z_mm;
  placido_mires mires = points_of(&instrument, &axis_z_mm);
  assert_int_equal(placido_uncertainty_new(&geometry, instrument.edge_count, 3, NULL), PLACIDO_OK);
  geometry.factor[0] = geometry.factor[1] = 8;
  geometry.factor[geometry.parameter_count + PLACIDO_UNCERTAINTY_CAMERA + 20] = 0.02;
  geometry.factor[2 * geometry.parameter_count + PLACIDO_UNCERTAINTY_CAMERA + 33] = 0.02;
  placido_fit_options options = {.axis_z_mm = axis_z_mm,
                                 .axis_z_sigma_mm = all ? 0.05 : 0,
                                 .geometry = all ? &geometry : NULL,
                                 .degree = degree,
                                 .threads = 2};
  placido_fit *fit;
  int status = placido_fit_new(&fit, &mires, &instrument, &options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  placido_uncertainty_free(&geometry);
  placido_mires_free(&mires);
  return fit;
}

static double height_um(const placido_surface *surface, double x, double y) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, x, y, &jet));
  return 1e3 * (placido_surface_vertex_z_mm(surface) - jet.sag);
}

static double axial_D(const placido_surface *surface, double x, double y) {
  placido_jet jet;
  double r = fmax(hypot(x, y), 1e-9);
  assert_true(placido_surface_at(surface, x, y, &jet));
  double slope = (jet.sx * x + jet.sy * y) / r;
  return 337.5 * slope / (r * sqrt(1 + slope * slope));
}

/* The height against the central zone's mean. */
static double elevation_um(const placido_surface *surface, double x, double y) {
  double sum = 0;
  int n = 0, half = (int)(LEVEL_MM / STEP_MM);
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      if (hypot(i * STEP_MM, j * STEP_MM) <= LEVEL_MM) {
        sum += height_um(surface, i * STEP_MM, j * STEP_MM);
        n++;
      }
    }
  }
  return height_um(surface, x, y) - sum / n;
}

enum { PLACES = 12 };

static void place_of(int i, double *x, double *y) {
  double r = 0.8 + 0.25 * i, turn = 2.4 * i;
  *x = r * cos(turn);
  *y = r * sin(turn);
}

/* Σ (f(variant) - f(fit))² at a place, by source. */
static void squares(placido_sigma out[PLACIDO_SIGMA_SOURCES], const placido_fit *fit, double x,
                    double y) {
  const placido_surface *middle = placido_fit_surface(fit);
  double z = elevation_um(middle, x, y), a = axial_D(middle, x, y);
  for (int s = 0; s < PLACIDO_SIGMA_SOURCES; s++) {
    out[s] = (placido_sigma){0};
  }
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    placido_surface *variant;
    assert_int_equal(placido_fit_variant(&variant, fit, v, NULL), PLACIDO_OK);
    placido_sigma *sum = &out[placido_fit_variant_source(fit, v)];
    sum->z_um += pow(elevation_um(variant, x, y) - z, 2);
    sum->axial_D += pow(axial_D(variant, x, y) - a, 2);
    placido_surface_free(variant);
  }
}

/* The noise's steps are draws: a single sigma of theirs scatters by one eighth (chi square of 32),
 * and the mean of twelve places, not all independent, by less. */
static void check_draws(int degree) {
  placido_fit *fit = fit_of(false, degree);
  double z = 0, a = 0;
  for (int i = 0; i < PLACES; i++) {
    double x, y, sigma_um, sigma_D;
    placido_sigma sum[PLACIDO_SIGMA_SOURCES];
    place_of(i, &x, &y);
    squares(sum, fit, x, y);
    placido_fit_sigma_at(fit, x, y, &sigma_um, &sigma_D);
    double share_z = sqrt(sum[PLACIDO_SIGMA_NOISE].z_um) / sigma_um;
    double share_D = sqrt(sum[PLACIDO_SIGMA_NOISE].axial_D) / sigma_D;
    assert_near(share_z, 1, 0.45); /* 3.5 standard deviations of one */
    assert_near(share_D, 1, 0.45);
    z += share_z / PLACES;
    a += share_D / PLACES;
  }
  print_message("draws over sigmas: %.3f of height, %.3f of axial power\n", z, a);
  assert_near(z, 1, 0.15);
  assert_near(a, 1, 0.12);
  placido_fit_free(fit);
}

/* Distance and geometry are one step each, to first order exact; what a step of 0.05 mm bends
 * beyond that is some 1e-3 of it. */
static void check_steps(int degree) {
  placido_fit *fit = fit_of(true, degree);
  placido_sigma budget[PLACIDO_SIGMA_SOURCES], sums[PLACIDO_SIGMA_SOURCES] = {{0}};
  int n = 0, half = (int)(ZONE_MM / 2 / STEP_MM);
  placido_fit_budget(fit, ZONE_MM, budget);
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      placido_sigma sum[PLACIDO_SIGMA_SOURCES];
      if (hypot(i * STEP_MM, j * STEP_MM) <= ZONE_MM / 2) {
        squares(sum, fit, i * STEP_MM, j * STEP_MM);
        for (int s = 0; s < PLACIDO_SIGMA_SOURCES; s++) {
          sums[s].z_um += sum[s].z_um;
        }
        n++;
      }
    }
  }
  for (int s = 0; s < PLACIDO_SIGMA_SOURCES; s++) {
    double tolerance = s == PLACIDO_SIGMA_NOISE ? 0.25 : 5e-3;
    assert_near(sqrt(sums[s].z_um / n), budget[s].z_um, tolerance * budget[s].z_um);
  }
  placido_fit_free(fit);
}

static void draws_have_the_noise_s_sigmas(void **state) {
  (void)state;
  check_draws(5);
  check_draws(3);
}

static void steps_of_distance_and_geometry_are_exact(void **state) {
  (void)state;
  check_steps(5);
  check_steps(3);
}

/* The fit at another distance, taken to first order, is the fit at that distance: to second order
 * in the step, some 1e-3 of the change for 0.02 mm (the cornea's distance is 120 mm, the mires'
 * 40), and what each fit's last step leaves. */
static void check_moved(int degree) {
  const double step_mm = 0.02;
  placido_instrument instrument;
  double axis_z_mm, worst_um = 0, worst_D = 0, most_um = 0, most_D = 0;
  placido_fit *fits[2];
  placido_surface *moved;
  placido_mires mires = points_of(&instrument, &axis_z_mm);
  for (int k = 0; k < 2; k++) {
    const placido_fit_options options = {
        .axis_z_mm = axis_z_mm + k * step_mm, .degree = degree, .tolerance = 1e-4, .knot_mm = 0.5};
    assert_int_equal(placido_fit_new(&fits[k], &mires, &instrument, &options, NULL, NULL),
                     PLACIDO_OK);
  }
  const placido_surface *before = placido_fit_surface(fits[0]);
  const placido_surface *after = placido_fit_surface(fits[1]);
  assert_int_equal(placido_fit_moved(&moved, fits[0], step_mm, NULL), PLACIDO_OK);
  for (int i = 0; i < PLACES; i++) {
    double x, y;
    place_of(i, &x, &y);
    double height = elevation_um(after, x, y), power = axial_D(after, x, y);
    worst_um = fmax(worst_um, fabs(elevation_um(moved, x, y) - height));
    worst_D = fmax(worst_D, fabs(axial_D(moved, x, y) - power));
    most_um = fmax(most_um, fabs(height - elevation_um(before, x, y)));
    most_D = fmax(most_D, fabs(power - axial_D(before, x, y)));
  }
  print_message("moved: %.4f of %.3f um, %.5f of %.4f D\n", worst_um, most_um, worst_D, most_D);
  assert_near(height_um(moved, 0, 0), height_um(before, 0, 0) + 1e3 * step_mm, 1e-3);
  assert_true(most_um > 0.1 && most_D > 0.02);
  assert_true(worst_um < 5e-3 * most_um);
  assert_true(worst_D < 5e-3 * most_D);
  placido_surface_free(moved);
  placido_fit_free(fits[0]);
  placido_fit_free(fits[1]);
  placido_mires_free(&mires);
}

static void a_moved_fit_is_the_fit_at_that_distance(void **state) {
  (void)state;
  check_moved(5);
  check_moved(3);
}

/* Draws are of everything at once and of its full size: their mean square is the square of the
 * sigma. One of 64 draws scatters by 0.18; the mean of twelve places, not all independent (distance
 * and geometry move them together), by less. */
static void draws_of_everything_have_its_sigma(void **state) {
  enum { DRAWS = 64 };
  (void)state;
  placido_fit *fit = fit_of(true, 5);
  double squares_um2[PLACES] = {0}, share = 0;
  for (int d = 0; d < DRAWS; d++) {
    placido_surface *drawn;
    assert_int_equal(placido_fit_draw(&drawn, fit, d, NULL), PLACIDO_OK);
    for (int i = 0; i < PLACES; i++) {
      double x, y;
      place_of(i, &x, &y);
      squares_um2[i] +=
          pow(elevation_um(drawn, x, y) - elevation_um(placido_fit_surface(fit), x, y), 2) / DRAWS;
    }
    placido_surface_free(drawn);
  }
  for (int i = 0; i < PLACES; i++) {
    double x, y, sigma_um, sigma_D;
    place_of(i, &x, &y);
    placido_fit_sigma_at(fit, x, y, &sigma_um, &sigma_D);
    share += squares_um2[i] / (sigma_um * sigma_um) / PLACES;
  }
  print_message("draws over sigmas: variance %.3f\n", share);
  assert_near(share, 1, 3 * 0.18);
  placido_fit_free(fit);
}

/* The same fit on the same points has the same variants, by any number of threads: draws are keyed.
 */
static void variants_are_the_same_every_time(void **state) {
  (void)state;
  placido_fit *fits[2] = {fit_of(true, 5), fit_of(true, 5)};
  assert_int_equal(placido_fit_variant_count(fits[0]), PLACIDO_NOISE_VARIANTS + 1 + 3);
  for (int v = 0; v < placido_fit_variant_count(fits[0]); v += 5) {
    placido_surface *variants[2];
    placido_jet jets[2];
    for (int k = 0; k < 2; k++) {
      assert_int_equal(placido_fit_variant(&variants[k], fits[k], v, NULL), PLACIDO_OK);
      assert_true(placido_surface_at(variants[k], 1.1, -0.6, &jets[k]));
      placido_surface_free(variants[k]);
    }
    assert_memory_equal(&jets[0], &jets[1], sizeof jets[0]);
  }
  placido_fit_free(fits[0]);
  placido_fit_free(fits[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(draws_have_the_noise_s_sigmas),
      cmocka_unit_test(steps_of_distance_and_geometry_are_exact),
      cmocka_unit_test(a_moved_fit_is_the_fit_at_that_distance),
      cmocka_unit_test(draws_of_everything_have_its_sigma),
      cmocka_unit_test(variants_are_the_same_every_time),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
