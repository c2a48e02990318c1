/* Patterns of rays, the bundle behind the cornea, and what becomes of rays that do not arrive. */
#include "eyes.h"
#include "simulate/rays/bundle.h"
#include "simulate/rays/pattern.h"
#include "simulate/rays/refract.h"
#include "simulate/trace.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

#define RUN_MAX 1024

static const enum placido_pattern_kind patterns[] = {
  PLACIDO_PATTERN_CROSSHATCH, PLACIDO_PATTERN_EQUAL_AREA, PLACIDO_PATTERN_QUASI_RANDOM};

static placido_bundle bundle_of(const placido_surface *surface, const placido_eye *eye,
                                enum placido_pattern_kind pattern, long rays, int threads) {
  placido_apex apex;
  placido_bundle bundle;
  assert_int_equal(placido_apex_find(&apex, surface, eye, NULL), PLACIDO_OK);
  assert_int_equal(
    placido_bundle_new(&bundle, surface, &apex, eye, pattern, rays, threads, NULL), PLACIDO_OK);
  return bundle;
}

/* Weighted means over a pattern: of 1, x, y, x², y², r⁴. */
static void find_means(const placido_pattern *pattern, double means[6]) {
  double x[RUN_MAX], y[RUN_MAX], weight[RUN_MAX];
  memset(means, 0, 6 * sizeof *means);
  assert_true(pattern->run_max <= RUN_MAX);
  for (long run = 0; run < pattern->runs; run++) {
    int count = placido_pattern_run(pattern, run, x, y, weight);
    assert_int_equal(count, placido_pattern_count(pattern, run));
    for (int i = 0; i < count; i++) {
      double rx = x[i] - pattern->x_mm, ry = y[i] - pattern->y_mm, square = rx * rx + ry * ry;
      const double powers[6] = {1, rx, ry, rx * rx, ry * ry, square * square};
      assert_true(sqrt(square) <= pattern->radius_mm && weight[i] > 0);
      for (int k = 0; k < 6; k++) {
        means[k] += weight[i] * powers[k];
      }
    }
  }
}

/* Over a disc of radius R: R²/4 for x² and y², R⁴/3 for r⁴. Numbers of rays that are prime, and not a
 * crosshatch's own. */
static void test_patterns_have_the_means_of_a_disc(void **state) {
  (void)state;
  const long numbers[] = {997, 7919, 19801, 104729};
  for (int kind = 0; kind < 3; kind++) {
    for (int i = 0; i < 4; i++) {
      placido_eye eye = {.pupil_mm = 5, .pupil_x_mm = 0.7, .pupil_y_mm = -0.4};
      placido_pattern pattern = placido_pattern_of(&eye, patterns[kind], numbers[i]);
      double means[6], error = 12 / (double)numbers[i]; /* of the order of 1 / rays */
      find_means(&pattern, means);
      assert_near(means[0], 1, 1e-9);
      assert_near(means[1], 0, error);
      assert_near(means[2], 0, error);
      assert_near(means[3], 2.5 * 2.5 / 4, 2 * error);
      assert_near(means[4], 2.5 * 2.5 / 4, 2 * error);
      assert_near(means[5], pow(2.5, 4) / 3, 30 * error);
    }
  }
}

static void test_any_number_of_rays_has_a_pattern(void **state) {
  (void)state;
  placido_eye eye = {.pupil_mm = 4};
  for (int kind = 0; kind < 3; kind++) {
    for (long rays = 1; rays < 60; rays++) {
      placido_pattern pattern = placido_pattern_of(&eye, patterns[kind], rays);
      double means[6];
      find_means(&pattern, means);
      assert_near(means[0], 1, 1e-12);
      assert_true(pattern.total >= rays);
      assert_true(patterns[kind] == PLACIDO_PATTERN_CROSSHATCH || pattern.total == rays);
    }
  }
  assert_int_equal(placido_crosshatch_samples(19801), 100);
  assert_int_equal(placido_crosshatch_samples(19802), 101);
}

