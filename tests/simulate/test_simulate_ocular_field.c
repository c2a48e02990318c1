/* Light from the side: Coddington's equations, the place where it passes the cornea, and how much of
 * it there is. */
#include "eyes.h"
#include "ocular_pupils.h"
#include "simulate/ocular/ocular.h"
#include "skew.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static const double no_offset[2] = {0, 0};
static const double pi = 3.14159265358979323846;
static const double arcmin_rad = 3.14159265358979323846 / 10800;

/* Coddington's equations: the foci of a thin pencil through a sphere, across and along the plane
 * in which it is inclined. Wherever the retina is, rays are seen apart by how far they are from
 * them. */
static void test_coddington(void **state) {
  (void)state;
  const double radius_mm = 7.8, index = 1.3375, h = 0.2, retina_mm = 29.5;
  placido_surface *surface = conic(radius_mm, 0);
  const placido_eye eye = {.pupil_mm = 1, .retina_mm = retina_mm};
  const placido_ocular alone = {0};
  for (double deg = 5; deg <= 20; deg += 5) {
    double field = deg * pi / 180, t = tan(field);
    /* the chief ray meets the sphere at the depth z, x = (3.05 - z) t */
    double a = 1 + t * t, b = -2 * 3.05 * t * t - 2 * radius_mm, c = 3.05 * 3.05 * t * t;
    double z = (-b - sqrt(b * b - 4 * a * c)) / (2 * a), x = (3.05 - z) * t;
    double normal = asin(x / radius_mm); /* leans outwards by this */
    double i = field - normal, r = asin(sin(i) / index);
    double power = index * cos(r) - cos(i);
    double across_mm = index * cos(r) * cos(r) * radius_mm / power;
    double along_mm = index * radius_mm / power;
    double inside = r + normal, way_mm = (retina_mm - z) / cos(inside);
    /* a beam of width h in the entrance pupil, on the retina */
    double wide = h * cos(field) * cos(r) / cos(i);
    double seen_x = wide * (1 - way_mm / across_mm) / cos(inside);
    double seen_y = h * (1 - way_mm / along_mm);
    skew_eye other = skew_cornea(radius_mm, 0, index, retina_mm);
    double j[2][2], middle[2][2];
    const double tangent[2] = {t, 0}, axis[2] = {0, 0}, field_deg[2] = {deg, 0};
    skew_follow(&other, tangent, j);
    skew_follow(&other, axis, middle);
    double nodal_mm = retina_mm - radius_mm;
    float ex[4] = {(float)h, (float)-h, 0, 0}, ey[4] = {0, 0, (float)h, (float)-h}, u[4], v[4];
    placido_ocular_angles(u, v, ex, ey, 4, surface, &eye, &alone, field_deg, no_offset);
    double got_x = (double)(u[0] - u[1]) / 2 * arcmin_rad * nodal_mm * j[0][0] / middle[0][0];
    double got_y = (double)(v[2] - v[3]) / 2 * arcmin_rad * nodal_mm * j[1][1] / middle[1][1];
    /* the pencil is not thin: its spherical aberration is 0.5 (h / R)² of h, 0.07 um */
    assert_near(got_x, seen_x, 5e-5);
    assert_near(got_y, seen_y, 5e-5);
    assert_true(fabs(seen_x - seen_y) > 2e-4); /* there is something to see */
  }
  placido_surface_free(surface);
}

/* Light from +x passes the cornea at +x: a bump there is met from that side only. */
static void test_footprint(void **state) {
  (void)state;
  placido_part parts[2] = {{.kind = PLACIDO_PART_BICONIC}, {.kind = PLACIDO_PART_BUMP}};
  parts[0].as.biconic.r1 = parts[0].as.biconic.r2 = 7.8;
  parts[1].as.bump.height_mm = 0.01;
  parts[1].as.bump.sigma_x_mm = parts[1].as.bump.sigma_y_mm = 0.2;
  parts[1].as.bump.x_mm = 3.05 * tan(20 * pi / 180);
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, parts, 2, NULL, NULL), PLACIDO_OK);
  const placido_eye eye = {.pupil_mm = 0.6, .retina_mm = 31};
  const placido_ocular alone = {0};
  double spread[2];
  for (int side = 0; side < 2; side++) {
    const double field_deg[2] = {side == 0 ? 20 : -20, 0};
    placido_pupil pupil = pupil_of(surface, &eye, &alone, field_deg, 0, 1);
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < pupil.n * pupil.n; i++) {
      if (lit(&pupil, i % pupil.n, i / pupil.n)) {
        least = fmin(least, pupil.opd_um[i]);
        most = fmax(most, pupil.opd_um[i]);
      }
    }
    spread[side] = most - least;
    placido_pupil_free(&pupil);
  }
  /* 10 um of sag times 0.34, less at the rim of the pupil: exp(-0.3² / 2 / 0.2²) of it is left */
  assert_true(spread[0] > 1.5 && spread[1] < 0.3 * spread[0]);
  placido_surface_free(surface);
}

/* The rim of a wide field is an ellipse: the light that the samples stand for is its area, and as
 * much comes through a round pupil whatever its direction but for the cosine. */
static void test_light(void **state) {
  (void)state;
  placido_surface *surface = conic(7.72, -0.26);
  const placido_eye eye = {.pupil_mm = 4, .retina_mm = 23.86};
  const placido_ocular whole = {.whole = true, .curved = true};
  for (double deg = 0; deg <= 20; deg += 10) {
    const double field_deg[2] = {0, deg};
    placido_pupil pupil = pupil_of(surface, &eye, &whole, field_deg, 0, 1);
    double light = 0;
    for (int i = 0; i < pupil.n * pupil.n; i++) {
      if (lit(&pupil, i % pupil.n, i / pupil.n)) {
        light += pupil.amplitude[i] * pupil.amplitude[i];
      }
    }
    double area = light * pupil.spacing_mm * pupil.spacing_mm;
    assert_near(area / (pi * 4), 1, 0.005); /* samples of a hundredth of the pupil, a hard rim */
    placido_pupil_free(&pupil);
  }
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_coddington),
    cmocka_unit_test(test_footprint),
    cmocka_unit_test(test_light),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
