/* The closed trace by a ball: it says what the surface fit's own equation says, and its derivatives
 * are those of finite differences. */
#include "acquire/calibrate/sphere.h"
#include "reconstruct/mirror.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static const placido_edge edge = {14.2, 60.5};

/* Origin, direction, centre, radius, radius and z of the edge: all that the miss depends on. */
#define INPUTS 12
static const double somewhere[INPUTS] = {0.1, -0.2, 119.5, 0.021, -0.012, -1.03,
                                         0.05, 0.08, -7.6, 7.8,   14.2,   60.5};

static placido_sphere_miss miss_of(const double in[INPUTS]) {
  placido_sphere_miss miss;
  const placido_edge e = {in[10], in[11]};
  assert_true(placido_sphere_miss_at(&miss, in, in + 3, in + 6, in[9], &e));
  return miss;
}

static void derivatives_are_those_of_differences(void **state) {
  (void)state;
  placido_sphere_miss m = miss_of(somewhere);
  const double analytic[INPUTS] = {m.by_origin[0],    m.by_origin[1],  m.by_origin[2],
                                   m.by_direction[0], m.by_direction[1], m.by_direction[2],
                                   m.by_centre[0],    m.by_centre[1],  m.by_centre[2],
                                   m.by_radius,       m.by_edge_radius, m.by_edge_z};
  for (int i = 0; i < INPUTS; i++) {
    double lower[INPUTS], upper[INPUTS], step = 1e-5;
    for (int k = 0; k < INPUTS; k++) {
      lower[k] = somewhere[k] - (k == i ? step : 0);
      upper[k] = somewhere[k] + (k == i ? step : 0);
    }
    double numeric = (miss_of(upper).f - miss_of(lower).f) / (2 * step);
    /* central differences err by step² times a third derivative of some thousands */
    assert_true(fabs(numeric - analytic[i]) < 1e-5 * (1 + fabs(numeric)));
  }
}

static void it_is_the_fit_s_own_equation(void **state) {
  (void)state;
  placido_sphere_miss m = miss_of(somewhere);
  const double *o = somewhere, *d = somewhere + 3, *c = somewhere + 6;
  double radius = somewhere[9], low = 100, high = 120;
  for (int i = 0; i < 80; i++) { /* the hit by bisection */
    double t = (low + high) / 2, far = 0;
    for (int k = 0; k < 3; k++) {
      far += pow(o[k] + t * d[k] - c[k], 2);
    }
    *(far > radius * radius ? &low : &high) = t;
  }
  placido_hit hit = {.x = o[0] + low * d[0], .y = o[1] + low * d[1], .z = o[2] + low * d[2]};
  double down = hit.z - c[2];
  hit.p = -(hit.x - c[0]) / down;
  hit.q = -(hit.y - c[1]) / down;
  placido_ray ray = {.origin = {o[0], o[1], o[2]}, .direction = {d[0], d[1], d[2]}};
  /* millimetres; bisection ends at rounding */
  assert_true(fabs(placido_mirror_miss(&ray, &hit, &edge).f - m.f) < 1e-9);
}

static void a_ray_beside_the_ball_is_told(void **state) {
  (void)state;
  placido_sphere_miss miss;
  const double beside[3] = {0.2, 0, -1};
  assert_false(placido_sphere_miss_at(&miss, somewhere, beside, somewhere + 6, 7.8, &edge));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(derivatives_are_those_of_differences),
      cmocka_unit_test(it_is_the_fit_s_own_equation),
      cmocka_unit_test(a_ray_beside_the_ball_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
