/* B-splines: polynomials are reproduced exactly, derivatives belong, edges hold. */
#include "tests/surface/jets.h"
#include "tests/support/near.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#define SIDE 14
#define KNOTS_MAX (SIDE + 6)

struct spline {
  placido_part part;
  double x[KNOTS_MAX], y[KNOTS_MAX], coefficients[SIDE * SIDE];
};

/* Knots at uneven distances: i + wave sin(1.7 i), scaled so that -5..5 lies in the domain. */
static void fill_knots(double *knots, int degree, double wave) {
  double middle = (SIDE + degree) / 2.0, scale = 10.5 / (SIDE - degree);
  for (int i = 0; i < SIDE + degree + 1; i++) {
    knots[i] = (i - middle + wave * sin(1.7 * i)) * scale;
  }
}

static void fill_spline(struct spline *s, int degree, double wave) {
  *s = (struct spline){0};
  s->part.kind = PLACIDO_PART_BSPLINE;
  s->part.as.bspline.degree = degree;
  s->part.as.bspline.columns = s->part.as.bspline.rows = SIDE;
  s->part.as.bspline.knots_x_mm = s->x;
  s->part.as.bspline.knots_y_mm = s->y;
  s->part.as.bspline.coefficients_mm = s->coefficients;
  fill_knots(s->x, degree, wave);
  fill_knots(s->y, degree, -wave);
}

/* The B-spline coefficient i of t^power: the polar form (blossom) at the function's inner knots,
 * i.e. the elementary symmetric polynomial of them over its number of terms (Ramshaw 1989). */
static double blossom(const double *knots, int i, int degree, int power) {
  double sums[6] = {1}, binomial = 1;
  for (int k = 1; k <= degree; k++) {
    for (int p = k; p >= 1; p--) {
      sums[p] += p < 6 ? sums[p - 1] * knots[i + k] : 0;
    }
  }
  for (int p = 1; p <= power; p++) {
    binomial *= (double)(degree - p + 1) / p;
  }
  return sums[power] / binomial;
}

/* x^a y^b and its derivatives, scaled to a sag of the order of 1 mm. */
static void assert_reproduces(int degree, double wave, int a, int b) {
  struct spline s;
  fill_spline(&s, degree, wave);
  double scale = pow(5, -a - b);
  for (int j = 0; j < SIDE; j++) {
    for (int i = 0; i < SIDE; i++) {
      s.coefficients[j * SIDE + i] =
          scale * blossom(s.x, i, degree, a) * blossom(s.y, j, degree, b);
    }
  }
  placido_surface *surface = surface_of(&s.part);
  for (double y = -4; y <= 4; y += 0.7) {
    for (double x = -4; x <= 4; x += 0.6) {
      placido_jet jet;
      assert_true(placido_surface_at(surface, x, y, &jet));
      double ax = a > 0 ? a * pow(x, a - 1) : 0, by = b > 0 ? b * pow(y, b - 1) : 0;
      double axx = a > 1 ? a * (a - 1) * pow(x, a - 2) : 0;
      double byy = b > 1 ? b * (b - 1) * pow(y, b - 2) : 0;
      assert_near(jet.sag, scale * pow(x, a) * pow(y, b), 1e-13);
      assert_near(jet.sx, scale * ax * pow(y, b), 1e-12);
      assert_near(jet.sy, scale * pow(x, a) * by, 1e-12);
      assert_near(jet.sxx, scale * axx * pow(y, b), 1e-11);
      assert_near(jet.sxy, scale * ax * by, 1e-11);
      assert_near(jet.syy, scale * pow(x, a) * byy, 1e-11);
    }
  }
  placido_surface_free(surface);
}

static void polynomials_of_the_degree_are_reproduced(void **state) {
  (void)state;
  for (int degree = 2; degree <= 5; degree++) {
    for (int a = 0; a <= degree; a++) {
      for (int b = 0; b <= degree; b++) {
        assert_reproduces(degree, 0, a, b);
        assert_reproduces(degree, 0.3, a, b);
      }
    }
  }
}

static void derivatives(void **state) {
  (void)state;
  for (int degree = 2; degree <= 5; degree++) {
    struct spline s;
    fill_spline(&s, degree, 0.3);
    for (int i = 0; i < SIDE * SIDE; i++) {
      s.coefficients[i] = 0.01 * sin(2.3 * i);
    }
    placido_surface *surface = surface_of(&s.part);
    /* no knot lies within 0.02 mm of these, so that differences see one polynomial */
    assert_jet_is_consistent(surface, 0.31, -0.47, 1e-9);
    assert_jet_is_consistent(surface, -2.13, 1.92, 1e-9);
    placido_surface_free(surface);
  }
}

/* Quartic and quintic second derivatives are continuous over every knot. */
static void second_derivatives_have_no_step(void **state) {
  (void)state;
  struct spline s;
  fill_spline(&s, 5, 0.3);
  for (int i = 0; i < SIDE * SIDE; i++) {
    s.coefficients[i] = 0.01 * sin(2.3 * i);
  }
  placido_surface *surface = surface_of(&s.part);
  for (int i = 6; i < SIDE; i++) {
    placido_jet before, behind;
    assert_true(placido_surface_at(surface, s.x[i] - 1e-10, 0.5, &before));
    assert_true(placido_surface_at(surface, s.x[i] + 1e-10, 0.5, &behind));
    assert_near(before.sag, behind.sag, 1e-10);
    assert_near(before.sxx, behind.sxx, 1e-9);
    assert_near(before.syy, behind.syy, 1e-9);
  }
  placido_surface_free(surface);
}

static void it_ends_with_its_knots(void **state) {
  (void)state;
  const double knots[] = {-1, -1, -1, 0.5, 1, 1, 1}; /* clamped */
  const double coefficients[16] = {1, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 4};
  placido_part part = {.kind = PLACIDO_PART_BSPLINE,
                       .as.bspline = {2, 4, 4, knots, knots, coefficients}};
  placido_surface *surface = surface_of(&part);
  placido_jet jet;
  assert_true(placido_surface_at(surface, -1, -1, &jet));
  assert_near(jet.sag, 1, 0);
  assert_true(placido_surface_at(surface, 1, -1, &jet));
  assert_near(jet.sag, 2, 1e-15);
  assert_true(placido_surface_at(surface, -1, 1, &jet));
  assert_near(jet.sag, 3, 1e-15);
  assert_true(placido_surface_at(surface, 1, 1, &jet));
  assert_near(jet.sag, 4, 1e-15);
  assert_false(placido_surface_at(surface, 1.001, 0, &jet));
  assert_true(isnan(jet.sag));
  assert_false(placido_surface_at(surface, 0, -1.001, &jet));
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(polynomials_of_the_degree_are_reproduced),
      cmocka_unit_test(derivatives),
      cmocka_unit_test(second_derivatives_have_no_step),
      cmocka_unit_test(it_ends_with_its_knots),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
