/* Zernike's polynomials up to order 15 and B-splines against their formulas in extended precision.
 */
#include "tests/stability/exact_jet.h"
#include "tests/stability/table.h"

#include <float.h>
#include <math.h>
#include <placido/surface.h>
#include <placido/zernike.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static double number_of(const placido_jet *jet, int which) {
  const double all[6] = {jet->sag, jet->sx, jet->sy, jet->sxx, jet->sxy, jet->syy};
  return all[which];
}

static quad factorial(int n) {
  quad product = 1;
  for (int i = 2; i <= n; i++) {
    product *= i;
  }
  return product;
}

/* One number of one term's jet. */
struct term {
  int n, m, which;
};

/* N Σ (-1)^k (n - k)! / (k! ((n + m)/2 - k)! ((n - m)/2 - k)!) ρ^(n - 2k) times cos(m θ) or sin(m
 * θ), as powers of x and y: ρ^m cos(m θ) + i ρ^m sin(m θ) = (x + iy)^m. Inputs: radius, x, y, and
 * by how much the axes are turned, plus 1: rounding may turn them, too, which is all that tells how
 * near to 0 a derivative can come that is 0 by symmetry. */
static quad zernike(const quad *p, const void *context) {
  const struct term *term = context;
  int m = abs(term->m), half = (term->n - m) / 2;
  quad c = cosq(p[3] - 1) / p[0], s = sinq(p[3] - 1) / p[0];
  exact_jet x = exact_line(c, s, 0, p[1], p[2]), y = exact_line(-s, c, 0, p[1], p[2]);
  exact_jet square = exact_sum(exact_product(x, x), exact_product(y, y));
  exact_jet radial = exact_constant(0), real = exact_constant(1), imaginary = exact_constant(0);
  for (int k = 0; k <= half; k++) {
    quad share = factorial(term->n - k) /
                 (factorial(k) * factorial((term->n + m) / 2 - k) * factorial(half - k));
    radial = exact_sum(exact_product(radial, square), exact_constant(k % 2 ? -share : share));
  }
  for (int k = 0; k < m; k++) {
    exact_jet turned =
        exact_sum(exact_product(real, x), exact_scaled(exact_product(imaginary, y), -1));
    imaginary = exact_sum(exact_product(real, y), exact_product(imaginary, x));
    real = turned;
  }
  exact_jet value = exact_product(radial, term->m < 0 ? imaginary : real);
  return sqrtq((m == 0 ? 1 : 2) * (quad)(term->n + 1)) * exact_of(&value, term->which);
}

static const double places[][2] = {{0, 0},         {1e-9, 2e-9}, {0.1, -0.3},  {0.5, 0.2},
                                   {-0.7, 0.4},    {0.3, 0.93},  {-0.99, 0.1}, {0.6, 0.8},
                                   {-0.28, -0.96}, {1, 0}};

/* A term of frequency m takes 2 m roundings to (x + iy)^m, a polynomial in the square 2 a power,
 * the rest 8: at most 2 n + 8; a derivative has each of them once more. */
static int roundings_of(int order, int which) {
  return (2 * order + 8) * (which == 0 ? 1 : which < 3 ? 2 : 3);
}

static void compare_terms(int first, int last) {
  const double radius_mm = 3.25;
  static const char *const names[3] = {"Zernike part of order %d: sag",
                                       "Zernike part of order %d: slope",
                                       "Zernike part of order %d: bends"};
  struct exact_worst worst[3] = {{0}};
  struct exact exact[3];
  char texts[3][64];
  for (int k = 0; k < 3; k++) {
    snprintf(texts[k], sizeof texts[k], names[k], last);
    exact[k] = (struct exact){texts[k], zernike, 4, roundings_of(last, 2 * k), DBL_EPSILON};
  }
  for (int j = placido_zernike_count(first - 1); j < placido_zernike_count(last); j++) {
    placido_part part;
    placido_surface *surface;
    struct term term;
    memset(&part, 0, sizeof part);
    part.kind = PLACIDO_PART_ZERNIKE;
    part.as.zernike.radius_mm = radius_mm;
    part.as.zernike.coefficients_um[j] = 1000; /* 1 mm */
    placido_zernike_name(j, &term.n, &term.m);
    assert_int_equal(placido_surface_new(&surface, 0, 20, &part, 1, NULL, NULL), PLACIDO_OK);
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
      const double x[4] = {radius_mm, radius_mm * places[i][0], radius_mm * places[i][1], 1};
      placido_jet jet;
      assert_true(placido_surface_at(surface, x[1], x[2], &jet));
      for (term.which = 0; term.which < 6; term.which++) {
        int k = term.which == 0 ? 0 : term.which < 3 ? 1 : 2;
        exact_compare(&worst[k], &exact[k], x, &term, number_of(&jet, term.which));
      }
    }
    placido_surface_free(surface);
  }
  for (int k = 0; k < 3; k++) {
    exact_row(&exact[k], &worst[k]);
  }
}

