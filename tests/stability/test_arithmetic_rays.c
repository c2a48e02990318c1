/* What happens to a ray, against the textbooks' formulas in extended precision: the camera with its
 * distortion, the mirror and its derivatives, and Snell's law. */
#include "tests/stability/exact_jet.h"
#include "tests/stability/table.h"

#include "reconstruct/mirror.h"
#include "simulate/rays/refract.h"
#include "simulate/trace.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static const int numbers[] = {0, 1, 2, 3, 4, 5, 6, 7};

/* Brown's distortion of (x, y) by k1 k2 p1 p2 k3, and its derivatives. */
static void distort(quad out[2], quad slopes[2][2], const quad *k, quad x, quad y) {
  quad r2 = x * x + y * y, radial = 1 + k[0] * r2 + k[1] * r2 * r2 + k[4] * r2 * r2 * r2;
  quad by_r2 = k[0] + 2 * k[1] * r2 + 3 * k[4] * r2 * r2;
  out[0] = x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x);
  out[1] = y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y;
  slopes[0][0] = radial + 2 * x * x * by_r2 + 2 * k[2] * y + 6 * k[3] * x;
  slopes[0][1] = slopes[1][0] = 2 * x * y * by_r2 + 2 * k[2] * x + 2 * k[3] * y;
  slopes[1][1] = radial + 2 * y * y * by_r2 + 6 * k[2] * y + 2 * k[3] * x;
}

/* Direction across, and its derivatives by u and v: x, y, x by u, y by u, x by v, y by v. Inputs:
 * u, v, focal lengths, principal point, k1 k2 p1 p2 k3. */
static quad camera(const quad *p, const void *which) {
  quad target[2] = {(p[0] - p[4]) / p[2], (p[1] - p[5]) / p[3]}, xy[2] = {target[0], target[1]};
  quad at[2], s[2][2], inverse[2][2] = {{0}};
  for (int step = 0; step < 30; step++) {
    distort(at, s, p + 6, xy[0], xy[1]);
    quad determinant = s[0][0] * s[1][1] - s[0][1] * s[1][0];
    inverse[0][0] = s[1][1] / determinant;
    inverse[0][1] = inverse[1][0] = -s[0][1] / determinant;
    inverse[1][1] = s[0][0] / determinant;
    for (int i = 0; i < 2; i++) {
      xy[i] += inverse[i][0] * (target[0] - at[0]) + inverse[i][1] * (target[1] - at[1]);
    }
  }
  const quad all[6] = {xy[0],
                       -xy[1],
                       inverse[0][0] / p[2],
                       -inverse[1][0] / p[2],
                       inverse[0][1] / p[3],
                       -inverse[1][1] / p[3]};
  return all[*(const int *)which];
}

/* The target takes 2 roundings, the distortion 13, a Newton step 6: what it leaves is what rounding
 * makes of the distortion. The derivatives go through the determinant: 17 and 7 more. */
