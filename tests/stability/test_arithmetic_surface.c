/* The parts of a surface against their formulas in extended precision: near the apex, near the
 * border of their domain, nearly flat, very steep, and where numbers lose their digits. */
#include "tests/stability/exact_jet.h"
#include "tests/stability/table.h"

#include "reconstruct/surface/sheet.h"

#include <float.h>
#include <math.h>
#include <placido/surface.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

enum { SAG, SLOPE, BEND, ORDERS, PARAMETERS_MAX = 9 };

/* Which of a jet's numbers a formula is asked for. */
static const int all_of[6] = {0, 1, 2, 3, 4, 5};

/* Sag, slopes and second derivatives have rows of their own. */
static const int order_of[6] = {SAG, SLOPE, SLOPE, BEND, BEND, BEND};
static const char *const order_names[ORDERS] = {"sag", "slope", "bends"};

/* A kind of part as the formula sees it: parameters, and then x and y. */
struct kind {
  quad (*formula)(const quad *x, const void *which);
  void (*fill)(placido_part *part, const double *parameters);
  int parameters;
  int roundings[ORDERS];
};

static double number_of(const placido_jet *jet, int which) {
  const double all[6] = {jet->sag, jet->sx, jet->sy, jet->sxx, jet->sxy, jet->syy};
  return all[which];
}

static placido_surface *surface_of(const struct kind *kind, const double *parameters) {
  placido_part part;
  placido_surface *surface;
  memset(&part, 0, sizeof part);
  kind->fill(&part, parameters);
  assert_int_equal(placido_surface_new(&surface, 0, 20, &part, 1, NULL, NULL), PLACIDO_OK);
  return surface;
}

/* Compares the jets at points (x, y) and adds three rows; the points where the formula has no
 * number are those where the surface has none. */
static void compare_at(const char *name, const struct kind *kind, const double *parameters,
                       const double (*points)[2], size_t count) {
  placido_surface *surface = surface_of(kind, parameters);
  struct exact_worst worst[ORDERS] = {{0}};
  struct exact exact[ORDERS];
  char names[ORDERS][80];
  for (int order = 0; order < ORDERS; order++) {
    snprintf(names[order], sizeof names[order], "%s: %s", name, order_names[order]);
    exact[order] = (struct exact){names[order], kind->formula, kind->parameters + 2,
                                  kind->roundings[order], DBL_EPSILON};
  }
  for (size_t i = 0; i < count; i++) {
    double x[PARAMETERS_MAX];
    placido_jet jet;
    memcpy(x, parameters, (size_t)kind->parameters * sizeof *x);
    x[kind->parameters] = points[i][0];
    x[kind->parameters + 1] = points[i][1];
    assert_true(placido_surface_at(surface, points[i][0], points[i][1], &jet));
    for (int which = 0; which < 6; which++) {
      exact_compare(&worst[order_of[which]], &exact[order_of[which]], x, &all_of[which],
                    number_of(&jet, which));
    }
  }
  for (int order = 0; order < ORDERS; order++) {
    exact_row(&exact[order], &worst[order]);
  }
  placido_surface_free(surface);
}

/* Points on rays from (cx, cy) with these distances. */
static size_t spokes(double (*points)[2], const double *distances, size_t count, double cx,
                     double cy) {
  enum { SPOKES = 7 };
  for (size_t i = 0; i < count * SPOKES; i++) {
    double angle = 0.1 + 2 * 3.14159 * (double)(i % SPOKES) / SPOKES;
    points[i][0] = cx + distances[i / SPOKES] * cos(angle);
    points[i][1] = cy + distances[i / SPOKES] * sin(angle);
  }
  return count * SPOKES;
}

#define ROOM 128

