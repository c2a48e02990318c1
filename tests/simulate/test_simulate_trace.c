/* Rays: the pattern's numbers, exact refraction against values traced elsewhere, the scale. */
#include "eyes.h"
#include "simulate/eye.h"
#include "simulate/trace.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static placido_apex apex_of(const placido_surface *surface, const placido_eye *eye) {
  placido_apex apex;
  assert_int_equal(placido_apex_find(&apex, surface, eye, NULL), PLACIDO_OK);
  return apex;
}

/* The seed's pattern over an 8 mm pupil: 19,801 rays, of which 15,373 pass (counted independently
 * on a floating-point grid). */
static void test_crosshatch_of_100_has_15373_rays_in_the_pupil(void **state) {
  (void)state;
  placido_eye eye = {.pupil_mm = 8, .index = 1.3375};
  placido_crosshatch pattern = placido_crosshatch_of(&eye, 100);
  long inside = 0;
  for (int row = 0; row < pattern.rows; row++) {
    double x, y;
    int count;
    placido_crosshatch_row(&pattern, row, &x, &count, &y);
    inside += count;
    if (count > 0) {
      double last = x + 2 * (count - 1) * pattern.half_cell_mm;
      assert_true(hypot(x, y) < 4 && hypot(last + 2 * pattern.half_cell_mm, y) >= 4 - 1e-12);
      assert_near(x, -last, 1e-12);
    }
  }
  assert_int_equal(placido_crosshatch_total(&pattern), 19801);
  assert_int_equal(inside, 15373);
}

/* Where a ray x mm from the axis crosses it again, n 1.3375 (30-digit plane trigonometry). */
static void test_rays_cross_the_axis_where_plane_trigonometry_says(void **state) {
  (void)state;
  static const struct {
    double q, x_mm, crossing_mm;
  } rows[] = {
    {0, 1, 30.7686278866}, {0, 2, 30.3352854893}, {0, 4, 28.5014032839},
    {-0.2, 1, 30.8196815498}, {-0.2, 2, 30.5425632371}, {-0.2, 4, 29.387202447},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    placido_surface *surface = conic(7.8, rows[i].q);
    placido_eye eye = {.pupil_mm = 8, .index = 1.3375};
    placido_apex apex = apex_of(surface, &eye);
    placido_entry entry;
    double x, y;
    assert_true(placido_entry_at(&entry, surface, &apex, rows[i].x_mm * 0.6, rows[i].x_mm * 0.8));
    assert_true(placido_entry_trace(&entry, &eye, rows[i].crossing_mm, &x, &y));
    assert_near(x, 0, 1e-10);
    assert_near(y, 0, 1e-10);
    placido_surface_free(surface);
  }
}

/* Spot of a conicoid on its paraxial plane: reference computed with another program on the same
 * 15,373 rays. */
static void test_conicoid_spot_has_the_reference_size(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.2);
  placido_eye eye = {.pupil_mm = 8, .index = 1.3375};
  placido_apex apex = apex_of(surface, &eye);
  placido_rays rays;
  double square = 0;
  int within[3] = {0};
  assert_int_equal(placido_rays_new(&rays, surface, &apex, &eye, 100, NULL), PLACIDO_OK);
  assert_int_equal(rays.count, 15373);
  for (size_t i = 0; i < rays.count; i++) {
    double x, y;
    assert_true(placido_entry_trace(&rays.entries[i], &eye, 1.3375 / 0.3375 * 7.8, &x, &y));
    square += x * x;
    for (int k = 0; k < 3; k++) {
      within[k] += hypot(x, y) < 0.025 * (1 << k);
    }
  }
  assert_near(1000 * sqrt(square / (double)rays.count), 73.91654542914566, 1e-7);
  /* Encircled energy for infinitely many rays; a circle's rim crosses about a hundred of 15,373. */
  assert_near(within[0] / 15373.0, 0.254401794484, 0.003);
  assert_near(within[1] / 15373.0, 0.39891444507, 0.003);
  assert_near(within[2] / 15373.0, 0.621027649871, 0.003);
  placido_rays_free(&rays);
  placido_surface_free(surface);
}

/* A perfect eye of 60 D (5.55 mm, n 4/3) whose retina stands D × f × f' before the focus: the blur
 * disc's angle at the nodal distance f = 16.65 mm, traced exactly by another program. */