static void cameras(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double distortion[5], reach_px;
  } cases[] = {{"camera without distortion", {0}, 500},
               {"camera of usual distortion", {-0.1, 0.03, 1e-4, -2e-4, 0}, 500},
               {"camera of strong distortion", {-0.25, 0.08, 1e-3, -2e-3, -0.01}, 4000},
               {"camera, 1e-9 px from its axis", {-0.25, 0.08, 1e-3, -2e-3, -0.01}, 1e-9}};
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
    char names[2][64];
    snprintf(names[0], sizeof names[0], "%s: ray", cases[c].name);
    snprintf(names[1], sizeof names[1], "%s: slopes", cases[c].name);
    const struct exact exact[2] = {{names[0], camera, 11, 21, DBL_EPSILON},
                                   {names[1], camera, 11, 45, DBL_EPSILON}};
    struct exact_worst worst[2] = {{0}};
    placido_instrument instrument = {.focal_px = {10800, 10790},
                                     .principal_px = {0, 0},
                                     .position_mm = {0, 0, 120},
                                     .model = PLACIDO_PINHOLE};
    memcpy(instrument.distortion, cases[c].distortion, sizeof cases[c].distortion);
    for (int i = 0; i < 60; i++) {
      double angle = 0.7 * i, reach = cases[c].reach_px * (i + 1) / 60;
      double in[11] = {reach * cos(angle), reach * sin(angle), 10800, 10790, 0, 0};
      memcpy(in + 6, instrument.distortion, sizeof instrument.distortion);
      placido_ray ray = placido_camera_ray(&instrument, in[0], in[1]);
      const double found[6] = {ray.direction[0],   ray.direction[1],   ray.direction_u[0],
                               ray.direction_u[1], ray.direction_v[0], ray.direction_v[1]};
      for (int which = 0; which < 6; which++) {
        exact_compare(&worst[which > 1], &exact[which > 1], in, &numbers[which], found[which]);
      }
    }
    exact_row(&exact[0], &worst[0]);
    exact_row(&exact[1], &worst[1]);
  }
}

enum {
  RAY_Z,
  RAY_DX,
  RAY_DY,
  RAY_UX,
  RAY_UY,
  RAY_VX,
  RAY_VY,
  HIT_X,
  HIT_Y,
  HIT_Z,
  HIT_P,
  HIT_Q,
  HIT_XX,
  HIT_XY,
  HIT_YY,
  EDGE_RADIUS,
  EDGE_Z,
  MIRROR_INPUTS
};

enum { MISS, BY_Z, BY_P, BY_Q, BY_U, BY_V, BY_RADIUS, BY_HEIGHT, MISSES };

/* F, and in x its derivative by what is changed, where the changed ray meets the changed patch
 * z + p x + q y + (xx x² + 2 xy x y + yy y²)/2 about the hit: one step of Newton's from the hit
 * itself, whose derivative is exact. */
static exact_jet miss_jet(const quad *in, int which) {
  const exact_jet none = exact_constant(0), change = {.x = 1};
  const quad *aside = which == BY_U ? in + RAY_UX : in + RAY_VX;
  bool image = which == BY_U || which == BY_V;
  quad far = in[RAY_Z] - in[HIT_Z];
  exact_jet at[3], d[3], radius = exact_constant(in[EDGE_RADIUS]),
                         height = exact_constant(in[EDGE_Z]);
  for (int i = 0; i < 3; i++) {
    quad turn = image && i < 2 ? aside[i] : 0;
    at[i] = exact_sum(exact_constant(in[HIT_X + i]), exact_scaled(change, far * turn));
    d[i] = exact_sum(exact_constant(i < 2 ? in[RAY_DX + i] : -1), exact_scaled(change, turn));
  }
  radius = exact_sum(radius, which == BY_RADIUS ? change : none);
  height = exact_sum(height, which == BY_HEIGHT ? change : none);
  /* over the patch by `over`, it goes on by t = -over / (d_z - p d_x - q d_y) */
  exact_jet over = exact_sum(at[2], exact_constant(-in[HIT_Z]));
  over = exact_sum(over, exact_scaled(exact_sum(at[0], exact_constant(-in[HIT_X])), -in[HIT_P]));
  over = exact_sum(over, exact_scaled(exact_sum(at[1], exact_constant(-in[HIT_Y])), -in[HIT_Q]));
  over = exact_sum(over, exact_scaled(which == BY_Z ? change : none, -1));
  exact_jet t = exact_scaled(over, -1 / (d[2].f - in[HIT_P] * d[0].f - in[HIT_Q] * d[1].f));
  for (int i = 0; i < 3; i++) {
    at[i] = exact_sum(at[i], exact_product(t, d[i]));
  }
  exact_jet ax = exact_sum(at[0], exact_constant(-in[HIT_X]));
  exact_jet ay = exact_sum(at[1], exact_constant(-in[HIT_Y]));
  exact_jet p = exact_sum(exact_constant(in[HIT_P]),
                          exact_sum(exact_scaled(ax, in[HIT_XX]), exact_scaled(ay, in[HIT_XY])));
  exact_jet q = exact_sum(exact_constant(in[HIT_Q]),
                          exact_sum(exact_scaled(ax, in[HIT_XY]), exact_scaled(ay, in[HIT_YY])));
  p = exact_sum(p, which == BY_P ? change : none);
  q = exact_sum(q, which == BY_Q ? change : none);
  /* r = d - 2 (d·n) n / n² with n = (-p, -q, 1) */
  const exact_jet n[3] = {exact_scaled(p, -1), exact_scaled(q, -1), exact_constant(1)};
  exact_jet dn = none, nn = none, r[3];
  for (int i = 0; i < 3; i++) {
    dn = exact_sum(dn, exact_product(d[i], n[i]));
    nn = exact_sum(nn, exact_product(n[i], n[i]));
  }
  exact_jet twice = exact_scaled(exact_product(dn, exact_inverse(nn)), -2);
  for (int i = 0; i < 3; i++) {
    r[i] = exact_sum(d[i], exact_product(twice, n[i]));
  }
  exact_jet rise = exact_sum(height, exact_scaled(at[2], -1)), square = none;
  for (int i = 0; i < 2; i++) {
    exact_jet g = exact_sum(exact_product(at[i], r[2]), exact_product(rise, r[i]));
    square = exact_sum(square, exact_product(g, g));
  }
  return exact_sum(exact_root(square), exact_scaled(exact_product(radius, r[2]), -1));
}

