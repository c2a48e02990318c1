/* How far corneas and images differ, against what is known in closed form. */
#include "acquire/cli/accuracy/differ.h"
#include "tests/support/near.h"

#include <string.h>

#define SIDE 65
#define MIDDLE (SIDE / 2)

static const double pi = 3.14159265358979323846;

static placido_surface *make_surface(double vertex_z_mm, double radius_mm, double defocus_um) {
  placido_part parts[2] = {{.kind = PLACIDO_PART_BICONIC}, {.kind = PLACIDO_PART_ZERNIKE}};
  placido_surface *surface;
  parts[0].as.biconic.r1 = parts[0].as.biconic.r2 = radius_mm;
  parts[1].as.zernike.radius_mm = 3;
  parts[1].as.zernike.coefficients_um[4] = defocus_um;
  assert_int_equal(placido_surface_new(&surface, vertex_z_mm, 5, parts, 2, NULL, NULL), 0);
  return surface;
}

static void test_surfaces(void **state) {
  (void)state;
  double elevation_um, axial_D;
  placido_surface *sphere = make_surface(0, 7.8, 0), *moved = make_surface(0.3, 7.8, 0),
                  *flatter = make_surface(0, 7.9, 0), *bent = make_surface(0, 7.8, 1);
  /* The height as a whole does not count; a sag of 0.6 mm is rounded to 1e-16 mm. */
  accuracy_differ_surfaces(&elevation_um, &axial_D, sphere, moved);
  assert_near(elevation_um, 0, 1e-9);
  assert_near(axial_D, 0, 1e-9);
  /* A sphere has its one power everywhere. */
  accuracy_differ_surfaces(NULL, &axial_D, sphere, flatter);
  assert_near(axial_D, 337.5 * (1 / 7.8 - 1 / 7.9), 1e-9);
  /* Over its disc a Zernike term of 1 um has an rms of 1 um; the rim of a grid of 0.1 mm steps is
   * wrong by up to half a step, 3 % of the area, where the term is sqrt(3): half of that at most,
   * as what is too much here is too little there. */
  accuracy_differ_surfaces(&elevation_um, NULL, sphere, bent);
  assert_near(elevation_um, 1, 0.05);
  placido_surface_free(sphere);
  placido_surface_free(moved);
  placido_surface_free(flatter);
  placido_surface_free(bent);
}

/* Light in these columns of the middle row. */
static placido_psf make_psf(double values[SIDE * SIDE], int first, int second) {
  memset(values, 0, SIDE * SIDE * sizeof *values);
  values[MIDDLE * SIDE + first] += 0.5;
  values[MIDDLE * SIDE + second] += 0.5;
  return (placido_psf){.n = SIDE, .bucket_arcmin = 0.125, .values = values};
}

static void test_psfs(void **state) {
  (void)state;
  static double a[SIDE * SIDE], b[SIDE * SIDE];
  double otf;
  const placido_psf point = make_psf(a, MIDDLE, MIDDLE);
  placido_psf other = make_psf(b, MIDDLE, MIDDLE);
  assert_int_equal(accuracy_differ_psfs(&otf, &point, &other, NULL), 0);
  assert_near(otf, 0, 1e-7);
  /* A shift is not seen. The transfer function is interpolated, with echoes of 1e-4. */
  other = make_psf(b, MIDDLE + 1, MIDDLE + 1);
  assert_int_equal(accuracy_differ_psfs(&otf, &point, &other, NULL), 0);
  assert_near(otf, 0, 1e-3);
  /* Two points 1' apart: cos(pi f / 60), which is -1 at 60 cycles a degree, where an eighth of a
   * cycle fits into a bucket, whose width is given back. */
  const double bucket = sin(pi / 8) / (pi / 8);
  other = make_psf(b, MIDDLE - 4, MIDDLE + 4);
  assert_int_equal(accuracy_differ_psfs(&otf, &point, &other, NULL), 0);
  assert_near(otf, 2 / bucket, 2e-3);
  memset(b, 0, sizeof b);
  assert_int_equal(accuracy_differ_psfs(&otf, &point, &other, NULL), PLACIDO_QUALITY);
  assert_true(isnan(otf));
}

static void test_images(void **state) {
  (void)state;
  float a[6] = {0, 1, 0.5f, 0, 0, 0}, b[6] = {0, 0.75f, 0.5f, 0, 0.125f, 0};
  const placido_image one = {.width_px = 3, .height_px = 2, .planes = 1, .data = a};
  placido_image other = {.width_px = 3, .height_px = 2, .planes = 1, .data = b};
  assert_near(accuracy_differ_images(&one, &other), 0.25, 0);
  other.width_px = 2;
  assert_true(isnan(accuracy_differ_images(&one, &other)));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_surfaces), cmocka_unit_test(test_psfs), cmocka_unit_test(test_images)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
