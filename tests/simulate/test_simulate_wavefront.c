/* The wavefront against what is known exactly: perfect ellipsoids, published corneas, Snell's law. */
#include "simulate/trace.h"
#include "simulate/wavefront.h"
#include "tests/simulate/eyes.h"
#include "tests/support/named_figure.h"

#include <placido/wavefront.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static placido_wavefront wavefront_of(const placido_surface *surface, const placido_eye *eye,
                                      const placido_wavefront_options *options) {
  placido_wavefront w;
  placido_error err = {0};
  if (placido_wavefront_new(&w, surface, eye, options, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return w;
}

static double paraxial_mm(double radius_mm, double index) {
  return index * radius_mm / (index - 1);
}

/* Every product of two terms integrates to 1 where they are one and to 0 where they are not. */
static void terms_are_orthonormal(void **state) {
  (void)state;
  enum { RINGS = 8, RAYS = 3 * RINGS * RINGS, TERMS = 66 };
  static double x[RAYS], y[RAYS], weight[RAYS], terms[TERMS * RAYS];
  placido_disc_quadrature(x, y, weight, RINGS);
  placido_zernike_terms(terms, 10, x, y, RAYS);
  for (int j = 0; j < TERMS; j++) {
    for (int k = 0; k <= j; k++) {
      double sum = 0;
      for (int i = 0; i < RAYS; i++) {
        sum += weight[i] * terms[j * RAYS + i] * terms[k * RAYS + i];
      }
      assert_true(fabs(sum - (j == k)) < 1e-12); /* rounding */
    }
  }
}

static void indices_are_osa(void **state) {
  (void)state;
  const int known[][3] = {{0, 0, 0}, {1, -1, 1}, {1, 1, 2}, {2, -2, 3}, {2, 0, 4}, {2, 2, 5},
                          {3, -1, 7}, {3, 1, 8}, {4, 0, 12}, {6, 0, 24}, {10, 10, 65}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    int n, m;
    assert_int_equal(placido_zernike_index(known[i][0], known[i][1]), known[i][2]);
    placido_zernike_name(known[i][2], &n, &m);
    assert_int_equal(n, known[i][0]);
    assert_int_equal(m, known[i][1]);
  }
}

/* Conics of Q = -1/n² bring light from the axis to a point: no path differs from another. */
static void the_perfect_ellipsoid_has_no_aberration(void **state) {
  (void)state;
  const double indices[] = {4.0 / 3, 1.3375, 1.336, 1.376};
  for (size_t i = 0; i < 4; i++) {
    placido_surface *surface = conic(7.8, -1 / (indices[i] * indices[i]));
    const placido_eye eye = {.pupil_mm = 8, .index = indices[i]};
    placido_wavefront w = wavefront_of(surface, &eye, NULL);
    assert_true(fabs(w.focus_mm[2] - paraxial_mm(7.8, indices[i])) < 1e-8);
    assert_true(w.rms_um < 1e-9); /* rounding of a path of 40 mm */
    placido_wavefront_free(&w);
    placido_surface_free(surface);
  }
}

/* Spherical aberration about the paraxial focus, micrometres: from the path integral by an
 * independent quadrature (60 nodes). The last is the model cornea that Tecnis lenses are designed
 * for, published as about 0.27. */
static void spherical_aberration_of_conics(void **state) {
  (void)state;
  static const struct {
    double radius_mm, q, index, pupil_mm, z40_um, tolerance_um;
  } known[] = {
      {7.8, 0, 1.376, 6, 0.363, 5e-4},         {7.8, -0.26, 1.376, 6, 0.179, 5e-4},
      {7.8, -0.26, 1.3375, 6, 0.179, 5e-4},    {7.8, -0.5, 1.376, 6, 0.018, 5e-4},
      {7.8, -0.26, 1.376, 4, 0.033, 5e-4},     {7.8, -0.26, 1.376, 8, 0.616, 2e-3},
      {7.575, -0.14135, 1.3375, 6, 0.278, 5e-4}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    placido_surface *surface = conic(known[i].radius_mm, known[i].q);
    const placido_eye eye = {.pupil_mm = known[i].pupil_mm,
                             .index = known[i].index,
                             .retina_mm = paraxial_mm(known[i].radius_mm, known[i].index)};
    placido_wavefront w = wavefront_of(surface, &eye, NULL);
    assert_true(fabs(w.coefficients_um[12] - known[i].z40_um) < known[i].tolerance_um);
    assert_true(fabs(named_figure(&w, "spherical_um") - w.coefficients_um[12]) == 0);
    placido_wavefront_free(&w);
    placido_surface_free(surface);
  }
}

/* About the best focus, where no defocus is left: values of a quadrature written apart from this
 * one (Gauss-Legendre of 40 nodes in the squared radius, Gauss-Newton on the focus). */
static void the_best_focus_is_where_the_spread_is_least(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, 0);
  const placido_eye eye = {.pupil_mm = 6, .index = 1.376};
  placido_wavefront best = wavefront_of(surface, &eye, NULL);
  assert_true(fabs(best.focus_mm[2] - 27.9689962) < 1e-6);
  assert_true(fabs(best.coefficients_um[12] - 0.35116241) < 1e-7);
  assert_true(fabs(best.coefficients_um[4] + 0.00317748) < 1e-7);
  assert_true(fabs(best.coefficients_um[24] - 0.00852038) < 1e-7);
  assert_true(fabs(best.focus_mm[0]) < 1e-9 && fabs(best.focus_mm[1]) < 1e-9);
  for (int side = -1; side <= 1; side += 2) {
    placido_eye moved = eye;
    moved.retina_mm = best.focus_mm[2] + side * 0.01;
    placido_wavefront other = wavefront_of(surface, &moved, NULL);
    assert_true(other.rms_um > best.rms_um);
    placido_wavefront_free(&other);
  }
  placido_wavefront_free(&best);
  placido_surface_free(surface);
}

/* A retina beyond the focus of a perfect cornea: short sight, by the difference of vergences. */
static void defocus_is_refraction(void **state) {
  (void)state;
  const double n = 1.336, focus = paraxial_mm(7.8, n);
  placido_surface *surface = conic(7.8, -1 / (n * n));
  const placido_eye eye = {.pupil_mm = 3, .index = n, .retina_mm = focus + 0.5};
  placido_wavefront w = wavefront_of(surface, &eye, NULL);
  double expected_D = 1000 * n / (focus + 0.5) - 1000 * n / focus;
  assert_true(fabs(named_figure(&w, "m_D") - expected_D) < 0.01); /* c40's share, of the depth of the dome */
  assert_true(fabs(named_figure(&w, "m_centre_D") - expected_D) < 1e-4);
  assert_true(fabs(named_figure(&w, "power_D") - 1000 * n / focus) < 0.01);
  placido_wavefront_free(&w);
  placido_surface_free(surface);
}

/* A toric cornea: its cylinder is the difference of its powers, minus axis on the flat meridian's
 * own direction; and a lens of that power before it takes it away. */
static void a_toric_cornea_has_its_cylinder(void **state) {
  (void)state;
  const double n = 1.3375, power_D[2] = {1000 * (n - 1) / 7.9, 1000 * (n - 1) / 7.6};
  placido_surface *surface = toric(7.9, 7.6, -0.5, 20); /* flat along 20 degrees */
  placido_eye eye = {.pupil_mm = 3, .index = n};
  placido_wavefront w = wavefront_of(surface, &eye, NULL);
  /* the cylinder of a 3 mm pupil is within 1 % of the apex's */
  assert_true(fabs(named_figure(&w, "cylinder_D") - (power_D[0] - power_D[1])) < 0.02);
  assert_true(fabs(named_figure(&w, "axis_deg") - 20) < 0.01);
  eye.correction = (placido_correction){0, named_figure(&w, "j0_D"), named_figure(&w, "j45_D")};
  placido_wavefront worn = wavefront_of(surface, &eye, NULL);
  assert_true(fabs(named_figure(&worn, "cylinder_D")) < 0.002);
  placido_wavefront_free(&worn);
  placido_wavefront_free(&w);
  placido_surface_free(surface);
}

/* Path differences at the quadrature's own rays, by name. */
static double path_at(const placido_surface *surface, const placido_wavefront *w, double x_mm,
                      double y_mm) {
  placido_jet here, axis;
  assert_true(placido_surface_at(surface, x_mm, y_mm, &here));
  assert_true(placido_surface_at(surface, 0, 0, &axis));
  double depth = here.sag - axis.sag;
  double dx = x_mm - w->focus_mm[0], dy = y_mm - w->focus_mm[1], dz = depth - w->focus_mm[2];
  return depth + w->eye.index * sqrt(dx * dx + dy * dy + dz * dz);
}

/* The slope of the path over the surface is n (F - P)/|F - P| . P' less n t . P', t the ray that
 * Snell's law gives (Fermat): the wavefront and the exact trace say the same of a keratoconus. */
static void its_slope_is_the_rays_error(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(30);
  const placido_eye eye = {.pupil_mm = 6, .pupil_x_mm = 0.3, .pupil_y_mm = -0.2, .index = 1.376};
  placido_wavefront w = wavefront_of(surface, &eye, NULL);
  const placido_apex apex = {.axis_sag_mm = 0};
  placido_jet axis;
  assert_true(placido_surface_at(surface, 0, 0, &axis));
  placido_apex from_axis = apex;
  from_axis.axis_sag_mm = axis.sag;
  for (size_t i = 0; i < w.count; i += 7) {
    const double h = 1e-4;
    double x = w.x_mm[i], y = w.y_mm[i], slope_um[2], landed[2];
    slope_um[0] = (path_at(surface, &w, x + h, y) - path_at(surface, &w, x - h, y)) / (2 * h);
    slope_um[1] = (path_at(surface, &w, x, y + h) - path_at(surface, &w, x, y - h)) / (2 * h);
    placido_entry entry;
    assert_true(placido_entry_at(&entry, surface, &from_axis, x, y));
    assert_true(placido_entry_trace(&entry, &w.eye, w.focus_mm[2], &landed[0], &landed[1]));
    double down = w.focus_mm[2] - entry.depth_mm;
    double ray[3] = {landed[0] - x, landed[1] - y, down};
    double aim[3] = {w.focus_mm[0] - x, w.focus_mm[1] - y, down};
    double ray_length = sqrt(ray[0] * ray[0] + ray[1] * ray[1] + down * down);
    double aim_length = sqrt(aim[0] * aim[0] + aim[1] * aim[1] + down * down);
    const double along[2] = {entry.sx, entry.sy};
    for (int k = 0; k < 2; k++) {
      double bend = (ray[k] / ray_length - aim[k] / aim_length) +
                    along[k] * (ray[2] / ray_length - aim[2] / aim_length);
      /* central differences over 0.2 um of h²: 1e-8 of slope */
      assert_true(fabs(slope_um[k] - w.eye.index * bend) < 1e-7);
    }
  }
  placido_wavefront_free(&w);
  placido_surface_free(surface);
}

/* Terms, focus and all turn with the eye. */
static void a_turned_eye_has_a_turned_wavefront(void **state) {
  (void)state;
  const double turn_deg = 40, rad = turn_deg * 3.14159265358979323846 / 180;
  placido_surface *one = keratoconus(0), *other = keratoconus(turn_deg);
  const placido_eye eye = {.pupil_mm = 5};
  placido_wavefront a = wavefront_of(one, &eye, NULL), b = wavefront_of(other, &eye, NULL);
  for (int j = 0; j < a.term_count; j++) {
    int n, m;
    placido_zernike_name(j, &n, &m);
    int k = placido_zernike_index(n, -m);
    double sign = m < 0 ? 1 : -1, angle = abs(m) * rad;
    double expected = a.coefficients_um[j] * cos(angle) + sign * a.coefficients_um[k] * sin(angle);
    assert_true(fabs(b.coefficients_um[j] - expected) < 1e-6); /* 768 rays of a smooth cone */
  }
  double turned = placido_wavefront_difference(
      &(placido_wavefront_figure){.period = 360}, named_figure(&b, "coma_axis_deg"),
      named_figure(&a, "coma_axis_deg"));
  assert_true(fabs(turned - turn_deg) < 1e-3);
  placido_wavefront_free(&a);
  placido_wavefront_free(&b);
  placido_surface_free(one);
  placido_surface_free(other);
}

/* More rays change nothing that matters: the quadrature is as accurate as the terms need. */
static void more_rays_change_nothing(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = {.pupil_mm = 6};
  const placido_wavefront_options dense = {.rays = 30000};
  placido_wavefront few = wavefront_of(surface, &eye, NULL);
  placido_wavefront many = wavefront_of(surface, &eye, &dense);
  for (int j = 0; j < few.term_count; j++) {
    assert_true(fabs(few.coefficients_um[j] - many.coefficients_um[j]) < 1e-5);
  }
  double square = few.rest_um * few.rest_um;
  for (int j = 1; j < few.term_count; j++) {
    square += few.coefficients_um[j] * few.coefficients_um[j];
  }
  assert_true(fabs(sqrt(square) - few.rms_um) < 1e-6); /* Parseval, with what the terms leave */
  placido_wavefront_free(&few);
  placido_wavefront_free(&many);
  placido_surface_free(surface);
}

/* A cornea with 1 um more of a term of sag: the wavefront has (n - 1) of it, to the obliquity of
 * its rays (2 % at 3 mm). */
static void sag_becomes_path(void **state) {
  (void)state;
  placido_surface *plain = conic(7.8, -0.3), *changed = NULL;
  placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, -0.3, 7.8, -0.3, 0, 0, 0}},
      {.kind = PLACIDO_PART_ZERNIKE, .as.zernike = {.radius_mm = 2}}};
  parts[1].as.zernike.coefficients_um[9] = 1;
  assert_int_equal(placido_surface_new(&changed, 0, 4.5, parts, 2, NULL, NULL), PLACIDO_OK);
  const placido_eye eye = {.pupil_mm = 4, .index = 1.376};
  placido_wavefront w = wavefront_of(plain, &eye, NULL);
  double moved[PLACIDO_WAVEFRONT_TERMS];
  assert_int_equal(placido_wavefront_again(moved, &w, changed, NULL), PLACIDO_OK);
  assert_true(fabs(moved[9] - w.coefficients_um[9] - 0.376) < 0.02 * 0.376);
  assert_int_equal(placido_wavefront_again(moved, &w, plain, NULL), PLACIDO_OK);
  assert_memory_equal(moved, w.coefficients_um, sizeof moved);
  placido_wavefront_free(&w);
  placido_surface_free(plain);
  placido_surface_free(changed);
}

