/* The focus of the whole eye, its spherical aberration, and its dispersion. */
#include "eyes.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/light.h"
#include "simulate/ocular/navarro.h"
#include "simulate/ocular/ocular.h"
#include "skew.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

enum { RAYS = 4000 };

static const double axis_deg[2] = {0, 0}, no_offset[2] = {0, 0};
static const double arcmin_rad = 3.14159265358979323846 / 10800;
static const placido_ocular alone = {0}, whole = {.whole = true};

static placido_eye focus(const placido_surface *surface, const placido_eye *eye,
                         enum placido_correct open, const placido_ocular *ocular) {
  placido_eye found;
  placido_ocular behind = *ocular;
  placido_error err = {0};
  if (placido_ocular_focus(&found, &behind, surface, eye, open, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return found;
}

/* Share of the light about its peak, by other rays than those of the search: a sunflower. */
static double gather(const placido_surface *surface, const placido_eye *eye,
                     const placido_ocular *ocular) {
  static float x[RAYS], y[RAYS], u[RAYS], v[RAYS];
  for (int i = 0; i < RAYS; i++) {
    double radius = eye->pupil_mm / 2 * sqrt((i + 0.5) / RAYS), angle = 2.399963229728653 * i;
    x[i] = (float)(radius * cos(angle));
    y[i] = (float)(radius * sin(angle));
  }
  placido_ocular_angles(u, v, x, y, RAYS, surface, eye, ocular, axis_deg, no_offset);
  double peak[2];
  return placido_light_peak(u, v, RAYS, PLACIDO_FOCUS_WIDTH_ARCMIN, peak) / RAYS;
}

/* Light near the axis is as much out of focus as it was: a thin pencil is as wide. */
static void test_retina(void **state) {
  (void)state;
  placido_surface *surface = conic(7.6, -0.3);
  const float x = 0.1F, y = 0;
  for (double m_D = -4; m_D <= 4; m_D += 4) {
    for (double retina_mm = 28.5; retina_mm < 33; retina_mm += 1.6) {
      const placido_eye eye = {.pupil_mm = 0.5, .index = PLACIDO_EYE_INDEX, .retina_mm = retina_mm,
                               .correction = {.m_D = m_D}};
      const placido_ocular near = {.whole = true, .accommodation_D = 3};
      placido_eye found = focus(surface, &eye, PLACIDO_CORRECT_NONE, &whole);
      placido_eye closer = focus(surface, &eye, PLACIDO_CORRECT_NONE, &near);
      placido_apex apex;
      float wide, before, close, none;
      assert_int_equal(placido_apex_find(&apex, surface, &eye, NULL), PLACIDO_OK);
      placido_ocular_angles(&before, &none, &x, &y, 1, surface, &eye, &alone, axis_deg, no_offset);
      placido_ocular_angles(&wide, &none, &x, &y, 1, surface, &found, &whole, axis_deg, no_offset);
      placido_ocular_angles(&close, &none, &x, &y, 1, surface, &closer, &near, axis_deg, no_offset);
      double nodal_mm = placido_apex_nodal_mm(&apex, eye.index, retina_mm);
      double vergence_D = 1000 * (eye.index / retina_mm - (eye.index - 1) / 7.6) - m_D;
      /* the pencil's angle is its height times the error of focus: of the cornea reckoned by its
       * nodal point (eye.h), of the whole eye where its pupil is */
      double per_D = (double)x / 1000 / arcmin_rad, scale = retina_mm / eye.index / nodal_mm;
      double angle = per_D * vergence_D, pupil = angle / (1 - 3.05e-3 * vergence_D);
      assert_near((double)before, angle * scale, 0.005 + 0.003 * fabs(angle));
      assert_near((double)wide, pupil, 0.005 + 0.003 * fabs(pupil));
      /* near light is narrower at the cornea than at the pupil, by 3 times 3.05 thousandths */
      assert_near((double)close, pupil, 0.005 + 0.02 * fabs(pupil));
    }
  }
  placido_surface_free(surface);
}

/* What the search finds is better than what lies beside it, and no worse than where it set out. */
static void test_focus(void **state) {
  (void)state;
  placido_surface *surfaces[] = {conic(7.72, -0.26), toric(7.9, 7.5, -0.3, 25),
                                 comatic(PLACIDO_EYE_INDEX, 1.5)};
  for (int i = 0; i < 6; i++) {
    const placido_surface *surface = surfaces[i / 2];
    const placido_ocular ocular = {.whole = true, .accommodation_D = i % 2 == 0 ? 0 : 3};
    placido_eye eye =
      settled_eye(surface, (placido_eye){.pupil_mm = 5, .correct = PLACIDO_CORRECT_FULL});
    placido_eye found = focus(surface, &eye, PLACIDO_CORRECT_FULL, &ocular);
    placido_eye start = focus(surface, &eye, PLACIDO_CORRECT_NONE, &ocular);
    double best = gather(surface, &found, &ocular);
    assert_true(best > 0.2);
    assert_true(best >= gather(surface, &start, &ocular) - 0.002); /* other rays */
    for (int k = 0; k < 6; k++) {
      placido_eye beside = found;
      double more_D = k % 2 == 0 ? 0.15 : -0.15;
      beside.correction.m_D += k / 2 == 0 ? more_D : 0;
      beside.correction.j0_D += k / 2 == 1 ? more_D : 0;
      beside.correction.j45_D += k / 2 == 2 ? more_D : 0;
      assert_true(best > gather(surface, &beside, &ocular) - 0.002);
    }
    /* the optics behind are round about the axis: only the front's cylinder is there, with the
     * index of the cornea itself */
    double index = placido_navarro_at(0, 555).surfaces[0].before;
    double times = (index - 1) / (PLACIDO_EYE_INDEX - 1);
    double allowed_D = i < 4 ? 0.03 : 0.12; /* coma leaves the cylinder open to a tenth */
    assert_near(found.correction.j0_D, times * eye.correction.j0_D, allowed_D);
    assert_near(found.correction.j45_D, times * eye.correction.j45_D, allowed_D);
    assert_near(found.correction.m_D, eye.correction.m_D, 0);
  }
  for (int i = 0; i < 3; i++) {
    placido_surface_free(surfaces[i]);
  }
}

/* What is not open stays: a cylinder that is not worn is not corrected. */
static void test_open(void **state) {
  (void)state;
  placido_surface *surface = toric(7.9, 7.5, -0.3, 25);
  placido_eye eye = settled_eye(surface, (placido_eye){.pupil_mm = 4, .correct = PLACIDO_CORRECT_SPHERE,
                                                  .correction = {.j0_D = 0.25}});
  placido_eye sphere = focus(surface, &eye, PLACIDO_CORRECT_SPHERE, &whole);
  placido_eye none = focus(surface, &eye, PLACIDO_CORRECT_NONE, &whole);
  assert_near(sphere.correction.j0_D, 0.25, 0);
  assert_near(sphere.correction.j45_D, 0, 0);
  double rule_mm;
  assert_int_equal(placido_ocular_retina(&rule_mm, surface, &eye, &whole, NULL), PLACIDO_OK);
  assert_near(none.retina_mm, rule_mm, 0);
  assert_true(sphere.retina_mm != rule_mm);
  placido_eye same = focus(surface, &eye, PLACIDO_CORRECT_FULL, &alone);
  assert_near(same.retina_mm, eye.retina_mm, 0);
  placido_surface_free(surface);
}

/* The coefficient of r⁴ in um/mm⁴ of the path difference, by skew rays: paths to the foot of the
 * perpendicular from the focus. */
static double reference_r4(skew_eye eye) {
  const double axis[2] = {0, 0};
  double w[3], landing[3], t[3], path, focus_mm, index = eye.surfaces[eye.count - 1].index;
  skew_power_D(&eye, &focus_mm);
  eye.retina_mm = focus_mm;
  for (int i = 0; i < 3; i++) {
    const double entry[2] = {1e-9 + i, 0};
    assert_true(skew_land(&eye, axis, entry, landing, t, &path));
    w[i] = path - index * landing[0] * t[0];
  }
  /* w0 + a r² + b r⁴ through 0, 1 and 2 mm */
  return 1e3 * -((w[2] - w[0]) - 4 * (w[1] - w[0])) / 12;
}

static double traced_r4(const placido_surface *surface, const placido_eye *eye,
                        const placido_ocular *ocular) {
  placido_pupil pupil;
  assert_int_equal(placido_ocular_pupil(&pupil, surface, eye, ocular, axis_deg, no_offset, 589.3,
                                        200, 1, NULL), PLACIDO_OK);
  const double *row = pupil.opd_um + pupil.n / 2 * pupil.n;
  double w[3] = {0};
  for (int i = 0; i < 3; i++) { /* between samples, linearly after half a row's offset */
    double at = i / pupil.spacing_mm, fall = at - floor(at);
    int column = pupil.n / 2 + (int)at;
    w[i] = (1 - fall) * row[column] + fall * row[column + 1];
  }
  placido_pupil_free(&pupil);
  return ((w[2] - w[0]) - 4 * (w[1] - w[0])) / 12;
}

/* At rest Navarro's eye has 1.3 times the spherical aberration of its cornea reckoned alone; while
 * it accommodates that falls and turns its sign. */
static void test_spherical(void **state) {
  (void)state;
  placido_surface *surface = conic(7.72, -0.26);
  double found[3], expected[3], rest = 0;
  for (int i = 0; i < 3; i++) {
    double accommodation_D = 4 * i;
    const placido_ocular ocular = {.whole = true, .accommodation_D = accommodation_D};
    placido_navarro media = placido_navarro_at(accommodation_D, 589.3);
    const double index[4] = {media.surfaces[0].before, media.surfaces[0].behind,
                             media.surfaces[1].behind, media.surfaces[2].behind};
    placido_eye eye = {.pupil_mm = 5, .correction = {.m_D = accommodation_D}};
    skew_eye other = skew_navarro(7.72, -0.26, accommodation_D, index, 24);
    skew_power_D(&other, &eye.retina_mm);
    found[i] = traced_r4(surface, &eye, &ocular);
    expected[i] = reference_r4(other);
    /* samples stand for sines, not heights: to that order as much as 0.01 um */
    assert_near(found[i], expected[i], 0.05 * fabs(expected[0]));
  }
  skew_eye cornea = skew_cornea(7.72, -0.26, PLACIDO_EYE_INDEX, 30);
  rest = reference_r4(cornea);
  assert_true(expected[0] > 1.2 * rest && expected[0] < 1.5 * rest);
  assert_true(found[1] < 0.5 * found[0] && found[2] < 0);
  placido_surface_free(surface);
}

/* Chromatic difference of focus of the traced media, against the eye's (Thibos), which plans use:
 * from 450 to 650 nm 1.34 D against 1.23. */
static void test_chromatic(void **state) {
  (void)state;
  placido_surface *surface = conic(7.72, -0.26);
  const placido_eye eye = {.pupil_mm = 1, .retina_mm = 24};
  const double lines_nm[3] = {450, 555, 650};
  double defocus_D[3];
  for (int i = 0; i < 3; i++) {
    placido_pupil pupil;
    assert_int_equal(placido_ocular_pupil(&pupil, surface, &eye, &whole, axis_deg, no_offset,
                                          lines_nm[i], 100, 1, NULL), PLACIDO_OK);
    const double *row = pupil.opd_um + pupil.n / 2 * pupil.n + pupil.n / 2;
    double at_mm = 50 * pupil.spacing_mm;
    defocus_D[i] = (row[49] + row[-51] - 2 * row[0]) / (at_mm * at_mm); /* W = D r² / 2 */
    placido_pupil_free(&pupil);
  }
  for (int i = 0; i < 3; i += 2) {
    double traced_D = defocus_D[i] - defocus_D[1];
    double thibos_D = placido_chromatic_defocus(lines_nm[i], 555);
    assert_near(traced_D, thibos_D, 0.15);
  }
  assert_near(defocus_D[0] - defocus_D[2], 1.34, 0.02);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_retina),    cmocka_unit_test(test_focus),
    cmocka_unit_test(test_open),      cmocka_unit_test(test_spherical),
    cmocka_unit_test(test_chromatic),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
