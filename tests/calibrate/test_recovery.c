/* From pictures alone: an instrument whose every part is off is found again, well enough that a
 * ball which took no part is measured right. */
#include "tests/calibrate/balls.h"

#include <placido/calibrate.h>
#include <placido/phantom.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>

#define BALLS 3
#define HEIGHTS 3
#define VIEWS (BALLS * HEIGHTS + 1)
#define Z_SIGMA_MM 0.005 /* of a micrometre stage */
#define HELD_MM 8.1

typedef struct picture {
  double x_mm, y_mm, z_mm;
} picture;

static void take(placido_ball_view *view, picture *p, double radius_mm, double z_mm,
                 const placido_instrument *truth, chance *c) {
  *p = (picture){0.6 * chance_even(c), 0.6 * chance_even(c), z_mm};
  /* the ball itself is half a micrometre off what is written on it */
  placido_surface *ball = balls_new(radius_mm + 0.0005 * chance_normal(c), p->x_mm, p->y_mm, z_mm);
  placido_disturbance disturbance = {
      .seed = c->state, .noise = 1.2, .blur_px = 0.8 + 0.3 * fabs(z_mm)};
  *view = (placido_ball_view){.radius_mm = radius_mm,
                              .radius_sigma_mm = 0.001,
                              .z_mm = z_mm + Z_SIGMA_MM * chance_normal(c),
                              .z_sigma_mm = Z_SIGMA_MM};
  snprintf(view->path, sizeof view->path, "ball %g at %g", radius_mm, z_mm);
  assert_int_equal(
      placido_phantom_render(&view->frame, ball, truth, &disturbance, 0, NULL), PLACIDO_OK);
  placido_surface_free(ball);
}

/* Root mean square of the surface less the ball within 8 mm of the axis, mean removed. */
static double surface_error_um(const placido_surface *surface, const placido_surface *ball) {
  double sum = 0, squares = 0;
  int count = 0;
  for (int j = -40; j <= 40; j++) {
    for (int i = -40; i <= 40; i++) {
      placido_jet found, true_jet;
      if (i * i + j * j <= 1600) {
        assert_true(placido_surface_at(surface, 0.1 * i, 0.1 * j, &found));
        assert_true(placido_surface_at(ball, 0.1 * i, 0.1 * j, &true_jet));
        double error = true_jet.sag - found.sag;
        sum += error;
        squares += error * error;
        count++;
      }
    }
  }
  return 1000 * sqrt(squares / count - sum * sum / count / count);
}

/* Measures a picture with an instrument, its distance on the axis known exactly. */
static double measured_error_um(const placido_ball_view *view, const picture *p,
                                const placido_instrument *instrument) {
  placido_surface *ball = balls_new(HELD_MM, p->x_mm, p->y_mm, p->z_mm);
  placido_jet axis;
  placido_mires mires;
  placido_fit *fit;
  assert_true(placido_surface_at(ball, 0, 0, &axis));
  placido_fit_options options = {.axis_z_mm = p->z_mm - axis.sag};
  assert_int_equal(placido_mires_find(&mires, &view->frame, instrument, NULL, NULL, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_fit_new(&fit, &mires, instrument, &options, NULL, NULL), PLACIDO_OK);
  double error = surface_error_um(placido_fit_surface(fit), ball);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_surface_free(ball);
  return error;
}

static void a_spoilt_instrument_is_found_again(void **state) {
  (void)state;
  static const double radii_mm[BALLS] = {6.5, 9.5, 7.8};
  static placido_ball_view views[VIEWS];
  picture pictures[VIEWS];
  placido_instrument nominal;
  placido_uncertainty prior;
  placido_calibration c;
  placido_notes notes = {0};
  chance chances = {88172645463325252u};
  assert_int_equal(placido_phantom_instrument(&nominal, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_calibrate_prior(&prior, &nominal, NULL), PLACIDO_OK);
  const placido_instrument truth = balls_spoil(&nominal, &chances);
  for (int v = 0; v < VIEWS - 1; v++) {
    take(&views[v], &pictures[v], radii_mm[v / HEIGHTS], -1.0 + v % HEIGHTS, &truth, &chances);
  }
  take(&views[VIEWS - 1], &pictures[VIEWS - 1], HELD_MM, 0.1, &truth, &chances);
  views[VIEWS - 1].held_out = true;

  const placido_calibrate_options options = {.threads = 2};
  assert_int_equal(
      placido_calibrate(&c, &nominal, &prior, views, VIEWS, &options, &notes, NULL), PLACIDO_OK);
  const placido_ball_check *check = &c.views[VIEWS - 1].check;
  double before = measured_error_um(&views[VIEWS - 1], &pictures[VIEWS - 1], &nominal);
  double after = measured_error_um(&views[VIEWS - 1], &pictures[VIEWS - 1], &c.instrument);
  print_message("held-out ball over 8 mm: %.3f um rms before, %.3f um after, %.3f um about its "
                "own place; radius %+.2f um; residual %.4f px; condition %.2g\n",
                before, after, check->rms_8_um, 1000 * (check->radius_mm - HELD_MM), c.rms_px,
                c.condition);
  assert_true(c.instrument.calibrated);
  assert_true(before > 2); /* the task is not empty */
  assert_true(after < 0.2); /* what was asked for; most of it is tilt, which has no power */
  assert_true(c.views[VIEWS - 1].checked);
  assert_true(check->rms_8_um < 0.15); /* 5 µm of the stage alone are 0.075 µm */
  assert_true(fabs(check->worst_power_D) < 0.02); /* and 0.007 D */
  assert_true(c.rms_px < 0.03); /* the noise of the edges in such pictures */

  for (int v = 0; v < VIEWS; v++) {
    placido_frame_free(&views[v].frame);
  }
  placido_notes_clear(&notes);
  placido_uncertainty_free(&prior);
  placido_calibration_free(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_spoilt_instrument_is_found_again),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
