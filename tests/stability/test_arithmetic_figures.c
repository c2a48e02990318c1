/* Formulas of single numbers against extended precision: curvatures where they are nearly 0 / 0,
 * lenses, optical paths, the nodes of a quadrature, colours, and light spread by angle. */
#include "tests/stability/exact.h"
#include "tests/stability/table.h"

#include "reconstruct/maps/kinds.h"
#include "simulate/models/glare.h"
#include "simulate/wavefront.h"

#include <float.h>
#include <math.h>
#include <placido/eye.h>
#include <placido/image.h>
#include <placido/map.h>
#include <placido/wavefront.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static const int numbers[] = {0, 1, 2, 3, 4, 5, 6, 7};

enum { AXIAL, TANGENTIAL, MEAN, GAUSSIAN, CURVATURES };

/* Inputs: x, y, and the jet. */
static quad curvature(const quad *p, const void *which) {
  quad r = hypotq(p[0], p[1]), c = p[0] / r, s = p[1] / r;
  quad slope = c * p[2] + s * p[3], bend = c * c * p[4] + 2 * c * s * p[5] + s * s * p[6];
  quad w = 1 + p[2] * p[2] + p[3] * p[3];
  const quad all[CURVATURES] = {
      slope / (r * sqrtq(1 + slope * slope)), bend / powq(1 + slope * slope, EXACT(1.5)),
      ((1 + p[2] * p[2]) * p[6] - 2 * p[2] * p[3] * p[5] + (1 + p[3] * p[3]) * p[4]) /
          (2 * w * sqrtq(w)),
      (p[4] * p[6] - p[5] * p[5]) / (w * w)};
  int number = *(const int *)which;
  return (number == GAUSSIAN ? 1 : EXACT(337.5)) * all[number];
}

/* A sphere's with some cylinder; the jet is what goes in, so that it need not be exact. */
static void fill_curvature(double in[7], double x, double y) {
  double radius = 7.8, w = sqrt(radius * radius - x * x - y * y);
  const double all[7] = {x,
                         y,
                         x / w + 0.003 * x,
                         y / w - 0.002 * y,
                         1 / w + x * x / (w * w * w) + 0.003,
                         x * y / (w * w * w),
                         1 / w + y * y / (w * w * w) - 0.002};
  memcpy(in, all, sizeof all);
}

/* The direction takes 5 roundings, the slope 3, the bend 8, the root 3, the quotient 3; the mean's
 * numerator 8, its denominator 6. */
static void curvatures(void **state) {
  (void)state;
  static const char *const names[CURVATURES] = {"axial", "tangential", "mean", "Gaussian"};
  static const int roundings[CURVATURES] = {14, 22, 15, 10};
  double (*const functions[CURVATURES])(const placido_map_point *) = {
      placido_map_axial, placido_map_tangential, placido_map_mean, placido_map_gaussian};
  static const struct {
    const char *name;
    double least, most;
  } places[] = {{"cornea", 0.1, 6}, {"near the axis", 2e-9, 1e-3}};
  for (int k = 0; k < CURVATURES; k++) {
    for (int place = 0; place < 2; place++) {
      char name[64];
      snprintf(name, sizeof name, "%s curvature, %s", names[k], places[place].name);
      const struct exact exact = {name, curvature, 7, roundings[k], DBL_EPSILON};
      struct exact_worst worst = {0};
      for (int i = 0; i < 80; i++) {
        double r = places[place].least * pow(places[place].most / places[place].least, i / 79.0);
        double in[7];
        fill_curvature(in, r * cos(0.4 * i), r * sin(0.4 * i));
        const placido_map_point point = {
            .x_mm = in[0], .y_mm = in[1], .jet = {0, in[2], in[3], in[4], in[5], in[6]}};
        exact_compare(&worst, &exact, in, &numbers[k], functions[k](&point));
      }
      exact_row(&exact, &worst);
    }
  }
}

/* Where nothing else is left the axial curvature is the bend along the meridian: within 1e-9 mm of
 * the axis the limit stands in, which differs from the quotient by the next term of the series,
 * r times half the change of the bend, and by what rounding the slope leaves of the quotient. */