/* Data on the left half only, up to x = limit. */
static placido_surface *half_covered(double limit_mm) {
  enum { SIDE = 181 };
  static unsigned char mask[SIDE * SIDE];
  const placido_coverage coverage = {-4.5, -4.5, 0.05, SIDE, SIDE, mask};
  for (int i = 0; i < SIDE * SIDE; i++) {
    mask[i] = -4.5 + 0.05 * (i % SIDE) <= limit_mm;
  }
  const placido_part part = {.kind = PLACIDO_PART_BICONIC,
                             .as.biconic = {7.8, -0.2, 7.8, -0.2, 0, 0, 0}};
  placido_surface *surface = NULL;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, &part, 1, &coverage, NULL), PLACIDO_OK);
  return surface;
}

static void what_is_missing_is_told_or_refused(void **state) {
  (void)state;
  const placido_eye eye = {.pupil_mm = 6};
  placido_notes notes = {0};
  placido_wavefront w;
  placido_surface *most = half_covered(2.3), *half = half_covered(0);
  assert_int_equal(placido_wavefront_new(&w, most, &eye, NULL, &notes, NULL), PLACIDO_OK);
  /* a segment of the disc beyond 2.3 of 3 mm: (acos h - h sqrt(1 - h²)) / pi of it, h = 2.325 / 3 */
  const double h = 2.325 / 3;
  assert_true(fabs(w.missing - (acos(h) - h * sqrt(1 - h * h)) / 3.14159265358979) < 0.01);
  assert_int_equal(notes.count, 1);
  placido_wavefront_free(&w);
  placido_error err = {0};
  assert_int_equal(placido_wavefront_new(&w, half, &eye, NULL, NULL, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "no data support"));
  assert_null(w.opd_um);
  placido_notes_clear(&notes);
  placido_surface_free(most);
  placido_surface_free(half);
}

