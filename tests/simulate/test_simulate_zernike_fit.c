/* Zernike terms through scattered points, and refraction from terms. */
#include "eyes.h"
#include "tests/support/near.h"

#include <placido/quality.h>
#include <placido/wavefront.h>

#include <stdlib.h>
#include <string.h>

enum { POINTS = 4000, ORDER = 15, TERMS = 136 };

/* Points of a sequence that fills the disc evenly, and the sum of terms there. */
typedef struct cloud {
  double x[POINTS], y[POINTS], z[POINTS], terms[TERMS * POINTS], coefficients[TERMS];
} cloud;

static cloud *scatter(double least_x) {
  cloud *c = malloc(sizeof *c);
  assert_non_null(c);
  double a = 0.5, b = 0.5;
  for (int i = 0; i < POINTS;) {
    a = fmod(a + 0.7548776662466927, 1);
    b = fmod(b + 0.5698402909980532, 1);
    c->x[i] = 2 * a - 1;
    c->y[i] = 2 * b - 1;
    i += c->x[i] * c->x[i] + c->y[i] * c->y[i] <= 1 && c->x[i] >= least_x;
  }
  placido_zernike_terms(c->terms, ORDER, c->x, c->y, POINTS);
  for (int j = 0; j < TERMS; j++) {
    c->coefficients[j] = sin(1.0 + j);
  }
  for (int i = 0; i < POINTS; i++) {
    c->z[i] = 0;
    for (int j = 0; j < TERMS; j++) {
      c->z[i] += c->coefficients[j] * c->terms[j * POINTS + i];
    }
  }
  return c;
}

static void terms_come_back(void **state) {
  (void)state;
  cloud *c = scatter(-1);
  placido_zernike_fit fit;
  assert_int_equal(placido_zernike_fit_points(&fit, ORDER, c->x, c->y, c->z, NULL, POINTS, NULL),
                   PLACIDO_OK);
  assert_int_equal(fit.term_count, TERMS);
  assert_int_equal(fit.count, POINTS);
  for (int j = 0; j < TERMS; j++) {
    assert_near(fit.coefficients[j], c->coefficients[j], 1e-11);
  }
  assert_true(fit.rms < 1e-6); /* a difference of squares */
  assert_near(fit.condition, 1.7, 0.7);
  free(c);
}

/* Half a disc tells the same, but less surely. */
static void half_a_disc_is_worse_conditioned(void **state) {
  (void)state;
  cloud *c = scatter(-0.05);
  placido_zernike_fit fit;
  placido_error err;
  for (int i = 0; i < POINTS; i++) {
    c->z[i] = c->terms[4 * POINTS + i];
  }
  assert_int_equal(placido_zernike_fit_points(&fit, 4, c->x, c->y, c->z, NULL, POINTS, NULL),
                   PLACIDO_OK);
  assert_true(fit.condition > 5);
  for (int j = 0; j < 15; j++) {
    assert_near(fit.coefficients[j], j == 4, 1e-9);
  }
  assert_int_equal(placido_zernike_fit_points(&fit, ORDER, c->x, c->y, c->z, NULL, POINTS, &err),
                   PLACIDO_QUALITY);
  free(c);
}

/* What no term can follow is left, and its root mean square is told. */
static void the_rest_is_told(void **state) {
  (void)state;
  cloud *c = scatter(-1);
  placido_zernike_fit fit;
  for (int i = 0; i < POINTS; i++) {
    c->z[i] = 3 + 0.2 * c->terms[12 * POINTS + i];
  }
  assert_int_equal(placido_zernike_fit_points(&fit, 3, c->x, c->y, c->z, NULL, POINTS, NULL),
                   PLACIDO_OK);
  assert_near(fit.rms, 0.2, 0.002); /* the points are scattered: nearly orthogonal */
  assert_near(fit.coefficients[0], 3, 0.002);
  free(c);
}

/* Weight 2 is the point twice; weight 0, missing values and places outside the pupil are no
 * points. */
static void weights_and_gaps(void **state) {
  (void)state;
  cloud *c = scatter(-1);
  double weight[POINTS];
  placido_zernike_fit twice, weighted;
  for (int i = 0; i < POINTS; i++) {
    c->z[i] += 0.1 * sin(40.0 * i);
    weight[i] = i < 1000 ? 2 : i < 2000 ? 1 : 0;
  }
  assert_int_equal(
    placido_zernike_fit_points(&weighted, 5, c->x, c->y, c->z, weight, POINTS, NULL), PLACIDO_OK);
  assert_int_equal(weighted.count, 2000);
  for (int i = 2000; i < POINTS; i++) {
    c->x[i] = i < 3000 ? c->x[i - 2000] : 1.5;
    c->y[i] = i < 3000 ? c->y[i - 2000] : 0;
    c->z[i] = i < 3000 ? c->z[i - 2000] : 1;
  }
  c->x[3500] = 0;
  c->z[3500] = NAN;
  assert_int_equal(placido_zernike_fit_points(&twice, 5, c->x, c->y, c->z, NULL, POINTS, NULL),
                   PLACIDO_OK);
  assert_int_equal(twice.count, 3000);
  for (int j = 0; j < 21; j++) {
    assert_near(weighted.coefficients[j], twice.coefficients[j], 1e-11);
  }
  assert_near(weighted.rms, twice.rms, 1e-9);
  free(c);
}

