/* Every kind of part has the sag that docs/formats.md gives it, and derivatives that belong to it.
 */
#include "tests/surface/jets.h"
#include "tests/support/near.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#define PI 3.14159265358979323846

/* Points in general position and on the axes, within 4 mm. */
static const double points[][2] = {{0, 0},      {1.3, 0},   {0, -2.1},    {0.7, 0.9},
                                   {-2.2, 1.1}, {2.5, 2.6}, {-1.4, -3.1}, {0.03, -0.02}};
#define POINTS (sizeof points / sizeof points[0])

/* Differences of sums of order 10 mm are rounded to some 1e-16 * 10 / 0.005. */
#define ROUNDING 2e-11

static void assert_all_jets(const placido_part *part, double tolerance) {
  placido_surface *surface = surface_of(part);
  for (size_t i = 0; i < POINTS; i++) {
    assert_jet_is_consistent(surface, points[i][0], points[i][1], tolerance);
  }
  placido_surface_free(surface);
}

static double sag_at(const placido_part *part, double x, double y) {
  placido_surface *surface = surface_of(part);
  placido_jet jet;
  assert_true(placido_surface_at(surface, x, y, &jet));
  placido_surface_free(surface);
  return jet.sag;
}

static void biconic_derivatives(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BICONIC,
                       .as.biconic = {7.9, -0.3, 7.5, 0.1, 33, 0.2, -0.3}};
  assert_all_jets(&part, ROUNDING);
}

static void biconic_of_one_radius_is_a_sphere(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 70, 0, 0}};
  assert_near(sag_at(&part, 2.4, 3.2), 7.8 - sqrt(7.8 * 7.8 - 16), 1e-14);
}

static void biconic_axis_is_where_r1_lies(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {8, 0, 7, 0, 30, 0, 0}};
  double c = cos(PI / 6), s = sin(PI / 6);
  assert_near(sag_at(&part, 3 * c, 3 * s), 8 - sqrt(64 - 9), 1e-14);
  assert_near(sag_at(&part, -3 * s, 3 * c), 7 - sqrt(49 - 9), 1e-14);
}

static void biconic_ends_at_its_equator(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {5, 0, 5, 0, 0, 0, 0}};
  placido_surface *surface = surface_of(&part);
  placido_jet jet;
  assert_true(placido_surface_at(surface, 4.999, 0, &jet));
  assert_false(placido_surface_at(surface, 5, 0, &jet));
  assert_true(isnan(jet.sag) && isnan(jet.sx) && isnan(jet.syy));
  assert_false(placido_surface_at(surface, 0, -5.5, &jet));
  placido_surface_free(surface);
}

static void bump_derivatives(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BUMP, .as.bump = {0.05, 1.25, 0.9, 0.5, -1.1, 15}};
  assert_all_jets(&part, 1e-9); /* step^6 times the bump's seventh derivative */
}

static void bump_stands_forward(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BUMP, .as.bump = {0.05, 1, 2, 0.5, -1, 90}};
  assert_near(sag_at(&part, 0.5, -1), -0.05, 1e-16);
  assert_near(sag_at(&part, 0.5, 0), -0.05 * exp(-0.5), 1e-16); /* u runs along +y */
  assert_near(sag_at(&part, 1.5, -1), -0.05 * exp(-0.125), 1e-16);
}

static const placido_part prk = {.kind = PLACIDO_PART_ABLATION,
                                 .as.ablation = {5, 6, 1.5, 7.72, 1.376, 0.2, 0.1}};

static void ablation_derivatives(void **state) {
  (void)state;
  assert_all_jets(&prk, 1e-9);
}

