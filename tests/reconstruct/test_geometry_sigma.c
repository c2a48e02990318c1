/* Error bars that know of the instrument: against differences, against fits with a moved
 * instrument, and against the errors of many instruments drawn from the covariance. */
#include "base/memory.h"
#include "reconstruct/solve/errors/geometry.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <string.h>

#define MERIDIANS 40
#define NOISE_PX 0.01 /* small, so that the geometry dominates */
#define DRAWS 64
#define AZIMUTHS 8
#define COARSE_MM 0.8 /* knots that are fine enough for what distance and camera do, and quick */

static const double radii_mm[] = {1, 2, 3, 3.8};
#define RADII 4

/* Every other edge of the built-in cone: enough, and soon traced. */
static placido_instrument cone(void) {
  placido_instrument instrument;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  instrument.edge_count /= 2;
  for (int k = 0; k < instrument.edge_count; k++) {
    instrument.edges[k] = instrument.edges[2 * k];
  }
  return instrument;
}

static placido_surface *eye(const char *name) {
  placido_surface *surface;
  assert_int_equal(placido_phantom_eye(&surface, name, NULL), PLACIDO_OK);
  return surface;
}

static double z_of(const placido_surface *surface, double x, double y, double *axial_D) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, x, y, &jet));
  double r = hypot(x, y), s = r > 0 ? (jet.sx * x + jet.sy * y) / r : 0;
  *axial_D = 337.5 * s / (r * sqrt(1 + s * s));
  return placido_surface_vertex_z_mm(surface) - jet.sag;
}

static double axis_z_of(const placido_surface *surface) {
  double unused;
  return z_of(surface, 0, 0, &unused);
}