static void too_few_points_are_refused(void **state) {
  (void)state;
  cloud *c = scatter(-1);
  placido_zernike_fit fit;
  placido_error err;
  assert_int_equal(placido_zernike_fit_points(&fit, 2, c->x, c->y, c->z, NULL, 5, &err),
                   PLACIDO_QUALITY);
  assert_int_equal(placido_zernike_fit_points(&fit, 16, c->x, c->y, c->z, NULL, POINTS, &err),
                   PLACIDO_INPUT);
  free(c);
}

/* r² / (4 sqrt 3) micrometres of defocus are a dioptre of myopia. */
static void refraction_of_terms(void **state) {
  (void)state;
  double terms_um[15] = {[3] = 0.1, [4] = 0.57735026919, [5] = -0.2};
  placido_correction whole = placido_terms_refraction(terms_um, 15, 4, false);
  assert_near(whole.m_D, -1, 1e-10);
  assert_near(whole.j0_D, 2 * sqrt(6) * 0.2 / 4, 1e-12);
  assert_near(whole.j45_D, -2 * sqrt(6) * 0.1 / 4, 1e-12);
  placido_correction centre = placido_terms_refraction(terms_um, 15, 4, true);
  assert_near(centre.m_D, whole.m_D, 1e-12);
  terms_um[12] = 0.07; /* + 12 sqrt 5 c40 / r² at the centre */
  terms_um[11] = 0.02; /* + 6 sqrt 10 c4-2 / r² */
  centre = placido_terms_refraction(terms_um, 15, 4, true);
  assert_near(centre.m_D, whole.m_D + 12 * sqrt(5) * 0.07 / 4, 1e-12);
  assert_near(centre.j45_D, whole.j45_D + 6 * sqrt(10) * 0.02 / 4, 1e-12);
  assert_near(placido_terms_refraction(terms_um, 15, 4, false).m_D, whole.m_D, 1e-12);
}

/* Maréchal's estimate holds for a little spherical aberration: Q is 0.2 off, 4 mm. */
static void strehl_ratio_of_a_wavefront(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -1 / (1.3375 * 1.3375) + 0.2);
  const placido_eye eye = {.pupil_mm = 4};
  placido_wavefront w;
  size_t count, i = 0;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  while (strcmp(figures[i].name, "strehl_555nm") != 0) {
    i++;
  }
  assert_int_equal(placido_wavefront_new(&w, surface, &eye, NULL, NULL, NULL), PLACIDO_OK);
  double strehl = figures[i].at(&w, w.coefficients_um);
  assert_true(strehl > 0.6 && strehl < 0.99);
  assert_near(strehl, placido_strehl_marechal(w.rms_um, 555), 0.01);
  assert_near(strehl, placido_strehl(w.opd_um, NULL, w.weight, w.count, 555), 1e-6);
  placido_wavefront_free(&w);
  placido_surface_free(surface);
}

/* All terms up to order 15 of a keratoconus: higher ones explain more. */
static void wavefronts_go_up_to_order_15(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = {.pupil_mm = 6};
  double rest_um = INFINITY;
  for (int order = 3; order <= 15; order += 4) {
    const placido_wavefront_options options = {.order = order};
    placido_wavefront w;
    assert_int_equal(placido_wavefront_new(&w, surface, &eye, &options, NULL, NULL), PLACIDO_OK);
    assert_int_equal(w.term_count, placido_zernike_count(order));
    assert_true(w.rest_um < 0.5 * rest_um);
    rest_um = w.rest_um;
    placido_wavefront_free(&w);
  }
  assert_true(rest_um < 1e-3);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(terms_come_back),
    cmocka_unit_test(half_a_disc_is_worse_conditioned),
    cmocka_unit_test(the_rest_is_told),
    cmocka_unit_test(weights_and_gaps),
    cmocka_unit_test(too_few_points_are_refused),
    cmocka_unit_test(refraction_of_terms),
    cmocka_unit_test(strehl_ratio_of_a_wavefront),
    cmocka_unit_test(wavefronts_go_up_to_order_15),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
