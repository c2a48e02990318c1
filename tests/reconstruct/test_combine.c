/* Frames of one eye that moves between them, made into one: better than the best of them, and none
 * the worse for those that disagree. */
#include "base/memory.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/combine.h>
#include <placido/phantom.h>
#include <stdlib.h>
#include <string.h>

#define FRAMES 8
#define MERIDIANS 180

static placido_instrument cone(void) {
  placido_instrument instrument;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  return instrument;
}

/* An astigmatic eye with a moderate keratoconus, moved and turned about the z axis. */
static placido_surface *eye_at(const double shift_mm[3], double turn_deg) {
  const double a = turn_deg * M_PI / 180, x = 0.4, y = -0.8;
  const double cx = x * cos(a) - y * sin(a) + shift_mm[0];
  const double cy = x * sin(a) + y * cos(a) + shift_mm[1];
  placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC,
       .as.biconic = {7.85, -0.25, 7.6, -0.2, 20 + turn_deg, shift_mm[0], shift_mm[1]}},
      {.kind = PLACIDO_PART_BUMP, .as.bump = {0.05, 1.15, 1.15, cx, cy, 0}},
  };
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, shift_mm[2], 6, parts, 2, NULL, NULL), PLACIDO_OK);
  return surface;
}

static double axis_z_of(const placido_surface *surface) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, 0, 0, &jet));
  return placido_surface_vertex_z_mm(surface) - jet.sag;
}

/* What a session of the phantom has: drift and tremor, focus that varies, one frame out of focus,
 * one with the lid down, one blurred by a jerk of the eye. */
typedef struct moment {
  double shift_mm[3];
  double blur_px, motion_px;
  bool lid;
} moment;

static const moment moments[FRAMES] = {
    {{0, 0, 0}, 0.80, 0, false},
    {{0.021, -0.012, 0.004}, 0.85, 0, false},
    {{-0.017, 0.020, 0.030}, 3.0, 0, false},
    {{0.034, 0.008, -0.006}, 0.81, 0, false},
    {{-0.012, -0.031, 0.007}, 0.80, 0, true},
    {{0.041, -0.022, -0.009}, 0.83, 0, false},
    {{-0.030, 0.015, 0.003}, 0.80, 5, false},
    {{0.009, 0.038, -0.011}, 0.84, 0, false},
};
enum { OUT_OF_FOCUS = 2, BLINK = 4, JERK = 6 };

