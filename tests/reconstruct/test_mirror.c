/* The one equation of the reconstruction: its derivatives against differences, and a ray whose
 * course is known. */
#include "reconstruct/mirror.h"
#include "tests/support/near.h"

/* z = -(x²/15.6 + y²/15 + xy/100), bent by g (1 + 0.3 x - 0.2 y) */
static placido_hit meet(const placido_ray *ray, double g) {
  placido_hit hit = {0};
  double t = ray->origin[2];
  for (int step = 0; step < 200; step++) {
    double x = hit.x = ray->origin[0] + t * ray->direction[0];
    double y = hit.y = ray->origin[1] + t * ray->direction[1];
    hit.z = -(x * x / 15.6 + y * y / 15 + x * y / 100) + g * (1 + 0.3 * x - 0.2 * y);
    t = ray->origin[2] - hit.z;
  }
  hit.p = -(2 * hit.x / 15.6 + hit.y / 100) + 0.3 * g;
  hit.q = -(2 * hit.y / 15 + hit.x / 100) - 0.2 * g;
  hit.xx = -2 / 15.6;
  hit.xy = -0.01;
  hit.yy = -2 / 15.0;
  return hit;
}

static placido_instrument camera(enum placido_camera_model model) {
  double focal = model == PLACIDO_PINHOLE ? 10800 : 90;
  return (placido_instrument){.model = model,
                              .focal_px = {focal, 1.01 * focal},
                              .principal_px = {600, 500},
                              .distortion = {0.1, -0.02, 0.01, -0.02, 0.005},
                              .position_mm = {0.2, -0.1, 120}};
}

static double miss_of(const placido_instrument *in, const placido_edge *edge, double u, double v,
                      double g, placido_miss *miss, placido_hit *hit) {
  placido_ray ray = placido_camera_ray(in, u, v);
  *hit = meet(&ray, g);
  *miss = placido_mirror_miss(&ray, hit, edge);
  return miss->f;
}

/* Central differences over 1e-3 px and 1e-6 mm are good to seven digits of these smooth
 * functions. */
static void check_derivatives(enum placido_camera_model model) {
  placido_instrument in = camera(model);
  /* small distortion coefficients where the normalised coordinates are millimetres */
  for (int i = 0; i < 5 && model == PLACIDO_TELECENTRIC; i++) {
    in.distortion[i] *= 1e-3;
  }
  placido_edge edge = {.radius_mm = 30, .z_mm = 60};
  placido_miss m, side;
  placido_hit hit, other;
  double u = 760, v = 390, e = 1e-3, g = 1e-6;
  miss_of(&in, &edge, u, v, 0, &m, &hit);
  double by_u = miss_of(&in, &edge, u + e, v, 0, &side, &other) -
                miss_of(&in, &edge, u - e, v, 0, &side, &other);
  double by_v = miss_of(&in, &edge, u, v + e, 0, &side, &other) -
                miss_of(&in, &edge, u, v - e, 0, &side, &other);
  double by_g = miss_of(&in, &edge, u, v, g, &side, &other) -
                miss_of(&in, &edge, u, v, -g, &side, &other);
  assert_near(m.by_u, by_u / (2 * e), 1e-6 * fabs(m.by_u));
  assert_near(m.by_v, by_v / (2 * e), 1e-6 * fabs(m.by_v));
  double expected = m.by_z * (1 + 0.3 * hit.x - 0.2 * hit.y) + 0.3 * m.by_p - 0.2 * m.by_q;
  assert_near(expected, by_g / (2 * g), 1e-6 * fabs(expected));
}

static void derivatives_agree_with_differences(void **state) {
  (void)state;
  check_derivatives(PLACIDO_PINHOLE);
  check_derivatives(PLACIDO_TELECENTRIC);
}

/* A plane mirror at z = 0 tilted by atan(1/2) about y sends the ray straight down at x = 0 off at
 * twice that angle: it rises by 3 for every 4 across. */
static void a_plane_mirror_sends_the_ray_where_it_must(void **state) {
  (void)state;
  placido_ray ray = {.origin = {0, 0, 100}, .direction = {0, 0, -1}};
  placido_hit hit = {.p = -0.5};
  placido_edge edge = {.radius_mm = 40, .z_mm = 30};
  assert_near(placido_mirror_miss(&ray, &hit, &edge).f, 0, 1e-12);
  edge.radius_mm = 39;
  assert_true(placido_mirror_miss(&ray, &hit, &edge).f > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(derivatives_agree_with_differences),
      cmocka_unit_test(a_plane_mirror_sends_the_ray_where_it_must),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
