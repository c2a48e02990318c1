/* Variants of a fit against its error bars: the same covariance twice, as steps and as sigmas. */
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <stdlib.h>

#define MERIDIANS 120
#define NOISE_PX 0.03
#define STEP_MM 0.25 /* of the grid whose mean is the level that heights count from */
#define LEVEL_MM 1.5

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

/* A fit with all three sources; the geometry is a focal length and two edges. */
static placido_fit *fit_of(void) {
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
                                 .axis_z_sigma_mm = 0.05,
                                 .geometry = &geometry,
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
  double r = hypot(x, y);
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

/* The sigmas of distance and geometry are those of the very steps: to first order exact, and a step
 * of 0.05 mm bends by 1e-3 of itself. The noise's are drawn: one value scatters by one eighth
 * (chi square of 32), and twelve places far apart together by a third of that. */
static void variants_add_up_to_the_sigmas(void **state) {
  (void)state;
  placido_fit *fit = fit_of();
  double noise_z = 0, noise_D = 0;
  for (int i = 0; i < PLACES; i++) {
    double x, y, sigma_um, sigma_D;
    placido_sigma sum[PLACIDO_SIGMA_SOURCES];
    place_of(i, &x, &y);
    squares(sum, fit, x, y);
    placido_fit_sigma_at(fit, x, y, &sigma_um, &sigma_D);
    double z = sigma_um * sigma_um - sum[PLACIDO_SIGMA_DISTANCE].z_um -
               sum[PLACIDO_SIGMA_GEOMETRY].z_um;
    double a = sigma_D * sigma_D - sum[PLACIDO_SIGMA_DISTANCE].axial_D -
               sum[PLACIDO_SIGMA_GEOMETRY].axial_D;
    /* what distance and geometry leave of the whole is the noise's share, within its scatter */
    assert_true(fabs(z - sum[PLACIDO_SIGMA_NOISE].z_um) <
                1e-2 * sigma_um * sigma_um + sum[PLACIDO_SIGMA_NOISE].z_um);
    noise_z += sum[PLACIDO_SIGMA_NOISE].z_um / fmax(z, 1e-12) / PLACES;
    noise_D += sum[PLACIDO_SIGMA_NOISE].axial_D / fmax(a, 1e-12) / PLACES;
  }
  print_message("noise of the draws over that of the sigmas: %.3f %.3f\n", sqrt(noise_z),
                sqrt(noise_D));
  placido_fit_free(fit);
}

/* Without noise's share the budget is exact: a fit whose only open question is the distance. */
static void the_distance_is_exact(void **state) {
  (void)state;
  placido_fit *fit = fit_of();
  placido_sigma budget[PLACIDO_SIGMA_SOURCES], sums[PLACIDO_SIGMA_SOURCES] = {{0}};
  int n = 0, half = 4;
  placido_fit_budget(fit, 2, budget);
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * STEP_MM, y = j * STEP_MM;
      placido_sigma sum[PLACIDO_SIGMA_SOURCES];
      if (hypot(x, y) > 1) {
        continue;
      }
      squares(sum, fit, x, fabs(y) < 1e-9 && i == 0 ? 1e-6 : y);
      for (int s = 0; s < PLACIDO_SIGMA_SOURCES; s++) {
        sums[s].z_um += sum[s].z_um;
      }
      n++;
    }
  }
  for (int s = 0; s < PLACIDO_SIGMA_SOURCES; s++) {
    double by_variants = sqrt(sums[s].z_um / n);
    double tolerance = s == PLACIDO_SIGMA_NOISE ? 0.25 : 5e-3;
    print_message("source %d: %.5f um by variants, %.5f um by sigmas\n", s, by_variants,
                  budget[s].z_um);
    assert_near(by_variants, budget[s].z_um, tolerance * budget[s].z_um);
  }
  placido_fit_free(fit);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(variants_add_up_to_the_sigmas),
      cmocka_unit_test(the_distance_is_exact),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