static placido_mires mires_of(int i, double noise, const placido_instrument *instrument) {
  const moment *m = &moments[i];
  placido_surface *truth = eye_at(m->shift_mm, 0);
  const placido_disturbance disturbance = {.seed = 100 + (uint64_t)i,
                                           .noise = noise,
                                           .blur_px = m->blur_px,
                                           .motion_px = m->motion_px,
                                           .motion_deg = 50,
                                           .lid = m->lid};
  const placido_mires_options how = {.threads = 2};
  placido_frame frame = {0};
  placido_mires mires;
  assert_int_equal(placido_phantom_render(&frame, truth, instrument, &disturbance, 2, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_mires_find(&mires, &frame, instrument, &how, NULL, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  placido_surface_free(truth);
  return mires;
}

/* Elevation errors over 6 and 8 mm of mires of the eye at a place. */
static void measure(double error_um[2], placido_mires *mires, const double shift_mm[3],
                    const placido_instrument *instrument) {
  placido_surface *truth = eye_at(shift_mm, 0);
  const placido_fit_options options = {.axis_z_mm = axis_z_of(truth), .threads = 2};
  placido_fit *fit;
  assert_int_equal(placido_fit_new(&fit, mires, instrument, &options, NULL, NULL), PLACIDO_OK);
  for (int zone = 0; zone < 2; zone++) {
    const truth_error error = truth_compare(fit, truth, 0, zone == 0 ? 6 : 8);
    error_um[zone] = error.elevation_um;
  }
  placido_fit_free(fit);
  placido_surface_free(truth);
}

static void combine(placido_mires *combined, placido_movement *movements, const placido_mires *list,
                    size_t count, const placido_instrument *instrument) {
  placido_error err = {0};
  const placido_fit_options options = {.threads = 2};
  if (placido_mires_combine(combined, movements, list, count, instrument, &options, &err)) {
    fail_msg("%s", err.text);
  }
}

/* Where the combination puts the eye. */
static void mean_place(double mean_mm[3], const placido_movement *movements) {
  for (int axis = 0; axis < 3; axis++) {
    mean_mm[axis] = 0;
    for (int i = 0; i < FRAMES; i++) {
      mean_mm[axis] += movements[i].weight * moments[i].shift_mm[axis];
    }
  }
}

/* Six good frames of noise alone would give √6; 1.4 leaves room for what they have in common (the
 * pixels' grid), and for how lucky the luckiest of eight frames is. */
static void noisy_frames_together_beat_the_best_of_them(void **state) {
  (void)state;
  const placido_instrument instrument = cone();
  placido_mires list[FRAMES], combined;
  placido_movement movements[FRAMES];
  double best_um[2] = {INFINITY, INFINITY}, error_um[2], mean_mm[3];
  for (int i = 0; i < FRAMES; i++) {
    list[i] = mires_of(i, 5, &instrument);
  }
  combine(&combined, movements, list, FRAMES, &instrument);
  mean_place(mean_mm, movements);
  for (int i = 0; i < FRAMES; i++) {
    measure(error_um, &list[i], moments[i].shift_mm, &instrument);
    best_um[0] = fmin(best_um[0], error_um[0]);
    best_um[1] = fmin(best_um[1], error_um[1]);
    /* of the frames that count, the eye's place is known to a tenth of a pixel's width */
    for (int axis = 0; axis < 3 && movements[i].weight > 0; axis++) {
      assert_near(movements[i].shift_mm[axis], moments[i].shift_mm[axis] - mean_mm[axis], 1e-3);
    }
    placido_mires_free(&list[i]);
  }
  measure(error_um, &combined, mean_mm, &instrument);
  print_message("6 mm: %.4f um, best frame %.4f; 8 mm: %.4f um, best frame %.4f\n", error_um[0],
                best_um[0], error_um[1], best_um[1]);
  assert_true(1.4 * error_um[0] < best_um[0]);
  assert_true(1.4 * error_um[1] < best_um[1]);
  assert_true(combined.coverage > 0.99); /* what the lid hides, other frames show */
  assert_true(movements[OUT_OF_FOCUS].weight == 0 && movements[JERK].weight == 0);
  assert_true(movements[BLINK].weight > 0);
  placido_mires_free(&combined);
}

static placido_mires points_of(const double shift_mm[3], double turn_deg, double noise_px,
                               const placido_instrument *instrument) {
  placido_surface *truth = eye_at(shift_mm, turn_deg);
  placido_mires mires = truth_points(truth, instrument, MERIDIANS, noise_px, NULL);
  placido_surface_free(truth);
  return mires;
}

/* The noise of truth_points is the same for each: what is left of a difference is movement. */
static void movement_is_told_and_does_no_harm(void **state) {
  (void)state;
  const placido_instrument instrument = cone();
  const double shifts_mm[3][3] = {{0, 0, 0}, {0.3, -0.1, 0.05}, {-0.1, 0.2, -0.15}};
  const double turns_deg[3] = {0, 1.5, -0.6}, mean_turn_deg = 0.3;
  placido_mires list[3], combined;
  placido_movement movements[3];
  for (int i = 0; i < 3; i++) {
    list[i] = points_of(shifts_mm[i], turns_deg[i], 0, &instrument);
  }
  combine(&combined, movements, list, 3, &instrument);
  double mean_mm[3];
  for (int axis = 0; axis < 3; axis++) {
    mean_mm[axis] = (shifts_mm[0][axis] + shifts_mm[1][axis] + shifts_mm[2][axis]) / 3;
  }
  for (int i = 0; i < 3; i++) {
    for (int axis = 0; axis < 3; axis++) {
      /* a thousandth of the movement, and what an eye that is not quite spherical tells of turns */
      assert_near(movements[i].shift_mm[axis], shifts_mm[i][axis] - mean_mm[axis], 1e-3);
    }
    assert_near(movements[i].turn_deg[2], turns_deg[i] - mean_turn_deg, 0.02);
  }
  /* the combined edges are those of the eye at its mean place, of which 0.01 px is good */
  placido_mires expected = points_of(mean_mm, mean_turn_deg, 0, &instrument);
  assert_true(combined.count > expected.count * 98 / 100);
  double worst = 0;
  for (size_t i = 0, j = 0; i < combined.count; i++) {
    const placido_mire_point *p = &combined.points[i];
    while (expected.points[j].edge != p->edge ||
           fabs(expected.points[j].meridian_deg - p->meridian_deg) > 0.1) {
      j++;
      assert_true(j < expected.count);
    }
    worst =
        fmax(worst, hypot(p->u_px - expected.points[j].u_px, p->v_px - expected.points[j].v_px));
  }
  print_message("worst %.4f px\n", worst);
  assert_true(worst < 0.01);
  placido_mires_free(&expected);
  placido_mires_free(&combined);
  for (int i = 0; i < 3; i++) {
    placido_mires_free(&list[i]);
  }
}

static void one_frame_stays_as_it_is(void **state) {
  (void)state;
  const placido_instrument instrument = cone();
  placido_mires one = points_of(moments[0].shift_mm, 0, 0.05, &instrument), combined;
  placido_movement movement;
  combine(&combined, &movement, &one, 1, &instrument);
  assert_near(movement.weight, 1, 1e-12);
  assert_true(combined.count > one.count * 98 / 100);
  for (size_t i = 0, j = 0; i < combined.count; i++, j++) {
    while (one.points[j].edge != combined.points[i].edge ||
           one.points[j].meridian_deg != combined.points[i].meridian_deg) {
      j++;
    }
    assert_near(combined.points[i].u_px, one.points[j].u_px, 1e-6);
    assert_near(combined.points[i].v_px, one.points[j].v_px, 1e-6);
  }
  placido_mires_free(&combined);
  placido_mires_free(&one);
}

/* The other eye got among the frames. */
static void a_frame_of_another_eye_is_set_aside(void **state) {
  (void)state;
  const placido_instrument instrument = cone();
  placido_surface *other;
  assert_int_equal(placido_phantom_eye(&other, "astigmatic", NULL), PLACIDO_OK);
  placido_mires list[4], combined;
  placido_movement movements[4];
  list[0] = points_of(moments[0].shift_mm, 0, 0.02, &instrument);
  list[1] = truth_points(other, &instrument, MERIDIANS, 0.02, NULL);
  list[2] = points_of(moments[3].shift_mm, 0, 0.02, &instrument);
  list[3] = points_of(moments[5].shift_mm, 0, 0.02, &instrument);
  combine(&combined, movements, list, 4, &instrument);
  assert_true(movements[1].weight == 0);
  assert_true(movements[0].weight > 0.2 && movements[2].weight > 0.2 && movements[3].weight > 0.2);
  placido_mires_free(&combined);
  for (int i = 0; i < 4; i++) {
    placido_mires_free(&list[i]);
  }
  placido_surface_free(other);
}

static void what_does_not_match_is_refused(void **state) {
  (void)state;
  const placido_instrument instrument = cone();
  placido_mires list[2], combined;
  placido_error err = {0};
  list[0] = points_of(moments[0].shift_mm, 0, 0, &instrument);
  list[1] = list[0];
  list[1].meridian_count = 2 * MERIDIANS;
  assert_int_equal(placido_mires_combine(&combined, NULL, list, 2, &instrument, NULL, &err),
                   PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "expected 48 edges on 180 meridians"));
  assert_null(combined.points);
  assert_int_equal(placido_mires_combine(&combined, NULL, list, 0, &instrument, NULL, &err),
                   PLACIDO_INPUT);
  assert_int_equal(placido_mires_combine(&combined, NULL, list, PLACIDO_COMBINE_MAX + 1,
                                         &instrument, NULL, &err),
                   PLACIDO_INPUT);
  placido_mires_free(&list[0]);
}

/* Some of the allocations, as a fit makes many and takes its time. */
static void an_allocation_may_fail(void **state) {
  (void)state;
  const placido_instrument instrument = cone();
  placido_surface *truth = eye_at(moments[0].shift_mm, 0);
  placido_mires list[2], combined;
  list[0] = list[1] = truth_points(truth, &instrument, 24, 0, NULL);
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n += 1 + n / 5) {
    placido_memory_fail_at(n);
    status = placido_mires_combine(&combined, NULL, list, 2, &instrument, NULL, NULL);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK || !combined.points);
  }
  assert_int_equal(status, PLACIDO_OK);
  placido_mires_free(&combined);
  placido_mires_free(&list[0]);
  placido_surface_free(truth);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(noisy_frames_together_beat_the_best_of_them),
      cmocka_unit_test(movement_is_told_and_does_no_harm),
      cmocka_unit_test(one_frame_stays_as_it_is),
      cmocka_unit_test(a_frame_of_another_eye_is_set_aside),
      cmocka_unit_test(what_does_not_match_is_refused),
      cmocka_unit_test(an_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