static void zernike_parts(void **state) {
  (void)state;
  compare_terms(1, 4);
  compare_terms(5, 8);
  compare_terms(9, 15);
}

static void zernike_terms(void **state) {
  (void)state;
  enum { COUNT = sizeof places / sizeof places[0] };
  static const int orders[] = {4, 8, 15};
  double x[COUNT], y[COUNT], values[PLACIDO_ZERNIKE_TERMS * COUNT];
  for (size_t i = 0; i < COUNT; i++) {
    x[i] = places[i][0];
    y[i] = places[i][1];
  }
  for (int k = 0; k < 3; k++) {
    char name[64];
    snprintf(name, sizeof name, "Zernike terms of order %d", orders[k]);
    const struct exact exact = {name, zernike, 4, roundings_of(orders[k], 0), DBL_EPSILON};
    struct exact_worst worst = {0};
    struct term term = {.which = 0};
    placido_zernike_terms(values, orders[k], x, y, COUNT);
    for (int j = 0; j < placido_zernike_count(orders[k]); j++) {
      placido_zernike_name(j, &term.n, &term.m);
      for (size_t i = 0; i < COUNT; i++) {
        exact_compare(&worst, &exact, (const double[]){1, x[i], y[i], 1}, &term,
                      values[(size_t)j * COUNT + i]);
      }
    }
    exact_row(&exact, &worst);
  }
}

#define DEGREE_MAX 5
#define COEFFICIENTS 12 /* a side */
#define KNOTS_MAX (COEFFICIENTS + DEGREE_MAX + 1)

/* A spline, and which number of its jet is asked for. */
struct spline {
  int degree, which, column, row; /* the first coefficients that count at the point */
  double knots[KNOTS_MAX];
  double coefficients[COEFFICIENTS * COEFFICIENTS]; /* y outer */
};

/* Basis function i of a degree and its derivatives, by the recurrence of Cox and de Boor: a jet in
 * x alone. */
static exact_jet basis(const struct spline *s, int i, int degree, quad x) {
  const double *k = s->knots;
  if (degree == 0) {
    return exact_constant(x >= k[i] && x < k[i + 1] ? 1 : 0);
  }
  exact_jet sum = exact_constant(0);
  if (k[i + degree] > k[i]) {
    quad range = (quad)k[i + degree] - k[i];
    exact_jet rise = exact_line(1 / range, 0, -k[i] / range, x, 0);
    sum = exact_product(rise, basis(s, i, degree - 1, x));
  }
  if (k[i + degree + 1] > k[i + 1]) {
    quad range = (quad)k[i + degree + 1] - k[i + 1];
    exact_jet fall = exact_line(-1 / range, 0, k[i + degree + 1] / range, x, 0);
    sum = exact_sum(sum, exact_product(fall, basis(s, i + 1, degree - 1, x)));
  }
  return sum;
}

