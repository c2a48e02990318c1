/* The eye traced for light from any direction, against skew rays of another make (skew.c), and
 * against the cornea on its axis as it was traced before. */
#include "base/memory.h"
#include "eyes.h"
#include "ocular_pupils.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/ocular/navarro.h"
#include "simulate/ocular/ocular.h"
#include "simulate/ocular/sight.h"
#include "simulate/trace.h"
#include "skew.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

static const double axis_deg[2] = {0, 0}, no_offset[2] = {0, 0};
static const double pi = 3.14159265358979323846;
static const double arcmin_rad = 3.14159265358979323846 / 10800;

enum { RAYS = 40 };

/* A sunflower of entries over the pupil. */
static void spread_entries(float x_mm[RAYS], float y_mm[RAYS], double pupil_mm) {
  for (int i = 0; i < RAYS; i++) {
    double radius = pupil_mm / 2 * sqrt((i + 0.5) / RAYS), angle = 2.399963 * i;
    x_mm[i] = (float)(radius * cos(angle));
    y_mm[i] = (float)(radius * sin(angle));
  }
}

/* The point of fixation that placido_psf_new found, as an offset from the chief ray's. */
static void find_offset(double offset[2], double *nodal_mm, const placido_surface *surface,
                        const placido_eye *eye, const placido_psf *psf) {
  placido_apex apex;
  placido_entry chief;
  double x, y;
  assert_int_equal(placido_apex_find(&apex, surface, eye, NULL), PLACIDO_OK);
  assert_true(placido_entry_at(&chief, surface, &apex, eye->pupil_x_mm, eye->pupil_y_mm));
  assert_true(placido_entry_trace(&chief, eye, eye->retina_mm, &x, &y));
  *nodal_mm = placido_apex_nodal_mm(&apex, eye->index, eye->retina_mm);
  offset[0] = (psf->centre_x_um / 1e3 - x) / *nodal_mm / arcmin_rad;
  offset[1] = (psf->centre_y_um / 1e3 - y) / *nodal_mm / arcmin_rad;
}

/* On the axis the cornea alone is what placido_pupil_of_surface has, and diffraction makes the PSF
 * of it that placido_psf_new makes. */