static void the_limit_on_the_axis(void **state) {
  (void)state;
  double in[7], worst = 0;
  for (int i = 0; i < 60; i++) {
    double r = 1e-12 * pow(2, i % 10), angle = 0.3 * i;
    fill_curvature(in, r * cos(angle), r * sin(angle));
    placido_map_point point = {
        .x_mm = in[0], .y_mm = in[1], .jet = {0, in[2], in[3], in[4], in[5], in[6]}};
    quad x[7], value;
    for (int k = 0; k < 7; k++) {
      x[k] = in[k];
    }
    value = curvature(x, &numbers[AXIAL]);
    worst = fmax(worst, fabs((double)((placido_map_axial(&point) - value) / value)));
  }
  /* along a sphere the bend changes by 1.5 r²/R³ of itself; 22 roundings of bend and quotient */
  const struct stability_row row = {.name = "axial curvature on the axis, the limit",
                                    .condition = 1,
                                    .perturbation = 1e-9,
                                    .in_unit = "mm",
                                    .change = worst / DBL_EPSILON,
                                    .out_unit = "ulp",
                                    .bound = 22 * 2,
                                    .extended = worst / DBL_EPSILON};
  stability_add(&row);
}

/* Inputs: M, J0, J45, and how much nearer the lens is, mm; 0 to 2 the moved lens, F (1 - d F)^-1
 * with F as a matrix, whose part without a trace is F's over the determinant; 3 to 5 sphere,
 * cylinder, axis. */
static quad lens(const quad *p, const void *which) {
  quad half = hypotq(p[1], p[2]), d = p[3] / 1000;
  quad a = 1 - d * (p[0] + p[1]), b = -d * p[2], c = 1 - d * (p[0] - p[1]);
  quad determinant = a * c - b * b;
  quad xx = ((p[0] + p[1]) * c - p[2] * b) / determinant;
  quad yy = (-p[2] * b + (p[0] - p[1]) * a) / determinant;
  quad axis = atan2q(p[2], p[1]) * 90 / exact_pi();
  const quad all[6] = {(xx + yy) / 2, p[1] / determinant, p[2] / determinant,
                       p[0] + half,   -2 * half,          axis < 0 ? axis + 180 : axis};
  return all[*(const int *)which];
}

/* The half cylinder takes 1 rounding, a meridian's power 1, its way 4, the rest 6. Sphere and
 * cylinder 2, the axis 4. */
static void lenses(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double cylinder;
  } cases[] = {{"astigmatic", 1}, {"1e-9 D of cylinder", 1e-9}, {"1e-300 D of cylinder", 1e-300}};
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
    char names[2][64];
    snprintf(names[0], sizeof names[0], "lens at another distance, %s", cases[c].name);
    snprintf(names[1], sizeof names[1], "sphere, cylinder, axis, %s", cases[c].name);
    const struct exact exact[2] = {{names[0], lens, 4, 12, DBL_EPSILON},
                                   {names[1], lens, 4, 4, DBL_EPSILON}};
    struct exact_worst worst[2] = {{0}};
    for (int i = 0; i < 60; i++) {
      const double in[4] = {16 * sin(0.37 * i), cases[c].cylinder * cos(1.1 * i),
                            cases[c].cylinder * sin(1.1 * i), i % 2 ? 12 : -14};
      const placido_correction worn = {in[0], in[1], in[2]};
      placido_correction moved;
      double sphere, cylinder, axis;
      assert_int_equal(placido_correction_move(&moved, &worn, in[3], NULL), PLACIDO_OK);
      placido_correction_clinical(&worn, &sphere, &cylinder, &axis);
      const double found[6] = {moved.m_D, moved.j0_D, moved.j45_D, sphere, cylinder, axis};
      for (int k = 0; k < 6; k++) {
        exact_compare(&worst[k > 2], &exact[k > 2], in, &numbers[k], found[k]);
      }
    }
    exact_row(&exact[0], &worst[0]);
    exact_row(&exact[1], &worst[1]);
  }
}

/* Node number `index` of Gauss and Legendre within (-1, 1) and its weight, whose sum is 1. */
static quad legendre(int index, int count, quad *weight) {
  quad x = cosq(exact_pi() * (index + EXACT(0.75)) / (count + EXACT(0.5))), slope = 1;
  for (int step = 0; step < 8; step++) {
    quad value = 1, before = 0;
    for (int k = 0; k < count; k++) {
      quad next = ((2 * k + 1) * x * value - k * before) / (k + 1);
      before = value;
      value = next;
    }
    slope = count * (x * value - before) / (x * x - 1);
    x -= value / slope;
  }
  *weight = 1 / ((1 - x * x) * slope * slope);
  return x;
}