static quad mirror(const quad *in, const void *which) {
  int number = *(const int *)which;
  exact_jet miss = miss_jet(in, number);
  return number == MISS ? miss.f : miss.x;
}

/* A ray that hits a sphere of 7.8 mm with some astigmatism at (x, y). */
static void fill_mirror(double in[MIRROR_INPUTS], double x, double y, double radius_mm,
                        double edge_mm) {
  double w = sqrt(radius_mm * radius_mm - x * x - y * y), far = 120;
  double z = -(x * x + y * y) / (radius_mm + w);
  const double all[MIRROR_INPUTS] = {[RAY_Z] = far,
                                     [RAY_DX] = x / (far - z),
                                     [RAY_DY] = y / (far - z),
                                     [RAY_UX] = 1e-4,
                                     [RAY_UY] = 1e-7,
                                     [RAY_VX] = -2e-7,
                                     [RAY_VY] = -1e-4,
                                     [HIT_X] = x,
                                     [HIT_Y] = y,
                                     [HIT_Z] = z,
                                     [HIT_P] = -x / w,
                                     [HIT_Q] = -y / w,
                                     [HIT_XX] = -1 / w - x * x / (w * w * w) + 0.002,
                                     [HIT_XY] = -x * y / (w * w * w) + 0.001,
                                     [HIT_YY] = -1 / w - y * y / (w * w * w),
                                     [EDGE_RADIUS] = edge_mm,
                                     [EDGE_Z] = 40};
  memcpy(in, all, sizeof all);
}

static placido_miss miss_at(const double in[MIRROR_INPUTS]) {
  const placido_ray ray = {.origin = {0, 0, in[RAY_Z]},
                           .direction = {in[RAY_DX], in[RAY_DY], -1},
                           .direction_u = {in[RAY_UX], in[RAY_UY], 0},
                           .direction_v = {in[RAY_VX], in[RAY_VY], 0}};
  const placido_hit hit = {in[HIT_X], in[HIT_Y],  in[HIT_Z],  in[HIT_P],
                           in[HIT_Q], in[HIT_XX], in[HIT_XY], in[HIT_YY]};
  const placido_edge edge = {in[EDGE_RADIUS], in[EDGE_Z]};
  return placido_mirror_miss(&ray, &hit, &edge);
}