static void test_defocused_perfect_eye_has_the_reference_blur_disc(void **state) {
  (void)state;
  static const struct {
    double dioptres, pupil_mm, disc_arcmin;
  } rows[] = {
    {0.25, 2, 1.725902338675992}, {1, 4, 13.981255510262987}, {4, 4, 55.92502204105268},
    {0.5, 8, 14.771852370269878}, {2, 8, 59.087409481079284},
  };
  const double n = 4.0 / 3, front_mm = 16.65, back_mm = 22.2;
  placido_surface *surface = conic(5.55, -1 / (n * n));
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    placido_eye eye = {.pupil_mm = rows[i].pupil_mm, .index = n};
    placido_apex apex = apex_of(surface, &eye);
    placido_entry entry;
    double x, y, retina_mm = back_mm - rows[i].dioptres * front_mm * back_mm / 1000;
    assert_near(placido_apex_nodal_mm(&apex, n, back_mm), front_mm, 1e-12);
    assert_true(placido_entry_at(&entry, surface, &apex, rows[i].pupil_mm / 2, 0));
    assert_true(placido_entry_trace(&entry, &eye, retina_mm, &x, &y));
    assert_near(2 * x / front_mm / PLACIDO_ARCMIN_RAD, rows[i].disc_arcmin, 1e-8);
  }
  placido_surface_free(surface);
}

/* The same blur from a lens on the cornea, to first order: pupil × power. Small pupil, because the
 * lens acts at the ray's height and the cornea's depth behind its apex is neglected by the rule. */
static void test_lens_blurs_by_pupil_times_power(void **state) {
  (void)state;
  const double n = 1.3375, retina_mm = n / (n - 1) * 7.8;
  placido_surface *surface = conic(7.8, -1 / (n * n));
  placido_eye eye = {.pupil_mm = 0.5, .index = n, .correction = {1, 0.5, 0}};
  placido_apex apex = apex_of(surface, &eye);
  double nodal_mm = placido_apex_nodal_mm(&apex, n, retina_mm), x, y;
  placido_entry entry;
  assert_true(placido_entry_at(&entry, surface, &apex, 0.25, 0.25));
  assert_true(placido_entry_trace(&entry, &eye, retina_mm, &x, &y));
  assert_near(x / nodal_mm, -0.25 * 1.5 / 1000, 1e-6); /* M + J0 along x, converging */
  assert_near(y / nodal_mm, -0.25 * 0.5 / 1000, 1e-6); /* M - J0 along y */
  placido_surface_free(surface);
}

static void test_scale_is_the_nodal_distance(void **state) {
  (void)state;
  double n = 1.3375, focus_mm = n / (n - 1) * 7.8;
  placido_surface *surface = conic(7.8, -0.26);
  placido_eye eye = {.pupil_mm = 4, .index = n};
  placido_apex apex = apex_of(surface, &eye);
  placido_optics optics = {.bucket_arcmin = 0.5};
  double bucket_um = placido_apex_bucket_um(&apex, &optics, n, focus_mm);
  assert_near(placido_apex_nodal_mm(&apex, n, focus_mm), 23.1111111111, 1e-9);
  assert_near(2.5 / bucket_um * 0.5, 0.371871645878, 1e-9); /* reference: small angle */
  optics.cwhatuc = true;
  assert_true(placido_apex_bucket_um(&apex, &optics, n, focus_mm) == 2.5);
  placido_surface_free(surface);
  surface = flat();
  apex = apex_of(surface, &eye);
  assert_near(placido_apex_nodal_mm(&apex, n, 30), 30 / n, 1e-12);
  placido_surface_free(surface);
}

static void test_ray_from_behind_cannot_enter(void **state) {
  (void)state;
  placido_eye eye = {.pupil_mm = 4, .index = 1.3375};
  placido_entry steep = {.x_mm = 1, .sx = 3};
  double x, y;
  assert_true(placido_entry_trace(&steep, &eye, 30, &x, &y));
  eye.correction.m_D = -400e3; /* a slope of 400: more than the surface's normal allows */
  assert_false(placido_entry_trace(&steep, &eye, 30, &x, &y));
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_crosshatch_of_100_has_15373_rays_in_the_pupil),
    cmocka_unit_test(test_rays_cross_the_axis_where_plane_trigonometry_says),
    cmocka_unit_test(test_conicoid_spot_has_the_reference_size),
    cmocka_unit_test(test_defocused_perfect_eye_has_the_reference_blur_disc),
    cmocka_unit_test(test_lens_blurs_by_pupil_times_power),
    cmocka_unit_test(test_scale_is_the_nodal_distance),
    cmocka_unit_test(test_ray_from_behind_cannot_enter),
  };
  return cmocka_run_group_tests_name("simulate_trace", tests, NULL, NULL);
}