/* n / (1 + sqrt(1 - k1 u² - k2 v²)), n = u²/r1 + v²/r2, k = (1 + q)/r². */
static quad biconic(const quad *p, const void *which) {
  quad angle = p[4] * exact_pi() / 180, c = cosq(angle), s = sinq(angle);
  quad x = p[7] - p[5], y = p[8] - p[6];
  exact_jet u = exact_line(c, s, 0, x, y), v = exact_line(-s, c, 0, x, y);
  exact_jet uu = exact_product(u, u), vv = exact_product(v, v);
  exact_jet n = exact_sum(exact_scaled(uu, 1 / p[0]), exact_scaled(vv, 1 / p[2]));
  exact_jet root =
      exact_sum(exact_constant(1), exact_sum(exact_scaled(uu, -(1 + p[1]) / (p[0] * p[0])),
                                             exact_scaled(vv, -(1 + p[3]) / (p[2] * p[2]))));
  exact_jet below = exact_sum(exact_constant(1), exact_root(root));
  exact_jet sag = exact_product(n, exact_inverse(below));
  return exact_of(&sag, *(const int *)which);
}

static void fill_biconic(placido_part *part, const double *p) {
  *part = (placido_part){.kind = PLACIDO_PART_BICONIC,
                         .as.biconic = {p[0], p[1], p[2], p[3], p[4], p[5], p[6]}};
}

/* Roundings on the way: to u 6 (angle, sine, shift, two products, sum), to the root 10 more, to the
 * sag 5; a slope has 9 more and 3 of the turn back; a second derivative 16 and 8. */
static const struct kind biconic_kind = {biconic, fill_biconic, 7, {21, 33, 57}};

/* 1 - (1 + q) c² ρ² is left at the farthest points. */
static size_t near_equator(double (*points)[2], double radius) {
  static const double left[] = {0.5, 1e-2, 1e-4, 1e-7, 1e-10, 1e-13};
  double distances[6];
  for (int i = 0; i < 6; i++) {
    distances[i] = radius * sqrt(1 - left[i]);
  }
  return spokes(points, distances, 6, 0, 0);
}

static void conicoids(void **state) {
  (void)state;
  static const double usual[] = {0, 0.3, 1, 2, 3, 4, 5};
  static const double tiny[] = {1e-3, 1e-8, 1e-20, 1e-150, 1e-300, 1e-310, 5e-324};
  static const double wide[] = {1, 5, 10, 19};
  double points[ROOM][2];
  size_t count = spokes(points, usual, 7, 0, 0);
  compare_at("biconic cornea", &biconic_kind, (const double[]){7.9, -0.2, 7.4, -0.4, 30, 0.1, -0.2},
             (const double(*)[2])points, count);
  compare_at("severe keratoconus", &biconic_kind, (const double[]){5, -1.2, 4.6, -0.9, 75, -1, 0.7},
             (const double(*)[2])points, spokes(points, usual, 6, 0, 0));
  compare_at("nearly flat", &biconic_kind, (const double[]){1e6, -3, -2e7, 5, 10, 0, 0},
             (const double(*)[2])points, count = spokes(points, usual, 7, 0, 0));
  compare_at("apex, down to the least number", &biconic_kind,
             (const double[]){7.8, -0.3, 7.5, -0.2, 20, 0, 0}, (const double(*)[2])points,
             count = spokes(points, tiny, 7, 0, 0));
  compare_at("equator of a sphere", &biconic_kind, (const double[]){8, 0, 8, 0, 0, 0, 0},
             (const double(*)[2])points, near_equator(points, 8));
  compare_at("equator of an ellipsoid", &biconic_kind, (const double[]){6, 0.5, 6, 0.5, 45, 0, 0},
             (const double(*)[2])points, near_equator(points, 6 / sqrt(1.5)));
  compare_at("wide hyperboloid", &biconic_kind, (const double[]){7, -6, 8, -4, 60, 0.3, 0},
             (const double(*)[2])points, count = spokes(points, wide, 4, 0, 0));
  compare_at("very nearly a paraboloid", &biconic_kind,
             (const double[]){7.5, -1 + 1e-12, 7.5, -1, 0, 0, 0}, (const double(*)[2])points,
             count);
}