/* A node is where the polynomial's recurrence, wrong by 4 roundings a step, is 0: it moves by that
 * over the slope, and the slope is at least count²/2 at a node... times sqrt(1 - x²); so 4 count u
 * P_max / slope with P_max = 1 stays below 8 u. The weight, 1 / ((1 - x²) slope²), has twice the
 * relative error of the slope, count / (1 - x²) times that of a node, and its own 4 count. */
static void quadratures(void **state) {
  (void)state;
  static const int rings[] = {8, 16, 64};
  for (size_t c = 0; c < sizeof rings / sizeof rings[0]; c++) {
    int n = rings[c], count = 3 * n * n;
    double *x = malloc((size_t)count * 3 * sizeof *x), *y = x + count, *weight = y + count;
    char names[2][64];
    snprintf(names[0], sizeof names[0], "quadrature of %d rings: squared radii", n);
    snprintf(names[1], sizeof names[1], "quadrature of %d rings: weights", n);
    const struct exact exact[2] = {{names[0], NULL, 0, 16, DBL_EPSILON},
                                   {names[1], NULL, 0, 8 * n, DBL_EPSILON}};
    struct exact_worst worst[2] = {{0}};
    assert_non_null(x);
    placido_disc_quadrature(x, y, weight, n);
    for (int ring = 0; ring < n; ring++) {
      quad share, node = legendre(ring, n, &share);
      double radius = x[ring * 3 * n];
      /* of numbers between -1 and 1: the radius squared is half of 1 less one of them */
      exact_compare_value(&worst[0], &exact[0], (1 - node) / 2, 1, radius * radius);
      exact_compare_value(&worst[1], &exact[1], share / (3 * n),
                          share / (3 * n) / (1 - node * node), weight[ring * 3 * n]);
    }
    exact_row(&exact[0], &worst[0]);
    exact_row(&exact[1], &worst[1]);
    free(x);
  }
}

static quad to_linear(const quad *p, const void *context) {
  (void)context;
  return p[0] <= EXACT(0.04045) ? p[0] / EXACT(12.92)
                                : powq((p[0] + EXACT(0.055)) / EXACT(1.055), EXACT(2.4));
}

static quad to_srgb(const quad *p, const void *context) {
  (void)context;
  return p[0] <= EXACT(0.0031308) ? p[0] * EXACT(12.92)
                                  : EXACT(1.055) * powq(p[0], 1 / EXACT(2.4)) - EXACT(0.055);
}

/* Constants rounded to float count as much as operations: 0.055, 1.055, sum, quotient, 2.4, power:
 * the exponent's rounding counts ln(base) times 2.4, at most 5 (a base of 0.09); 12 in all. The way
 * back has as many, and 1/2.4 counts ln(0.0031)/2.4 = 2.4; the difference at the end is 1/3 of what
 * it is taken from at least. */
static void colours(void **state) {
  (void)state;
  const struct exact exact[2] = {{"sRGB to linear light, float", to_linear, 1, 12, FLT_EPSILON},
                                 {"linear light to sRGB, float", to_srgb, 1, 12, FLT_EPSILON}};
  struct exact_worst worst[2] = {{0}};
  placido_image images[2];
  enum { COUNT = 4096 };
  for (int k = 0; k < 2; k++) {
    float in[COUNT];
    assert_int_equal(placido_image_new(&images[k], COUNT, 1, 1, NULL), PLACIDO_OK);
    for (int i = 0; i < COUNT; i++) {
      in[i] = i < 64 ? ldexpf(1, -i) : (float)(i - 64) / (COUNT - 65);
      images[k].data[i] = in[i];
    }
    if (k == 0) {
      placido_image_to_linear(&images[k]);
    } else {
      placido_image_to_srgb(&images[k]);
    }
    for (int i = 0; i < COUNT; i++) {
      double x = (double)in[i];
      exact_compare(&worst[k], &exact[k], &x, NULL, (double)images[k].data[i]);
    }
    exact_row(&exact[k], &worst[k]);
    placido_image_free(&images[k]);
  }
}