static placido_fit *fit_of(placido_mires *mires, const placido_instrument *instrument,
                           const placido_fit_options *options) {
  placido_fit *fit;
  placido_error err = {0};
  int status = placido_fit_new(&fit, mires, instrument, options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  return fit;
}

/* Evenly distributed in (0, 1) and normal, repeatable (SplitMix64, Box-Muller). */
static double uniform(uint64_t *state) {
  uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return ((double)((z ^ (z >> 31)) >> 11) + 0.5) / 9007199254740992.0;
}

static double normal(uint64_t *state) {
  double length = sqrt(-2 * log(uniform(state)));
  return length * cos(2 * M_PI * uniform(state));
}

static double *mode_of(placido_uncertainty *u, int mode) {
  return u->factor + (size_t)mode * (size_t)u->parameter_count;
}

#define MODES 12

/* A topographer as a careful workshop leaves it, with the correlations that calibrations have:
 * focal length with distance, all edges together, waves along the cone. */
static placido_uncertainty workshop(const placido_instrument *instrument) {
  static const struct {
    int parameter;
    double sigma;
    int with;
    double with_sigma;
  } camera[9] = {{2, 0.2, 3, 0},      {3, 0.2, 2, 0},       {4, 0.2, 8, 1},
                 {6, 2e-3, 7, 1e-3},  {7, 2e-3, 6, -1e-3},  {9, 0.05, 2, 4.5},
                 {10, 0.05, 3, -4.5}, {11, 0.05, 0, 0},     {0, 5, 1, 5}};
  placido_uncertainty u;
  assert_int_equal(placido_uncertainty_new(&u, instrument->edge_count, MODES, NULL), PLACIDO_OK);
  for (int m = 0; m < 9; m++) {
    mode_of(&u, m)[camera[m].parameter] = camera[m].sigma;
    mode_of(&u, m)[camera[m].with] = camera[m].with_sigma;
  }
  for (int k = 0; k < u.edge_count; k++) {
    double along = (double)k / u.edge_count;
    mode_of(&u, 9)[PLACIDO_UNCERTAINTY_CAMERA + k] = 5e-4 * instrument->edges[k].radius_mm;
    mode_of(&u, 10)[PLACIDO_UNCERTAINTY_CAMERA + u.edge_count + k] = 0.05;
    mode_of(&u, 11)[PLACIDO_UNCERTAINTY_CAMERA + k] = 0.02 * sin(9 * along);
    mode_of(&u, 11)[PLACIDO_UNCERTAINTY_CAMERA + u.edge_count + k] = 0.02 * cos(7 * along);
  }
  return u;
}

/* Every edge's radius and height on its own. */
static placido_uncertainty loose_edges(const placido_instrument *instrument, double sigma_mm) {
  placido_uncertainty u;
  int modes = 2 * instrument->edge_count;
  assert_int_equal(placido_uncertainty_new(&u, instrument->edge_count, modes, NULL), PLACIDO_OK);
  for (int m = 0; m < modes; m++) {
    mode_of(&u, m)[PLACIDO_UNCERTAINTY_CAMERA + m] = sigma_mm;
  }
  return u;
}

/* Root mean squares of error over claimed sigma, by radius. */
typedef struct tally {
  double z[RADII], axial[RADII];
} tally;

/* The mean of the error of z over the central 3 mm, from which heights count. */
static double level_of(const placido_surface *found, const placido_surface *truth) {
  double sum = 0, axial;
  int n = 0;
  for (int j = -6; j <= 6; j++) {
    for (int i = -6; i <= 6; i++) {
      double x = 0.25 * i, y = 0.25 * j;
      if (hypot(x, y) <= 1.5) {
        sum += z_of(found, x, y, &axial) - z_of(truth, x, y, &axial);
        n++;
      }
    }
  }
  return sum / n;
}

static void compare(tally *sums, const placido_fit *fit, const placido_surface *truth) {
  const placido_surface *found = placido_fit_surface(fit);
  double lift = level_of(found, truth);
  for (int i = 0; i < RADII; i++) {
    for (int a = 0; a < AZIMUTHS; a++) {
      double angle = 2 * M_PI * a / AZIMUTHS + 0.1, sigma_um, sigma_D, axial[2];
      double x = radii_mm[i] * cos(angle), y = radii_mm[i] * sin(angle);
      double error = z_of(found, x, y, &axial[0]) - z_of(truth, x, y, &axial[1]) - lift;
      placido_fit_sigma_at(fit, x, y, &sigma_um, &sigma_D);
      sums->z[i] += pow(1e3 * error / sigma_um, 2) / (AZIMUTHS * DRAWS);
      sums->axial[i] += pow((axial[0] - axial[1]) / sigma_D, 2) / (AZIMUTHS * DRAWS);
    }
  }
}

static placido_instrument draw(const placido_instrument *nominal, const placido_uncertainty *u,
                               uint64_t *state) {
  placido_instrument moved = *nominal;
  for (int m = 0; m < u->mode_count; m++) {
    placido_uncertainty_apply(&moved, &moved, u, m, normal(state));
  }
  return moved;
}

/* Pictures taken with a topographer that was drawn from the covariance, or from a distance that
 * was, and fitted as if it were the nominal one. `u` NULL: the geometry is exact. The rms over 64
 * draws of a single normal number scatters by 1/sqrt(128), 9 %: 0.8 to 1.25 is 2.5 of these. */
static void check_errors(const char *eye_name, const placido_uncertainty *u,
                         double axis_z_sigma_mm, double knot_mm) {
  placido_surface *truth = eye(eye_name);
  placido_instrument nominal = cone();
  tally sums = {{0}, {0}};
  uint64_t state = 1;
  placido_mires mires = {.count = 0};
  for (int d = 0; d < DRAWS; d++) {
    placido_instrument real = u ? draw(&nominal, u, &state) : nominal;
    placido_fit_options options = {
        .axis_z_mm = axis_z_of(truth) + axis_z_sigma_mm * normal(&state),
        .axis_z_sigma_mm = axis_z_sigma_mm,
        .geometry = u,
        .knot_mm = knot_mm};
    if (u || d == 0) {
      placido_mires_free(&mires);
      mires = truth_points(truth, &real, MERIDIANS, NOISE_PX, NULL);
    }
    placido_fit *fit = fit_of(&mires, &nominal, &options);
    compare(&sums, fit, truth);
    placido_fit_free(fit);
  }
  for (int i = 0; i < RADII; i++) {
    double z = sqrt(sums.z[i]), axial = sqrt(sums.axial[i]);
    print_message("%.1f mm: z %.3f, axial %.3f\n", radii_mm[i], z, axial);
    assert_true(z > 0.8 && z < 1.25);
    assert_true(axial > 0.8 && axial < 1.25);
  }
  placido_mires_free(&mires);
  placido_surface_free(truth);
}

static void a_workshop_s_errors_are_covered(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_uncertainty u = workshop(&instrument);
  check_errors("keratoconus", &u, 0, COARSE_MM);
  placido_uncertainty_free(&u);
}

/* Loose edges leave part of their errors in the residuals, 5 micrometres three times the points'
 * noise: that part must count neither as noise once more nor as a reason for finer knots. */
static void edges_that_are_off_each_on_its_own_are_covered(void **state) {
  (void)state;
  placido_instrument instrument = cone();
  placido_uncertainty u = loose_edges(&instrument, 0.005);
  check_errors("normal", &u, 0, 0);
  placido_uncertainty_free(&u);
}

static void the_distance_s_error_is_covered(void **state) {
  (void)state;
  check_errors("normal", NULL, 0.05, COARSE_MM);
}

/* Distance and geometry are independent of each other: their squares add up. */
static void distance_and_geometry_add_up(void **state) {
  (void)state;
  placido_surface *truth = eye("normal");
  placido_instrument instrument = cone();
  placido_uncertainty u = workshop(&instrument);
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  placido_fit_options options = {.axis_z_mm = axis_z_of(truth), .axis_z_sigma_mm = 0.05};
  placido_sigma budget[PLACIDO_SIGMA_SOURCES], alone[PLACIDO_SIGMA_SOURCES];
  placido_fit *fit = fit_of(&mires, &instrument, &options);
  placido_fit_budget(fit, 6, alone);
  assert_true(isnan(alone[PLACIDO_SIGMA_GEOMETRY].z_um));
  double before_um, before_D, after_um, after_D, geometry_um, geometry_D;
  placido_fit_sigma_at(fit, 2, 1, &before_um, &before_D);
  placido_fit_free(fit);
  options.geometry = &u;
  fit = fit_of(&mires, &instrument, &options);
  placido_fit_budget(fit, 6, budget);
  placido_fit_sigma_at(fit, 2, 1, &after_um, &after_D);
  placido_fit_free(fit);
  options.axis_z_sigma_mm = 0;
  fit = fit_of(&mires, &instrument, &options);
  placido_fit_sigma_at(fit, 2, 1, &geometry_um, &geometry_D);
  placido_fit_free(fit);
  /* the noise counts in both, a hundredth of either */
  assert_near(after_um, hypot(before_um, geometry_um), 1e-3 * after_um);
  assert_near(after_D, hypot(before_D, geometry_D), 1e-3 * after_D);
  assert_true(after_um > 1.2 * before_um);
  assert_near(budget[PLACIDO_SIGMA_DISTANCE].z_um, alone[PLACIDO_SIGMA_DISTANCE].z_um, 1e-9);
  assert_true(budget[PLACIDO_SIGMA_GEOMETRY].axial_D > 0.05);
  placido_mires_free(&mires);
  placido_uncertainty_free(&u);
  placido_surface_free(truth);
}

/* Without modes, or without any uncertainty at all, not a bit of surface or error bars changes; and
 * geometry that is known to be uncertain moves no surface either. */
static void knowing_nothing_changes_nothing(void **state) {
  (void)state;
  placido_surface *truth = eye("keratoconus");
  placido_instrument instrument = cone();
  placido_uncertainty none = {0}, u = workshop(&instrument);
  const placido_uncertainty *known[] = {NULL, &none, &u};
  double first[2];
  placido_jet shape;
  for (int i = 0; i < 3; i++) {
    placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
    placido_fit_options options = {
        .axis_z_mm = axis_z_of(truth), .axis_z_sigma_mm = 0.05, .geometry = known[i]};
    placido_fit *fit = fit_of(&mires, &instrument, &options);
    double sigma[2];
    placido_jet jet;
    placido_fit_sigma_at(fit, 1.3, -0.7, &sigma[0], &sigma[1]);
    assert_true(placido_surface_at(placido_fit_surface(fit), 1.3, -0.7, &jet));
    if (i == 0) {
      memcpy(first, sigma, sizeof first);
      shape = jet;
    }
    assert_memory_equal(&jet, &shape, sizeof jet);
    assert_int_equal(memcmp(sigma, first, sizeof first) == 0, i < 2);
    placido_fit_free(fit);
    placido_mires_free(&mires);
  }
  placido_uncertainty_free(&u);
  placido_surface_free(truth);
}

static void threads_change_no_bit_and_fewer_modes_less_sigma(void **state) {
  (void)state;
  placido_surface *truth = eye("normal");
  placido_instrument instrument = cone();
  placido_uncertainty u = workshop(&instrument), other = {.edge_count = 3, .mode_count = 1};
  placido_mires mires = truth_points(truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  double sigma_um[3], sigma_D[3];
  for (int i = 0; i < 3; i++) { /* two threads, one, and one with 3 of the 12 modes */
    placido_fit_options options = {
        .geometry = &u, .geometry_modes = i < 2 ? 0 : 3, .threads = i == 0 ? 2 : 1};
    placido_fit *fit = fit_of(&mires, &instrument, &options);
    placido_fit_sigma_at(fit, 2, 1, &sigma_um[i], &sigma_D[i]);
    placido_fit_free(fit);
  }
  assert_memory_equal(&sigma_um[0], &sigma_um[1], sizeof sigma_um[0]);
  assert_memory_equal(&sigma_D[0], &sigma_D[1], sizeof sigma_D[0]);
  assert_true(sigma_um[2] < sigma_um[1]);
  placido_fit *fit;
  placido_fit_options options = {.geometry = &other};
  assert_int_equal(placido_fit_new(&fit, &mires, &instrument, &options, NULL, NULL),
                   PLACIDO_INPUT);
  assert_null(fit);
  placido_mires_free(&mires);
  placido_uncertainty_free(&u);
  placido_surface_free(truth);
}

/* Residual of an image point on a fixed conicoid. */
static double residual_of(const placido_instrument *instrument, const placido_shape *shape,
                          placido_mire_point *point, placido_sample *sample) {
  placido_mires mires = {.count = 1, .points = point};
  placido_sample *one;
  assert_int_equal(placido_samples_new(&one, &mires, instrument, 0, NULL), PLACIDO_OK);
  placido_sample_trace(one, shape);
  *sample = *one;
  double miss = one->miss.f;
  placido_memory_free(one);
  return miss;
}

/* Every parameter of both cameras: central differences of the miss itself, re-traced. */
static void derivatives_agree_with_differences(void **state) {
  (void)state;
  static const double steps[] = {1e-2, 1e-2, 1e-3, 1e-3, 1e-4, 1e-4, 1e-4,
                                 1e-4, 1e-4, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5};
  placido_part part = {.kind = PLACIDO_PART_BICONIC,
                       .as.biconic = {7.8, -0.2, 7.5, -0.1, 20, 0.1, -0.2}};
  placido_shape shape = {0};
  placido_surface *base;
  assert_int_equal(placido_surface_new(&base, 0.01, 6, &part, 1, NULL, NULL), PLACIDO_OK);
  shape.base = base;
  for (int telecentric = 0; telecentric < 2; telecentric++) {
    double focal = telecentric ? 90 : 10800, lens = telecentric ? 1e-3 : 1;
    placido_instrument in = {.model = telecentric ? PLACIDO_TELECENTRIC : PLACIDO_PINHOLE,
                             .focal_px = {focal, 1.01 * focal},
                             .principal_px = {600, 500},
                             .distortion = {0.1 * lens, -0.02 * lens, 0.01 * lens, -0.02 * lens,
                                            0.005 * lens},
                             .position_mm = {0.2, -0.1, 120},
                             .edge_count = 1,
                             .edges = {{30, 60}}};
    placido_mire_point point = {.edge = 0, .u_px = 760, .v_px = 390};
    placido_sample sample, side;
    residual_of(&in, &shape, &point, &sample);
    double by[PLACIDO_SAMPLE_PARAMETERS];
    placido_sample_by_geometry(by, &sample, &point, &in);
    for (int k = 0; k < PLACIDO_SAMPLE_PARAMETERS; k++) {
      double f[2], step = telecentric && k >= 4 && k < 9 ? 1e-6 : steps[k];
      for (int i = 0; i < 2; i++) {
        placido_instrument moved = in;
        *placido_instrument_parameter(&moved, k) += i ? step : -step;
        f[i] = residual_of(&moved, &shape, &point, &side);
      }
      double expected = (f[1] - f[0]) / (2 * step) / sample.slope;
      /* Newton's method along the ray stops at 1e-10 mm, some 1e-8 mm of the miss */
      assert_near(by[k], expected, 1e-6 * fabs(expected) + 1e-8 / step / sample.slope);
    }
  }
  placido_surface_free(base);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(derivatives_agree_with_differences),
      cmocka_unit_test(a_workshop_s_errors_are_covered),
      cmocka_unit_test(edges_that_are_off_each_on_its_own_are_covered),
      cmocka_unit_test(the_distance_s_error_is_covered),
      cmocka_unit_test(distance_and_geometry_add_up),
      cmocka_unit_test(knowing_nothing_changes_nothing),
      cmocka_unit_test(threads_change_no_bit_and_fewer_modes_less_sigma),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