/* The same along lines, by another formula, without second derivatives. */
static void conicoids_along_lines(void **state) {
  (void)state;
  const double parameters[] = {7.9, -0.2, 7.4, -0.4, 30, 0.1, -0.2};
  const struct exact exact[2] = {{"biconic along a line: sag", biconic, 9, 23, DBL_EPSILON},
                                 {"biconic along a line: slope", biconic, 9, 36, DBL_EPSILON}};
  enum { COUNT = 101 };
  double x[COUNT], sag[COUNT], sx[COUNT], sy[COUNT];
  struct exact_worst worst[2] = {{0}};
  placido_surface *surface = surface_of(&biconic_kind, parameters);
  placido_sheet *sheet;
  for (int i = 0; i < COUNT; i++) {
    x[i] = 0.13 * (i - COUNT / 2);
  }
  assert_int_equal(placido_sheet_new(&sheet, surface, x, COUNT, NULL), PLACIDO_OK);
  double *work = malloc((placido_sheet_work(sheet) + 1) * sizeof *work);
  for (double y = -6.5; y <= 6.5; y += 1.3) {
    placido_sheet_line(sheet, work, y, 0, COUNT, sag, sx, sy);
    for (int i = 0; i < COUNT; i++) {
      double in[9];
      memcpy(in, parameters, sizeof parameters);
      in[7] = x[i];
      in[8] = y;
      if (!isnan(sag[i])) {
        exact_compare(&worst[0], &exact[0], in, &all_of[0], sag[i]);
        exact_compare(&worst[1], &exact[1], in, &all_of[1], sx[i]);
        exact_compare(&worst[1], &exact[1], in, &all_of[2], sy[i]);
      }
    }
  }
  exact_row(&exact[0], &worst[0]);
  exact_row(&exact[1], &worst[1]);
  free(work);
  placido_sheet_free(sheet);
  placido_surface_free(surface);
}

static quad bump(const quad *p, const void *which) {
  quad angle = p[5] * exact_pi() / 180, c = cosq(angle), s = sinq(angle);
  quad x = p[6] - p[3], y = p[7] - p[4];
  exact_jet u = exact_line(c / p[1], s / p[1], 0, x, y);
  exact_jet v = exact_line(-s / p[2], c / p[2], 0, x, y);
  exact_jet sum = exact_sum(exact_product(u, u), exact_product(v, v));
  exact_jet sag = exact_scaled(exact_exp(exact_scaled(sum, -0.5)), -p[0]);
  return exact_of(&sag, *(const int *)which);
}

static void fill_bump(placido_part *part, const double *p) {
  *part =
      (placido_part){.kind = PLACIDO_PART_BUMP, .as.bump = {p[0], p[1], p[2], p[3], p[4], p[5]}};
}

/* To u 6, to the exponent 5 more, exp 1, the products with u and v 6, the turn 8. */
static const struct kind bump_kind = {bump, fill_bump, 6, {14, 19, 26}};

static quad ridge(const quad *p, const void *which) {
  quad angle = p[3] * exact_pi() / 180;
  exact_jet t = exact_scaled(exact_line(-sinq(angle), cosq(angle), -p[2], p[4], p[5]), 1 / p[1]);
  quad e = expq(-fabsq(t.f)), first = (t.f >= 0 ? 1 : e) / (1 + e);
  exact_jet sag = exact_scaled(
      exact_chain(t, (t.f > 0 ? t.f : 0) + log1pq(e), first, e / ((1 + e) * (1 + e))), p[0] * p[1]);
  return exact_of(&sag, *(const int *)which);
}

static void fill_ridge(placido_part *part, const double *p) {
  *part = (placido_part){.kind = PLACIDO_PART_RIDGE, .as.ridge = {p[0], p[1], p[2], p[3]}};
}

/* To t 8, exp and log1p 2, the products 6. */
static const struct kind ridge_kind = {ridge, fill_ridge, 4, {14, 15, 18}};

/* Two spheres' difference, from the dioptres that lie between them, and as high in the zone's
 * centre as the blend has it; the blend is the quintic with the value, slope and second derivative
 * of its ends. */