static void ablation_joins_without_a_step(void **state) {
  (void)state;
  placido_surface *surface = surface_of(&prk);
  double ends[] = {3, 4.5}, near = 1e-9; /* third derivatives of 0.1 per mm² times near are 1e-10 */
  for (int i = 0; i < 2; i++) {
    placido_jet before, behind;
    assert_true(placido_surface_at(surface, 0.2 + ends[i] - near, 0.1, &before));
    assert_true(placido_surface_at(surface, 0.2 + ends[i] + near, 0.1, &behind));
    assert_near(before.sag, behind.sag, 1e-9);
    assert_near(before.sx, behind.sx, 1e-9);
    assert_near(before.sxx, behind.sxx, 1e-9);
    assert_near(before.syy, behind.syy, 1e-9);
  }
  placido_surface_free(surface);
}

static void ablation_makes_a_sphere_a_flatter_sphere(void **state) {
  (void)state;
  placido_part parts[] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.72, 0, 7.72, 0, 0, 0, 0}},
      {.kind = PLACIDO_PART_ABLATION, .as.ablation = {5, 6, 1.5, 7.72, 1.376, 0, 0}}};
  placido_surface *surface;
  placido_jet apex, jet;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, parts, 2, NULL, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(surface, 0, 0, &apex));
  assert_true(placido_surface_at(surface, 1.2, -2.2, &jet));
  double radius = 1 / (1 / 7.72 - 0.005 / 0.376);
  double rho2 = 1.2 * 1.2 + 2.2 * 2.2;
  assert_near(jet.sag - apex.sag, radius - sqrt(radius * radius - rho2), 1e-13);
  assert_near(apex.sxx, 1 / radius, 1e-15);
  placido_surface_free(surface);
}

static void ablation_ends(void **state) {
  (void)state;
  assert_true(sag_at(&prk, 0.2, 0.1) > 0);
  assert_near(sag_at(&prk, 0.2 + 4.5, 0.1), 0, 1e-17);
  assert_near(sag_at(&prk, 5, 2), 0, 0);
}

static void zernike_derivatives(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_ZERNIKE, .as.zernike.radius_mm = 4};
  for (int j = 0; j < 28; j++) {
    part.as.zernike.coefficients_um[j] = (j % 7 - 3) * 0.7 + 0.1;
  }
  assert_all_jets(&part, 1e-9);
}

static void zernike_of_the_highest_order(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_ZERNIKE, .as.zernike.radius_mm = 4.5};
  for (int j = 120; j < PLACIDO_ZERNIKE_TERMS; j++) {
    part.as.zernike.coefficients_um[j] = 0.3;
  }
  assert_all_jets(&part, 1e-6); /* ninth derivatives of such waves are large */
}

/* Values of the standard's table, worked out by hand in polar form. */
static void zernike_terms(void **state) {
  (void)state;
  const double radius = 4, x = 1.1, y = -1.7;
  double rho = hypot(x, y) / radius, theta = atan2(y, x);
  double rho2 = rho * rho, rho3 = rho2 * rho, rho4 = rho2 * rho2;
  const struct {
    int index;
    double value;
  } terms[] = {{0, 1},
               {1, 2 * rho * sin(theta)},
               {2, 2 * rho * cos(theta)},
               {3, sqrt(6) * rho2 * sin(2 * theta)},
               {4, sqrt(3) * (2 * rho2 - 1)},
               {5, sqrt(6) * rho2 * cos(2 * theta)},
               {6, sqrt(8) * rho3 * sin(3 * theta)},
               {7, sqrt(8) * (3 * rho3 - 2 * rho) * sin(theta)},
               {8, sqrt(8) * (3 * rho3 - 2 * rho) * cos(theta)},
               {9, sqrt(8) * rho3 * cos(3 * theta)},
               {11, sqrt(10) * (4 * rho4 - 3 * rho2) * sin(2 * theta)},
               {12, sqrt(5) * (6 * rho4 - 6 * rho2 + 1)},
               {14, sqrt(10) * rho4 * cos(4 * theta)},
               {24, sqrt(7) * (20 * rho4 * rho2 - 30 * rho4 + 12 * rho2 - 1)}};
  for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++) {
    placido_part part = {.kind = PLACIDO_PART_ZERNIKE, .as.zernike.radius_mm = radius};
    part.as.zernike.coefficients_um[terms[i].index] = 2;
    assert_near(sag_at(&part, x, y), 0.002 * terms[i].value, 1e-16);
  }
}