/* Σ coefficient · basis function, or with `sizes` the sum of their sizes, which is Σ |c ∂f/∂c|. */
static quad sum_of(const quad *p, const struct spline *s, bool sizes) {
  static const int derivative[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
  const int orders[3] = {0, 1, 3}; /* value, slope and bend of a jet in x alone */
  quad sum = 0, along[DEGREE_MAX + 1];
  for (int i = 0; i <= s->degree; i++) {
    exact_jet b = basis(s, s->column + i, s->degree, p[0]);
    along[i] = exact_of(&b, orders[derivative[s->which][0]]);
  }
  for (int j = 0; j <= s->degree; j++) {
    exact_jet b = basis(s, s->row + j, s->degree, p[1]);
    quad across = exact_of(&b, orders[derivative[s->which][1]]);
    for (int i = 0; i <= s->degree; i++) {
      quad term = across * along[i] * s->coefficients[(s->row + j) * COEFFICIENTS + s->column + i];
      sum += sizes ? fabsq(term) : term;
    }
  }
  return sum;
}

/* Inputs: x and y. */
static quad bspline(const quad *p, const void *context) {
  return sum_of(p, context, false);
}

/* Any knots, some of them twice. */
static void make_spline(struct spline *s, int degree) {
  s->degree = degree;
  for (int i = 0; i < COEFFICIENTS + degree + 1; i++) {
    s->knots[i] = -4 + 0.6 * (i == 9 ? 8 : i) + 0.2 * sin(5 * (i == 9 ? 8 : i));
  }
  for (int i = 0; i < COEFFICIENTS * COEFFICIENTS; i++) {
    s->coefficients[i] = sin(0.7 * i * i) + 1e-3 * i;
  }
}

static int first_of(const struct spline *s, double x) {
  int span = s->degree;
  while (span < COEFFICIENTS - 1 && x >= s->knots[span + 1]) {
    span++;
  }
  return span - s->degree;
}

static void compare_spline(struct exact_worst worst[3], const struct exact exact[3],
                           struct spline *s, const placido_surface *surface, double x, double y) {
  const quad in[2] = {x, y};
  placido_jet jet;
  s->column = first_of(s, x);
  s->row = first_of(s, y);
  assert_true(placido_surface_at(surface, x, y, &jet));
  for (s->which = 0; s->which < 6; s->which++) {
    int k = s->which == 0 ? 0 : s->which < 3 ? 1 : 2;
    quad value = bspline(in, s);
    quad amplification = exact_amplification(&exact[k], in, s, value) + sum_of(in, s, true);
    exact_compare_value(&worst[k], &exact[k], value, amplification, number_of(&jet, s->which));
  }
}

/* The expansion of a basis function by its powers takes 4 roundings a degree, its evaluation 2, the
 * sum over the coefficients one each way: 8 (degree + 1). */
static void bsplines(void **state) {
  (void)state;
  static const char *const orders[3] = {"sag", "slope", "bends"};
  for (int degree = 3; degree <= DEGREE_MAX; degree += 2) {
    struct spline s;
    struct exact_worst worst[3] = {{0}};
    struct exact exact[3];
    char names[3][64];
    placido_surface *surface;
    make_spline(&s, degree);
    const placido_part part = {
        .kind = PLACIDO_PART_BSPLINE,
        .as.bspline = {degree, COEFFICIENTS, COEFFICIENTS, s.knots, s.knots, s.coefficients}};
    assert_int_equal(placido_surface_new(&surface, 0, 20, &part, 1, NULL, NULL), PLACIDO_OK);
    for (int k = 0; k < 3; k++) {
      snprintf(names[k], sizeof names[k], "B-spline of degree %d: %s", degree, orders[k]);
      exact[k] = (struct exact){names[k], bspline, 2, 8 * (degree + 1), DBL_EPSILON};
    }
    for (int i = 0; i < 60; i++) {
      double at[2], first = s.knots[degree], last = s.knots[COEFFICIENTS];
      for (int axis = 0; axis < 2; axis++) { /* every fifth on a knot, or as near as can be */
        at[axis] = first + (last - first) * (0.5 + 0.499 * sin(1.7 * i * (axis + 1) + axis));
        at[axis] =
            i % 5 == axis ? nextafter(s.knots[degree + 1 + i % 6], i % 2 ? 9 : -9) : at[axis];
      }
      compare_spline(worst, exact, &s, surface, at[0], at[1]);
    }
    for (int k = 0; k < 3; k++) {
      exact_row(&exact[k], &worst[k]);
    }
    placido_surface_free(surface);
  }
}

static void every_error_is_within(void **state) {
  (void)state;
  assert_int_equal(stability_print("arithmetic: polynomials"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(zernike_parts),
      cmocka_unit_test(zernike_terms),
      cmocka_unit_test(bsplines),
      cmocka_unit_test(every_error_is_within),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