/* What one ray after the other gives. */
static void test_bundle_is_what_single_rays_are(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(20);
  placido_eye eye = {.pupil_mm = 5, .pupil_x_mm = 0.3, .index = 1.3375, .correction = {-2, 1, 0.5}};
  placido_apex apex;
  assert_int_equal(placido_apex_find(&apex, surface, &eye, NULL), PLACIDO_OK);
  for (int kind = 0; kind < 3; kind++) {
    placido_bundle bundle;
    double sum = 0;
    bundle = bundle_of(surface, &eye, patterns[kind], 3001, 2);
    assert_int_equal((long)bundle.count, bundle.asked);
    for (size_t i = 0; i < bundle.count; i++) {
      placido_entry entry;
      double x, y, reach = 30 - bundle.depth_mm[i];
      assert_true(placido_entry_at(&entry, surface, &apex, bundle.x_mm[i], bundle.y_mm[i]));
      assert_true(placido_entry_trace(&entry, &eye, 30, &x, &y));
      assert_near(bundle.depth_mm[i], entry.depth_mm, 1e-13);
      assert_near(bundle.x_mm[i] + reach * bundle.u[i], x, 1e-12);
      assert_near(bundle.y_mm[i] + reach * bundle.v[i], y, 1e-12);
      sum += bundle.weight[i];
    }
    assert_near(sum, 1, 1e-9);
    placido_bundle_free(&bundle);
  }
  placido_surface_free(surface);
}

/* Malus and Dupin: refracted rays stand on the wavefront. The path to a point grows across that
 * point by n times the sine of the angle between ray and line to it, which is nothing for the ray
 * that meets it. */
static void test_paths_have_no_slope_along_the_rays(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  placido_eye eye = {.pupil_mm = 5, .index = 1.3375, .correction = {-1, 0.7, 0.2}};
  placido_apex apex;
  assert_int_equal(placido_apex_find(&apex, surface, &eye, NULL), PLACIDO_OK);
  const double step_mm = 1e-4;
  for (double x = -2; x <= 2; x += 0.8) {
    placido_entry entry, right, left;
    double focus[3] = {0, 0, 30};
    assert_true(placido_entry_at(&entry, surface, &apex, x, 0.6));
    assert_true(placido_entry_at(&right, surface, &apex, x + step_mm, 0.6));
    assert_true(placido_entry_at(&left, surface, &apex, x - step_mm, 0.6));
    assert_true(placido_entry_trace(&entry, &eye, focus[2], &focus[0], &focus[1]));
    double rise = placido_path_mm(&eye, right.x_mm, right.y_mm, right.depth_mm, focus) -
                  placido_path_mm(&eye, left.x_mm, left.y_mm, left.depth_mm, focus);
    /* A thin lens on a curved cornea keeps Prentice's rule, not a path: its slope times the depth
     * where it stands, 3 D × 0.4 mm × the cornea's slope of 0.3, is left over. */
    assert_near(rise / (2 * step_mm), 0, 1e-3);
    eye.correction = (placido_correction){0};
    assert_true(placido_entry_trace(&entry, &eye, focus[2], &focus[0], &focus[1]));
    rise = placido_path_mm(&eye, right.x_mm, right.y_mm, right.depth_mm, focus) -
           placido_path_mm(&eye, left.x_mm, left.y_mm, left.depth_mm, focus);
    assert_near(rise / (2 * step_mm), 0, 1e-8); /* of differences over 1e-4 mm */
    eye.correction = (placido_correction){-1, 0.7, 0.2};
  }
  placido_surface_free(surface);
}

/* The perfect ellipsoid's paths to its focus are alike. */
static void test_perfect_ellipsoid_has_one_path_to_its_focus(void **state) {
  (void)state;
  const double n = 1.3375, focus[3] = {0, 0, n / (n - 1) * 7.8};
  placido_surface *surface = conic(7.8, -1 / (n * n));
  placido_eye eye = {.pupil_mm = 8, .index = n};
  placido_bundle bundle;
  double opd[1000];
  bundle = bundle_of(surface, &eye, PLACIDO_PATTERN_EQUAL_AREA, 1000, 1);
  placido_bundle_opd(opd, &bundle, &eye, focus, 1000 * placido_path_mm(&eye, 0, 0, 0, focus));
  for (size_t i = 0; i < bundle.count; i++) {
    assert_near(opd[i], 0, 1e-9); /* micrometres: rounding of 41 mm */
  }
  placido_bundle_free(&bundle);
  placido_surface_free(surface);
}

/* A conicoid of R 7.8 mm, Q -0.2, n 1.3375, pupil 8 mm, on its paraxial plane: the spot for
 * infinitely many rays (Gauss-Legendre of 200 nodes; the inverse of the monotone ray height). */