static quad ablation(const quad *p, const void *which) {
  quad r0 = p[3], r1 = 1 / (1 / r0 - p[0] / 1000 / (p[4] - 1)), zone = p[1] / 2;
  exact_jet x = exact_line(1, 0, -p[5], p[7], p[8]), y = exact_line(0, 1, -p[6], p[7], p[8]);
  exact_jet square = exact_sum(exact_product(x, x), exact_product(y, y));
  quad s0 = sqrtq(r0 * r0 - zone * zone), s1 = sqrtq(r1 * r1 - zone * zone);
  quad w = p[2], slope = (zone / s1 - zone / s0) * w, rim = -slope / 2;
  quad second = (r1 * r1 / (s1 * s1 * s1) - r0 * r0 / (s0 * s0 * s0)) * w * w;
  exact_jet sag;
  if (square.f < zone * zone) {
    exact_jet a = exact_root(exact_sum(exact_constant(r0 * r0), exact_scaled(square, -1)));
    exact_jet b = exact_root(exact_sum(exact_constant(r1 * r1), exact_scaled(square, -1)));
    sag = exact_sum(exact_sum(a, exact_scaled(b, -1)), exact_constant(rim - s0 + s1));
  } else {
    const quad q[6] = {rim,
                       slope,
                       second / 2,
                       -10 * rim - 6 * slope - 3 * second / 2,
                       15 * rim + 8 * slope + 3 * second / 2,
                       -6 * rim - 3 * slope - second / 2};
    exact_jet t = exact_scaled(exact_sum(exact_root(square), exact_constant(-zone)), 1 / w);
    sag = exact_constant(0);
    for (int k = 5; k >= 0; k--) {
      sag = exact_sum(exact_product(sag, t), exact_constant(q[k]));
    }
  }
  return exact_of(&sag, *(const int *)which);
}

static void fill_ablation(placido_part *part, const double *p) {
  *part = (placido_part){.kind = PLACIDO_PART_ABLATION,
                         .as.ablation = {p[0], p[1], p[2], p[3], p[4], p[5], p[6]}};
}

/* To the difference of the radii 6, of their roots 6, of the heights 3; bends have 10 more. */
static const struct kind ablation_kind = {ablation, fill_ablation, 7, {15, 18, 28}};

static void other_parts(void **state) {
  (void)state;
  static const double near[] = {1e-300, 1e-9, 1e-3, 0.1, 0.7, 1.5, 2.4};
  static const double far[] = {3, 6, 10, 15, 19.9}, blend[] = {3.1, 3.5, 4, 4.15};
  double points[ROOM][2];
  size_t count = spokes(points, near, 7, 0, 0);
  const double(*const at)[2] = (const double(*)[2])points;
  compare_at("cone of keratoconus", &bump_kind, (const double[]){0.08, 0.9, 1.1, 0.4, -0.6, 25}, at,
             count);
  compare_at("ridge", &ridge_kind, (const double[]){0.02, 0.12, 0.3, 15}, at, count);
  compare_at("ablation of -6 D", &ablation_kind, (const double[]){6, 6, 1.2, 7.8, 1.376, 0, 0}, at,
             count);
  compare_at("ablation of a millionth of a D", &ablation_kind,
             (const double[]){1e-6, 6, 1.2, 7.8, 1.376, 0, 0}, at, count);
  compare_at("ablation's blend", &ablation_kind, (const double[]){6, 6, 1.2, 7.8, 1.376, 0, 0}, at,
             spokes(points, blend, 4, 0, 0));
  count = spokes(points, far, 5, 0, 0);
  compare_at("cone, far away", &bump_kind, (const double[]){0.08, 0.9, 1.1, 0.4, -0.6, 25}, at,
             count);
  compare_at("ridge, far away", &ridge_kind, (const double[]){0.02, 0.12, 0.3, 15}, at, count);
}

static void every_error_is_within(void **state) {
  (void)state;
  assert_int_equal(stability_print("arithmetic: the parts of a surface"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(conicoids),
      cmocka_unit_test(conicoids_along_lines),
      cmocka_unit_test(other_parts),
      cmocka_unit_test(every_error_is_within),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