static void test_axis(void **state) {
  (void)state;
  enum { BUCKETS = 65 };
  static double values[BUCKETS * BUCKETS];
  placido_surface *surface = toric(7.9, 7.5, -0.3, 25);
  const placido_eye asked = {.pupil_mm = 4, .pupil_x_mm = 0.2, .pupil_y_mm = -0.1,
                             .correct = PLACIDO_CORRECT_SPHERE, .retina_mm = 29,
                             .correction = {.j0_D = 0.5, .j45_D = -0.3}};
  const placido_optics optics = {.wavelength_nm = 555, .buckets = BUCKETS, .grow = 1};
  const placido_ocular alone = {0};
  const placido_wave wave = {.wavelength_nm = 555, .weight = 1};
  const placido_window window = {.buckets = BUCKETS};
  placido_eye eye;
  placido_psf psf;
  placido_pupil before, now;
  double offset[2], found[2], nodal_mm;
  assert_int_equal(placido_psf_new(&psf, &eye, surface, &asked, &optics, NULL, NULL), PLACIDO_OK);
  find_offset(offset, &nodal_mm, surface, &eye, &psf);
  assert_int_equal(placido_ocular_fixation(found, surface, &eye, &alone, NULL), PLACIDO_OK);
  assert_near(found[0], offset[0], 0.005); /* both climb in float */
  assert_near(found[1], offset[1], 0.005);
  const double focus_mm[3] = {psf.centre_x_um / 1e3, psf.centre_y_um / 1e3, eye.retina_mm};
  assert_int_equal(placido_pupil_of_surface(&before, surface, &eye, focus_mm, 1, NULL), PLACIDO_OK);
  assert_int_equal(placido_ocular_pupil(&now, surface, &eye, &alone, axis_deg, offset, 0,
                                        before.n - 6, 1, NULL), PLACIDO_OK);
  double scale = eye.index * nodal_mm / eye.retina_mm;
  assert_int_equal(now.n, before.n);
  assert_near(now.pupil_mm / before.pupil_mm, scale, 1e-9);
  for (int i = 0; i < now.n * now.n; i++) {
    if (lit(&now, i % now.n, i / now.n)) {
      assert_near(now.opd_um[i], before.opd_um[i], 1e-5); /* of 2 um; the lattice's parabolas */
      assert_near(now.amplitude[i] * scale, before.amplitude[i], 5e-4);
    }
  }
  assert_int_equal(placido_diffraction(values, NULL, &now, &wave, 1, &window, NULL), PLACIDO_OK);
  for (int i = 0; i < BUCKETS * BUCKETS; i++) {
    assert_near(values[i], psf.values[i], 1e-6); /* the most is 0.014 */
  }
  placido_pupil_free(&before);
  placido_pupil_free(&now);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

/* A conicoid with Q = -1/n² has no aberration on the axis (Descartes). */
static void test_perfect(void **state) {
  (void)state;
  const double index = 1.3375, radius_mm = 7.8;
  placido_surface *surface = conic(radius_mm, -1 / (index * index));
  const placido_ocular alone = {0};
  for (double pupil_mm = 0.5; pupil_mm <= 8; pupil_mm *= 4) {
    placido_eye eye = {.pupil_mm = pupil_mm, .retina_mm = index * radius_mm / (index - 1)};
    placido_pupil pupil = pupil_of(surface, &eye, &alone, axis_deg, 0, 1);
    for (int i = 0; i < pupil.n * pupil.n; i++) {
      if (lit(&pupil, i % pupil.n, i / pupil.n)) {
        assert_near(pupil.opd_um[i], 0, 1e-6); /* digits of 30 mm, and the lattice's parabolas */
      }
    }
    placido_pupil_free(&pupil);
  }
  placido_surface_free(surface);
}

/* The paper's figures: 60.4 D, in focus 24.0 mm behind the cornea; indices at the lines. */
static void test_navarro(void **state) {
  (void)state;
  placido_navarro at_line = placido_navarro_at(0, 656.3), usual = placido_navarro_at(0, 589.3);
  const double index[4] = {usual.surfaces[0].before, usual.surfaces[0].behind,
                           usual.surfaces[1].behind, usual.surfaces[2].behind};
  assert_near(at_line.surfaces[0].before, 1.37405, 2e-5);
  assert_near(at_line.surfaces[0].behind, 1.3354, 2e-5);
  assert_near(at_line.surfaces[1].behind, 1.4175, 2e-5);
  assert_near(at_line.surfaces[2].behind, 1.3341, 2e-5);
  for (int i = 0; i < 4; i++) {
    assert_near(index[i], skew_paper_index[i], 1e-4);
  }
  double focus_mm;
  skew_eye paper = skew_navarro(7.72, -0.26, 0, skew_paper_index, 24);
  assert_near(skew_power_D(&paper, &focus_mm), 60.4, 0.05);
  assert_near(focus_mm, 24, 0.01);
  for (double accommodation_D = 0; accommodation_D <= 8; accommodation_D += 4) {
    placido_navarro eye = placido_navarro_at(accommodation_D, 589.3);
    double lens = eye.surfaces[1].behind;
    skew_eye other = skew_navarro(7.72, -0.26, accommodation_D,
                                  (double[]){index[0], index[1], lens, index[3]}, 24);
    skew_power_D(&other, &focus_mm);
    double vergence_D = 1000 * (index[0] - 1) / 7.72;
    assert_near(placido_navarro_focus_mm(&eye, vergence_D), focus_mm, 1e-5);
    double near_mm = placido_navarro_focus_mm(&eye, vergence_D - accommodation_D);
    assert_near(near_mm, 24, 0.2); /* half a dioptre: the paper's laws are fits */
  }
}

/* Angles of the whole eye: landing points of skew rays, by how the chief ray's follow. On the
 * curved retina both are looked at along its tangents at the chief ray. */
static void test_landing(void **state) {
  (void)state;
  placido_surface *surface = conic(7.72, -0.26);
  const placido_eye eye = {.pupil_mm = 5, .retina_mm = 23.7};
  const double fields_deg[3][2] = {{0, 0}, {8, -5}, {-14, 3}};
  float x_mm[RAYS], y_mm[RAYS], u[RAYS], v[RAYS];
  spread_entries(x_mm, y_mm, eye.pupil_mm);
  for (int f = 0; f < 6; f++) {
    const double *field_deg = fields_deg[f / 2];
    const double tangent[2] = {tan(field_deg[0] * pi / 180), tan(field_deg[1] * pi / 180)};
    const placido_ocular ocular = {.whole = true, .curved = f % 2};
    placido_navarro media = placido_navarro_at(0, 555);
    const double index[4] = {media.surfaces[0].before, media.surfaces[0].behind,
                             media.surfaces[1].behind, media.surfaces[2].behind};
    skew_eye other = skew_navarro(7.72, -0.26, 0, index, eye.retina_mm);
    other.retina_radius_mm = ocular.curved ? 12 : 0;
    double j[2][2], chief[3], direction[3], path, landing[3];
    const double middle[2] = {0, 0};
    skew_follow(&other, tangent, j);
    assert_true(skew_land(&other, tangent, middle, chief, direction, &path));
    placido_ocular_angles(u, v, x_mm, y_mm, RAYS, surface, &eye, &ocular, field_deg, no_offset);
    for (int i = 0; i < RAYS; i++) {
      const double entry[2] = {(double)x_mm[i], (double)y_mm[i]};
      assert_true(skew_land(&other, tangent, entry, landing, direction, &path));
      double x = j[0][0] * (double)u[i] + j[0][1] * (double)v[i];
      double y = j[1][0] * (double)u[i] + j[1][1] * (double)v[i];
      double away_mm = hypot(x, y) * arcmin_rad;
      double bulge_mm = ocular.curved ? away_mm * away_mm / 24 : 0;
      double allowed_mm = 2e-6 + bulge_mm; /* 0.0004' */
      assert_near(x * arcmin_rad, landing[0] - chief[0], allowed_mm);
      assert_near(y * arcmin_rad, landing[1] - chief[1], allowed_mm);
    }
  }
  placido_surface_free(surface);
}

/* Malus and Dupin: the slope of the path difference is where the ray is seen. The slope is taken
 * from the samples, the ray from skew.c; where it stands is asked of the sight. */
static void check_slopes(const placido_surface *surface, const placido_eye *eye,
                         const placido_ocular *ocular, const double field_deg[2]) {
  float x_mm[RAYS], y_mm[RAYS], u[RAYS], v[RAYS];
  double block[PLACIDO_BEAM_COLUMNS * RAYS];
  placido_beam beam = placido_beam_of(block, RAYS);
  placido_eye settled;
  placido_sight sight;
  spread_entries(x_mm, y_mm, 0.95 * eye->pupil_mm);
  placido_pupil pupil = pupil_of(surface, eye, ocular, field_deg, 0, 1);
  placido_ocular_angles(u, v, x_mm, y_mm, RAYS, surface, eye, ocular, field_deg, no_offset);
  assert_int_equal(placido_eye_settle(&settled, eye, NULL), PLACIDO_OK);
  assert_int_equal(placido_sight_new(&sight, surface, &settled, ocular, field_deg, no_offset, 0,
                                     NULL), PLACIDO_OK);
  for (size_t i = 0; i < RAYS; i++) {
    placido_sight_aim(&sight, &beam, i, (double)x_mm[i], (double)y_mm[i]);
  }
  placido_sight_depart(&sight, &beam);
  double most = 0;
  for (size_t i = 0; i < RAYS; i++) {
    placido_standing at = placido_sight_stand(&sight, &beam, i);
    double x = at.place[0] / pupil.spacing_mm + 0.5 * (pupil.n - 1);
    double y = at.place[1] / pupil.spacing_mm + 0.5 * (pupil.n - 1);
    int column = (int)lround(x), row = (int)lround(y);
    const double *w = pupil.opd_um + row * pupil.n + column;
    double per = 1e3 * pupil.spacing_mm * arcmin_rad; /* um a sample and minute */
    double xx = w[1] - 2 * w[0] + w[-1], yy = w[pupil.n] - 2 * w[0] + w[-pupil.n];
    double xy = (w[pupil.n + 1] - w[pupil.n - 1] - w[-pupil.n + 1] + w[-pupil.n - 1]) / 4;
    double across = (w[1] - w[-1]) / 2 + (x - column) * xx + (y - row) * xy;
    double along = (w[pupil.n] - w[-pupil.n]) / 2 + (y - row) * yy + (x - column) * xy;
    /* a path reckoned to the focus by way of the cornea is exact to the square of the ray's
     * distance over 24 mm: 0.5 % of 20'; the samples' third differences are below 0.01' */
    double allowed = 0.01 + 0.008 * hypot((double)u[i], (double)v[i]);
    assert_near(-across / per, (double)u[i], allowed);
    assert_near(-along / per, (double)v[i], allowed);
    most = fmax(most, hypot((double)u[i], (double)v[i]));
  }
  assert_true(most > 1);
  placido_pupil_free(&pupil);
}

static void test_slopes(void **state) {
  (void)state;
  placido_surface *surfaces[] = {conic(7.72, -0.26), toric(7.9, 7.6, -0.2, 30), keratoconus(0)};
  const double fields_deg[2][2] = {{0, 0}, {6, -9}};
  for (int i = 0; i < 3 * 8; i++) {
    const placido_ocular ocular = {.whole = i % 2, .curved = i / 2 % 2, .accommodation_D = i % 3};
    const placido_eye eye = {.pupil_mm = 4, .retina_mm = ocular.whole ? 23.8 : 30.3,
                             .correction = {.m_D = -1, .j0_D = 0.4}};
    check_slopes(surfaces[i / 8], &eye, &ocular, fields_deg[i / 4 % 2]);
  }
  for (int i = 0; i < 3; i++) {
    placido_surface_free(surfaces[i]);
  }
}

/* Whatever allocation fails, nothing is left behind. */
static void test_memory(void **state) {
  (void)state;
  placido_surface *surface = toric(7.9, 7.6, -0.2, 30);
  const placido_eye eye = {.pupil_mm = 3, .retina_mm = 30.3};
  int status = PLACIDO_MEMORY, failures = 0;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_ocular whole = {.whole = true};
    placido_pupil pupil = {0};
    placido_eye found;
    double offset[2];
    placido_memory_fail_at(n);
    status = placido_ocular_focus(&found, &whole, surface, &eye, PLACIDO_CORRECT_FULL, NULL);
    if (status == PLACIDO_OK) {
      status = placido_ocular_fixation(offset, surface, &found, &whole, NULL);
    }
    if (status == PLACIDO_OK) {
      status = placido_ocular_pupil(&pupil, surface, &found, &whole, axis_deg, offset, 0, 32, 1,
                                    NULL);
    }
    placido_memory_fail_at(0);
    failures += status == PLACIDO_MEMORY;
    assert_true((status == PLACIDO_OK) == (pupil.opd_um != NULL));
    placido_pupil_free(&pupil);
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(failures > 8);
  placido_surface_free(surface);
}

/* Rays that are lost are NaN; a pupil that loses too many is refused; the number of threads and a
 * lack of memory change nothing else. */
static void test_lost(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.2); /* to 4.5 mm */
  const placido_ocular whole = {.whole = true};
  placido_eye eye = {.pupil_mm = 8, .pupil_x_mm = 0.6, .retina_mm = 23.9};
  placido_pupil pupil = pupil_of(surface, &eye, &whole, axis_deg, 0, 1), again;
  int lost = 0, inside = 0;
  for (int i = 0; i < pupil.n * pupil.n; i++) {
    bool in = lit(&pupil, i % pupil.n, i / pupil.n);
    inside += in;
    lost += in && isnan(pupil.opd_um[i]);
  }
  assert_true(lost > 0 && lost < 0.05 * inside);
  again = pupil_of(surface, &eye, &whole, axis_deg, 0, 3);
  assert_memory_equal(pupil.opd_um, again.opd_um, (size_t)(pupil.n * pupil.n) * sizeof(double));
  assert_memory_equal(pupil.amplitude, again.amplitude,
                      (size_t)(pupil.n * pupil.n) * sizeof(double));
  placido_pupil_free(&again);
  placido_pupil_free(&pupil);
  eye.pupil_x_mm = 1.2;
  placido_error err = {0};
  assert_int_equal(placido_ocular_pupil(&pupil, surface, &eye, &whole, axis_deg, no_offset, 0, 0, 1,
                                        &err), PLACIDO_QUALITY);
  assert_null(pupil.opd_um);
  assert_non_null(strstr(err.text, "does not reach"));
  const double beside_deg[2] = {60, 0};
  float x = 0, y = 0, u = 0, v = 0;
  placido_ocular_angles(&u, &v, &x, &y, 1, surface, &eye, &whole, beside_deg, no_offset);
  assert_true(isnan(u) && isnan(v));
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_axis),   cmocka_unit_test(test_perfect), cmocka_unit_test(test_navarro),
    cmocka_unit_test(test_landing), cmocka_unit_test(test_slopes), cmocka_unit_test(test_memory),
    cmocka_unit_test(test_lost),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