static void test_weights_make_the_continuous_spot_of_a_conicoid(void **state) {
  (void)state;
  static const struct {
    double radius_mm, light;
  } circles[] = {{0.025, 0.254401794484}, {0.05, 0.39891444507}, {0.1, 0.621027649871}};
  const double retina_mm = 1.3375 / 0.3375 * 7.8;
  placido_surface *surface = conic(7.8, -0.2);
  placido_eye eye = {.pupil_mm = 8, .index = 1.3375};
  for (int kind = 0; kind < 3; kind++) {
    placido_bundle bundle;
    double square = 0, within[3] = {0};
    bundle = bundle_of(surface, &eye, patterns[kind], 319201, 1);
    for (size_t i = 0; i < bundle.count; i++) {
      double reach = retina_mm - bundle.depth_mm[i];
      double x = bundle.x_mm[i] + reach * bundle.u[i], y = bundle.y_mm[i] + reach * bundle.v[i];
      square += bundle.weight[i] * x * x;
      for (int k = 0; k < 3; k++) {
        within[k] += hypot(x, y) < circles[k].radius_mm ? bundle.weight[i] : 0;
      }
    }
    /* The rim's rays stand in the middles of their cells, by which they lie 0.01 mm too far out. */
    assert_near(1000 * sqrt(square), 74.088635395, 0.02);
    for (int k = 0; k < 3; k++) {
      assert_near(within[k], circles[k].light, 2e-4); /* a circle crosses about 1,000 cells */
    }
    placido_bundle_free(&bundle);
  }
  placido_surface_free(surface);
}

/* Whatever happens to a ray, it is in one of the numbers. */
static void test_every_ray_is_counted(void **state) {
  (void)state;
  placido_surface *surface = conic(4.2, 0); /* to 4.5 mm: steeper than 80 degrees from 4.136 mm */
  const double radius_mm = 4.2;
  placido_eye eye = {.pupil_mm = 9.6, .index = 1.3375};
  placido_bundle bundle;
  for (int kind = 0; kind < 3; kind++) {
    bundle = bundle_of(surface, &eye, patterns[kind], 200003, 1);
    double all = (double)bundle.asked, sum = bundle.lost;
    assert_int_equal((long)bundle.count + bundle.missed + bundle.grazed + bundle.reflected,
                     bundle.asked);
    for (size_t i = 0; i < bundle.count; i++) {
      sum += bundle.weight[i];
    }
    assert_near(sum, 1, 1e-9);
    double steep = radius_mm * sin(80 * acos(-1) / 180), pupil = 4.8 * 4.8;
    /* shares of the disc; 0.2 % is a rim of 200,003 rays */
    assert_near((double)bundle.missed / all, 1 - radius_mm * radius_mm / pupil, 0.002);
    double grazing = (radius_mm * radius_mm - steep * steep) / pupil;
    assert_near((double)bundle.grazed / all, grazing, 0.002);
    assert_int_equal(bundle.reflected, 0);
    placido_bundle_free(&bundle);
  }
  /* Into air from an index of 1 / 0.75 light is totally reflected from asin 0.75 on. */
  eye = (placido_eye){.pupil_mm = 8, .index = 0.75};
  bundle = bundle_of(surface, &eye, PLACIDO_PATTERN_CROSSHATCH, 200003, 1);
  double through = 0.75 * radius_mm / 4;
  assert_near((double)bundle.count / (double)bundle.asked, through * through, 0.002);
  assert_int_equal(bundle.reflected, bundle.asked - (long)bundle.count);
  placido_bundle_free(&bundle);
  placido_surface_free(surface);
}

static void test_bundle_does_not_depend_on_threads(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  placido_eye eye = {.pupil_mm = 9.1, .index = 1.3375}; /* some miss */
  placido_bundle one, three;
  one = bundle_of(surface, &eye, PLACIDO_PATTERN_CROSSHATCH, 10007, 1);
  three = bundle_of(surface, &eye, PLACIDO_PATTERN_CROSSHATCH, 10007, 3);
  assert_true(one.count == three.count && one.missed == three.missed && one.missed > 0);
  assert_memory_equal(one.u, three.u, one.count * sizeof *one.u);
  assert_memory_equal(one.weight, three.weight, one.count * sizeof *one.weight);
  assert_true(one.lost == three.lost);
  placido_bundle_free(&one);
  placido_bundle_free(&three);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_patterns_have_the_means_of_a_disc),
    cmocka_unit_test(test_any_number_of_rays_has_a_pattern),
    cmocka_unit_test(test_bundle_is_what_single_rays_are),
    cmocka_unit_test(test_paths_have_no_slope_along_the_rays),
    cmocka_unit_test(test_perfect_ellipsoid_has_one_path_to_its_focus),
    cmocka_unit_test(test_weights_make_the_continuous_spot_of_a_conicoid),
    cmocka_unit_test(test_every_ray_is_counted),
    cmocka_unit_test(test_bundle_does_not_depend_on_threads),
  };
  return cmocka_run_group_tests_name("simulate_rays", tests, NULL, NULL);
}