/* To n² 4 roundings, g 5, the ray 2, the point's share 3, the radius 3, the difference 2: 19. By
 * slope 15 more, by height and radius none or 3, along the ray 13 more, in the image 24 more than
 * that. */
static const int mirror_roundings[MISSES] = {19, 47, 34, 34, 71, 71, 14, 22};
static const char *const mirror_names[MISSES] = {
    "miss", "by height", "by slope p",       "by slope q",
    "by u", "by v",      "by edge's radius", "by edge's z"};

static void compare_mirror(const char *name, const double (*points)[2], size_t count,
                           double radius_mm, bool seen) {
  for (int which = 0; which < MISSES; which++) {
    char text[64];
    snprintf(text, sizeof text, "%s: %s", name, mirror_names[which]);
    const struct exact exact = {text, mirror, MIRROR_INPUTS, mirror_roundings[which], DBL_EPSILON};
    struct exact_worst worst = {0};
    for (size_t i = 0; i < count; i++) {
      double in[MIRROR_INPUTS];
      fill_mirror(in, points[i][0], points[i][1], radius_mm, 15);
      placido_miss miss = miss_at(in);
      if (seen) { /* where the edge is that this ray sees, the miss is the difference of equals */
        in[EDGE_RADIUS] += miss.f / -miss.by_radius;
        miss = miss_at(in);
      }
      const double found[MISSES] = {miss.f,    miss.by_z, miss.by_p,      miss.by_q,
                                    miss.by_u, miss.by_v, miss.by_radius, miss.by_height};
      exact_compare(&worst, &exact, in, &numbers[which], found[which]);
    }
    exact_row(&exact, &worst);
  }
}

static void mirrors(void **state) {
  (void)state;
  static const double cornea[][2] = {{0.3, 0.1}, {-1, 2}, {3, -2.5}, {0.7, 4}, {-4.4, -0.01}};
  static const double apex[][2] = {{1e-3, 2e-3}, {-1e-6, 1e-7}, {1e-9, 1e-12}, {0, 1e-10}};
  /* a slope of 45 degrees mirrors a ray along the axis across it */
  static const double across[][2] = {{5.515, 0}, {3.9, -3.9}, {0, 5.6}, {-5.3, 1.2}};
  compare_mirror("mirror", cornea, 5, 7.8, false);
  compare_mirror("mirror of the edge seen", cornea, 5, 7.8, true);
  compare_mirror("mirror near the axis", apex, 4, 7.8, false);
  compare_mirror("mirror across the axis", across, 4, 7.8, false);
}

enum {
  LENS_M,
  LENS_J0,
  LENS_J45,
  PUPIL_X,
  PUPIL_Y,
  INDEX,
  AT_X,
  AT_Y,
  SLOPE_X,
  SLOPE_Y,
  SNELL_INPUTS
};

/* Snell's law: what of the unit ray lies along the surface keeps its length over the index. */
static quad snell(const quad *p, const void *which) {
  quad x = p[AT_X] - p[PUPIL_X], y = p[AT_Y] - p[PUPIL_Y];
  quad d[3] = {-((p[LENS_M] + p[LENS_J0]) * x + p[LENS_J45] * y) / 1000,
               -(p[LENS_J45] * x + (p[LENS_M] - p[LENS_J0]) * y) / 1000, -1};
  quad n[3] = {p[SLOPE_X], p[SLOPE_Y], 1}, along[3], dd = 0, nn = 0, dn = 0, across = 0;
  for (int i = 0; i < 3; i++) {
    dd += d[i] * d[i];
    nn += n[i] * n[i];
    dn += d[i] * n[i];
  }
  for (int i = 0; i < 3; i++) {
    along[i] = (d[i] - dn / nn * n[i]) / (sqrtq(dd) * p[INDEX]);
    across += along[i] * along[i];
  }
  quad inwards = sqrtq(1 - across) / sqrtq(nn);
  int number = *(const int *)which;
  return (along[number] - inwards * n[number]) / -(along[2] - inwards * n[2]);
}