static void nonsense_is_refused(void **state) {
  (void)state;
  placido_wavefront w;
  placido_error err = {0};
  placido_surface *surface = conic(7.8, 0), *plane = flat();
  const placido_eye wide = {.pupil_mm = 6, .pupil_x_mm = 2}, plain = {.pupil_mm = 3};
  const placido_wavefront_options order = {.order = 16}, rays = {.rays = 10},
                                  missing = {.missing_max = 1.5};
  assert_int_equal(placido_wavefront_new(&w, surface, &wide, NULL, NULL, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "4.50 mm"));
  assert_int_equal(placido_wavefront_new(&w, plane, &plain, NULL, NULL, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "no focus"));
  assert_int_equal(placido_wavefront_new(&w, surface, &plain, &order, NULL, &err), PLACIDO_INPUT);
  assert_int_equal(placido_wavefront_new(&w, surface, &plain, &rays, NULL, &err), PLACIDO_INPUT);
  assert_int_equal(placido_wavefront_new(&w, surface, &plain, &missing, NULL, &err),
                   PLACIDO_INPUT);
  assert_int_equal(placido_wavefront_new(&w, surface, &(placido_eye){0}, NULL, NULL, &err),
                   PLACIDO_INPUT);
  placido_surface_free(surface);
  placido_surface_free(plane);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(terms_are_orthonormal),
      cmocka_unit_test(indices_are_osa),
      cmocka_unit_test(the_perfect_ellipsoid_has_no_aberration),
      cmocka_unit_test(spherical_aberration_of_conics),
      cmocka_unit_test(the_best_focus_is_where_the_spread_is_least),
      cmocka_unit_test(defocus_is_refraction),
      cmocka_unit_test(a_toric_cornea_has_its_cylinder),
      cmocka_unit_test(its_slope_is_the_rays_error),
      cmocka_unit_test(a_turned_eye_has_a_turned_wavefront),
      cmocka_unit_test(more_rays_change_nothing),
      cmocka_unit_test(sag_becomes_path),
      cmocka_unit_test(what_is_missing_is_told_or_refused),
      cmocka_unit_test(nonsense_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