/* CIE 135/1, equation 5; inputs: angle, age, pigment. */
static quad glare(const quad *p, const void *context) {
  (void)context;
  quad t = p[0], a = powq(p[1] / 70, 4), f = p[2];
  quad first = 1 + powq(t / EXACT(0.0046), 2), second = 1 + powq(t / EXACT(0.045), 2),
       wide = 1 + powq(t / EXACT(0.1), 2);
  quad core = EXACT(9.2e6) / powq(first, EXACT(1.5)) + EXACT(1.5e5) / powq(second, EXACT(1.5));
  quad scatter = 400 / wide + EXACT(3e-8) * t * t;
  quad pigmented = f * (1300 / powq(wide, EXACT(1.5)) + EXACT(0.8) / sqrtq(wide));
  return ((1 - EXACT(0.08) * a) * core + (1 + EXACT(1.6) * a) * (scatter + pigmented) +
          EXACT(2.5e-3) * f) /
         (1 + f * (EXACT(0.0417) + EXACT(0.055) * a));
}

/* The age's factor 4 roundings, a bell 5, a term 4, the sums 6, the quotient 4; each constant 1. */
static void light_by_angle(void **state) {
  (void)state;
  const struct exact exact = {"glare by angle", glare, 3, 26, DBL_EPSILON};
  struct exact_worst worst = {0};
  for (int i = 0; i < 200; i++) {
    double in[3] = {1e-6 * pow(1e8, i / 199.0), 20 + 0.3 * i, i % 2 ? 0.5 : 1.2};
    const placido_glare eye = {.age_years = in[1], .pigment = in[2]};
    exact_compare(&worst, &exact, in, NULL, placido_glare_per_sr(&eye, in[0]));
  }
  exact_row(&exact, &worst);
}

enum {
  PATH_X,
  PATH_Y,
  PATH_RADIUS,
  PATH_INDEX,
  FOCUS_X,
  FOCUS_Y,
  FOCUS_Z,
  WORN_M,
  WORN_J0,
  WORN_J45,
  PATH_INPUTS
};

static quad path(const quad *p, quad x, quad y) {
  quad square = x * x + y * y, radius = p[PATH_RADIUS];
  quad depth = square / (radius + sqrtq(radius * radius - square));
  quad dx = x - p[FOCUS_X], dy = y - p[FOCUS_Y], dz = depth - p[FOCUS_Z];
  quad lens = p[WORN_M] * square + p[WORN_J0] * (x * x - y * y) + 2 * p[WORN_J45] * x * y;
  return depth + p[PATH_INDEX] * sqrtq(dx * dx + dy * dy + dz * dz) - lens / 2000;
}

/* In micrometres, for a pupil about the axis of a sphere. */
static quad path_difference(const quad *p, const void *context) {
  (void)context;
  return 1000 * (path(p, 0, 0) - path(p, p[PATH_X], p[PATH_Y]));
}

/* Depth 8 roundings, the distance's difference 12, the lens 8, the sum 4. */
static void paths(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double pupil_mm;
    placido_correction lens;
  } cases[] = {{"path difference, 6 mm pupil", 6, {0, 0, 0}},
               {"path difference behind a lens", 5, {-3, 0.5, -0.25}},
               {"path difference, 0.3 mm pupil", 0.3, {0, 0, 0}}};
  const placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}};
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 6, &part, 1, NULL, NULL), PLACIDO_OK);
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
    const struct exact exact = {cases[c].name, path_difference, PATH_INPUTS, 32, DBL_EPSILON};
    struct exact_worst worst = {0};
    const placido_eye eye = {.pupil_mm = cases[c].pupil_mm, .correction = cases[c].lens};
    placido_wavefront w;
    assert_int_equal(placido_wavefront_new(&w, surface, &eye, NULL, NULL, NULL), PLACIDO_OK);
    for (size_t i = 0; i < w.count; i++) {
      const double in[PATH_INPUTS] = {w.x_mm[i],          w.y_mm[i],         7.8,
                                      w.eye.index,        w.focus_mm[0],     w.focus_mm[1],
                                      w.focus_mm[2],      cases[c].lens.m_D, cases[c].lens.j0_D,
                                      cases[c].lens.j45_D};
      exact_compare(&worst, &exact, in, NULL, w.opd_um[i]);
    }
    exact_row(&exact, &worst);
    placido_wavefront_free(&w);
  }
  placido_surface_free(surface);
}

static void every_error_is_within(void **state) {
  (void)state;
  assert_int_equal(stability_print("arithmetic: figures"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(curvatures), cmocka_unit_test(the_limit_on_the_axis),
      cmocka_unit_test(lenses),     cmocka_unit_test(quadratures),
      cmocka_unit_test(colours),    cmocka_unit_test(light_by_angle),
      cmocka_unit_test(paths),      cmocka_unit_test(every_error_is_within),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