/* The lens 5 roundings, the cosine 9, Snell's root 5, the two parts 4, the slope 5. */
static void compare_snell(const char *name, const double in[SNELL_INPUTS], double slope_least,
                          double slope_most) {
  char names[2][64];
  snprintf(names[0], sizeof names[0], "%s: many rays", name);
  snprintf(names[1], sizeof names[1], "%s: one ray", name);
  const struct exact exact[2] = {{names[0], snell, SNELL_INPUTS, 28, DBL_EPSILON},
                                 {names[1], snell, SNELL_INPUTS, 28, DBL_EPSILON}};
  struct exact_worst worst[2] = {{0}};
  const placido_eye eye = {.pupil_x_mm = in[PUPIL_X],
                           .pupil_y_mm = in[PUPIL_Y],
                           .index = in[INDEX],
                           .correction = {in[LENS_M], in[LENS_J0], in[LENS_J45]}};
  for (int i = 0; i < 40; i++) {
    double slope = slope_least * pow(slope_most / slope_least, i / 39.0), u, v, x, y,
           at[SNELL_INPUTS];
    memcpy(at, in, sizeof at);
    at[SLOPE_X] = slope * cos(0.9 * i);
    at[SLOPE_Y] = slope * sin(0.9 * i);
    at[AT_X] = 7.8 * at[SLOPE_X] / (1 + slope);
    at[AT_Y] = 7.8 * at[SLOPE_Y] / (1 + slope);
    placido_refract(&u, &v, &at[AT_X], &at[AT_Y], &at[SLOPE_X], &at[SLOPE_Y], 1, &eye);
    exact_compare(&worst[0], &exact[0], at, &numbers[0], u);
    exact_compare(&worst[0], &exact[0], at, &numbers[1], v);
    /* from 0 to 1 mm deep it goes as far aside as its slope is */
    const placido_entry entry = {0, 0, 0, at[SLOPE_X], at[SLOPE_Y]};
    placido_eye centred = eye;
    centred.pupil_x_mm = eye.pupil_x_mm - at[AT_X];
    centred.pupil_y_mm = eye.pupil_y_mm - at[AT_Y];
    assert_true(placido_entry_trace(&entry, &centred, 1, &x, &y));
    at[PUPIL_X] = centred.pupil_x_mm;
    at[PUPIL_Y] = centred.pupil_y_mm;
    at[AT_X] = at[AT_Y] = 0;
    exact_compare(&worst[1], &exact[1], at, &numbers[0], x);
    exact_compare(&worst[1], &exact[1], at, &numbers[1], y);
  }
  exact_row(&exact[0], &worst[0]);
  exact_row(&exact[1], &worst[1]);
}

static void refraction(void **state) {
  (void)state;
  compare_snell("Snell", (const double[SNELL_INPUTS]){[INDEX] = 1.3375}, 1e-3, 1.5);
  compare_snell("Snell, tiny slopes", (const double[SNELL_INPUTS]){[INDEX] = 1.3375}, 1e-300, 1e-4);
  compare_snell("Snell, near 80 degrees", (const double[SNELL_INPUTS]){[INDEX] = 1.3375}, 4, 5.67);
  compare_snell("Snell, index near 1", (const double[SNELL_INPUTS]){[INDEX] = 1.01}, 1e-3, 1.5);
  compare_snell("Snell behind a lens",
                (const double[SNELL_INPUTS]){-8, 1.5, -0.7, 0.3, -0.2, 1.376}, 1e-3, 1.5);
}

static void every_error_is_within(void **state) {
  (void)state;
  assert_int_equal(stability_print("arithmetic: rays"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cameras),
      cmocka_unit_test(mirrors),
      cmocka_unit_test(refraction),
      cmocka_unit_test(every_error_is_within),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