/* At the rim every term with m >= 0 is its norm times cos(m theta): here the sum of cosines at 0.
 */
static void zernike_rim(void **state) {
  (void)state;
  for (int n = 0; n <= 15; n++) {
    for (int m = n % 2; m <= n; m += 2) {
      placido_part part = {.kind = PLACIDO_PART_ZERNIKE, .as.zernike.radius_mm = 4};
      part.as.zernike.coefficients_um[(n * (n + 2) + m) / 2] = 1000;
      double norm = sqrt((m == 0 ? 1 : 2) * (n + 1));
      assert_near(sag_at(&part, 4, 0), norm, 1e-9); /* sums of terms up to 1e5 */
    }
  }
}

static void ridge_derivatives(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_RIDGE, .as.ridge = {0.008, 0.4, 0.3, 25}};
  assert_all_jets(&part, 1e-8); /* the seventh derivative grows as width^-6 */
}

static void ridge_far_from_the_line(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_RIDGE, .as.ridge = {0.008, 1e-3, 0.5, 0}};
  assert_near(sag_at(&part, 1, 4.5), 0.008 * 4, 1e-15); /* exp(4000) would overflow */
  assert_near(sag_at(&part, 1, -4.5), 0, 1e-15);
  assert_near(sag_at(&part, 2, 0.5), 0.008 * 1e-3 * log(2), 1e-18);
}

static void parts_add_up(void **state) {
  (void)state;
  placido_part parts[] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.7, -0.3, 7.55, -0.2, 20, 0, 0}},
      {.kind = PLACIDO_PART_BUMP, .as.bump = {0.04, 1.25, 1.1, 0.5, -1.1, 15}}};
  placido_surface *surface;
  placido_jet jet;
  assert_int_equal(placido_surface_new(&surface, 0.5, 4.5, parts, 2, NULL, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(surface, 1, 2, &jet));
  assert_near(jet.sag, sag_at(&parts[0], 1, 2) + sag_at(&parts[1], 1, 2), 1e-16);
  assert_near(placido_surface_vertex_z_mm(surface), 0.5, 0);
  placido_surface_free(surface);
}

static void the_radius_ends_it(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}};
  placido_surface *surface;
  placido_jet jet;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, &part, 1, NULL, NULL), PLACIDO_OK);
  assert_true(placido_surface_at(surface, 2.7, 3.6, &jet)); /* on the rim */
  assert_true(placido_surface_covered(surface, 2.7, 3.6));
  assert_false(placido_surface_at(surface, 2.7, 3.601, &jet));
  assert_true(isnan(jet.sag));
  assert_false(placido_surface_covered(surface, 2.7, 3.601));
  assert_false(placido_surface_at(surface, NAN, 0, &jet));
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(biconic_derivatives),
      cmocka_unit_test(biconic_of_one_radius_is_a_sphere),
      cmocka_unit_test(biconic_axis_is_where_r1_lies),
      cmocka_unit_test(biconic_ends_at_its_equator),
      cmocka_unit_test(bump_derivatives),
      cmocka_unit_test(bump_stands_forward),
      cmocka_unit_test(ablation_derivatives),
      cmocka_unit_test(ablation_joins_without_a_step),
      cmocka_unit_test(ablation_makes_a_sphere_a_flatter_sphere),
      cmocka_unit_test(ablation_ends),
      cmocka_unit_test(zernike_derivatives),
      cmocka_unit_test(zernike_of_the_highest_order),
      cmocka_unit_test(zernike_terms),
      cmocka_unit_test(zernike_rim),
      cmocka_unit_test(ridge_derivatives),
      cmocka_unit_test(ridge_far_from_the_line),
      cmocka_unit_test(parts_add_up),
      cmocka_unit_test(the_radius_ends_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
