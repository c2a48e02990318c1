/* The guide against the phantom, whose eye is moved, blurred and hidden by known amounts. */
#include "tests/acquire/guide_use.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static const char *const instruments[] = {"cone24", "disc18"};
enum { INSTRUMENTS = 2 };
/* Where pixels do not matter: a quarter of the time to render. */
static const char *const quick[] = {"half cone24", "disc18"};

static placido_disturbance at(double x_mm, double y_mm) {
  return (placido_disturbance){.noise = 3, .lashes = 6, .shift_mm = {x_mm, y_mm, 0}};
}

/* 0.05 mm is a fifth of what is still good enough to measure. */
static void test_decentration(void **state) {
  (void)state;
  static const double shifts_mm[][2] = {{0.3, -0.2}, {-1.5, 0}, {0, 1.5}, {1, -1}};
  for (int i = 0; i < INSTRUMENTS; i++) {
    for (size_t k = 0; k < sizeof shifts_mm / sizeof shifts_mm[0]; k++) {
      const double *mm = shifts_mm[k];
      const placido_guidance g = guide_use_once(quick[i], "normal", at(mm[0], mm[1]));
      assert_true(fabs(g.x_mm - mm[0]) < 0.05);
      assert_true(fabs(g.y_mm - mm[1]) < 0.05);
      assert_true(g.coverage > 0.9);
    }
  }
}

/* A cone's mires have another centre than its vertex: what counts is that the mires are centred
 * once the instrument has been moved as it was told. */
static void test_told_move_centres_a_cone(void **state) {
  (void)state;
  for (int i = 0; i < INSTRUMENTS; i++) {
    const placido_guidance before = guide_use_once(quick[i], "keratoconus", at(0.9, -0.7));
    const placido_guidance after = guide_use_once(quick[i], "keratoconus",
                                                  at(0.9 - before.x_mm, -0.7 - before.y_mm));
    assert_true(hypot(before.x_mm, before.y_mm) > 0.8);
    assert_true(hypot(after.x_mm, after.y_mm) < 0.05);
    assert_int_equal(after.state, PLACIDO_GUIDE_READY);
    assert_string_equal(after.instruction, "hold");
  }
}

static void test_directions(void **state) {
  (void)state;
  static const struct {
    double x_mm, y_mm;
    const char *text;
  } cases[] = {{-0.6, 0, "left 0.6 mm"},
               {0.6, 0, "right 0.6 mm"},
               {0, 0.6, "up 0.6 mm"},
               {0.5, -0.8, "right 0.5 mm, down 0.8 mm"}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    const placido_guidance g = guide_use_once(quick[0], "normal", at(cases[k].x_mm, cases[k].y_mm));
    assert_int_equal(g.state, PLACIDO_GUIDE_ALIGN);
    assert_string_equal(g.instruction, cases[k].text);
  }
}

/* Within a fifth, and ever more; below a pixel a sharp edge's own width counts. */
static void test_blur(void **state) {
  (void)state;
  static const double blurs_px[] = {1, 2, 4};
  static const char *const eyes[INSTRUMENTS] = {"keratoconus", "normal"};
  for (int i = 0; i < INSTRUMENTS; i++) {
    double before = guide_use_once(instruments[i], eyes[i], at(0.2, 0.1)).blur_px;
    assert_true(before < 0.5);
    for (size_t k = 0; k < sizeof blurs_px / sizeof blurs_px[0]; k++) {
      placido_disturbance how = at(0.2, 0.1);
      how.blur_px = blurs_px[k];
      const placido_guidance g = guide_use_once(instruments[i], eyes[i], how);
      assert_true(g.blur_px > before);
      assert_true(fabs(g.blur_px - blurs_px[k]) < 0.2 * blurs_px[k]);
      before = g.blur_px;
    }
  }
}

/* The length within a quarter in every direction; without motion less than the pixel. */
static void test_motion(void **state) {
  (void)state;
  static const char *const eyes[INSTRUMENTS] = {"keratoconus", "normal"};
  for (int i = 0; i < INSTRUMENTS; i++) {
    placido_disturbance how = at(0.2, 0.1);
    how.blur_px = 0.7;
    assert_true(guide_use_once(instruments[i], eyes[i], how).motion_px < 1);
    placido_guidance g = {.motion_px = NAN};
    for (int k = 0; k < 3; k++) {
      how.motion_px = 4 + 2 * k;
      how.motion_deg = 10 + 55 * k;
      g = guide_use_once(instruments[i], eyes[i], how);
      assert_true(fabs(g.motion_px - how.motion_px) < 0.25 * how.motion_px);
      assert_true(fabs(g.blur_px - 0.7) < 0.5);
    }
    assert_string_equal(g.instruction, "hold still");
  }
}

/* The lid at 3.1 mm and the nose hide what the picture shows that they hide. */
static void test_coverage(void **state) {
  (void)state;
  for (int i = 0; i < INSTRUMENTS; i++) {
    placido_disturbance how = at(0, 0);
    const double open = guide_use_once(instruments[i], "normal", how).coverage;
    how.lid = true;
    const double lid = guide_use_once(instruments[i], "normal", how).coverage;
    how.nose = true;
    const double both = guide_use_once(instruments[i], "normal", how).coverage;
    assert_true(open > 0.95);
    assert_true(lid < open - 0.03 && lid > 0.8);
    assert_true(both < lid - 0.03 && both > 0.7);
  }
}

/* An unbroken film gives next to nothing on any eye; a broken one grows with its share and asks for
 * a blink. */
static void test_break_up(void **state) {
  (void)state;
  for (int i = 0; i < INSTRUMENTS; i++) {
    static const char *const eyes[] = {"keratoconus", "irregular", "post-prk"};
    for (int k = 0; k < 3; k++) {
      assert_true(guide_use_once(instruments[i], eyes[k], at(0, 0)).break_up < 0.05);
    }
    placido_disturbance how = at(0, 0);
    double before = 0.05;
    placido_guidance last = {.break_up = NAN};
    for (int k = 0; k < 3; k++) {
      how.break_up = 0.1 + 0.15 * k;
      last = guide_use_once(instruments[i], "normal", how);
      assert_true(last.break_up > before);
      before = last.break_up;
    }
    assert_true(last.break_up > 0.15 && last.break_up < 0.5);
    assert_string_equal(last.instruction, "blink, then hold");
  }
}

/* Neither instrument's mires tell how far the eye is: a sharp eye that is nearer looks like one
 * that is flatter. Nothing is made up. */
static void test_focus_is_not_guessed(void **state) {
  (void)state;
  for (int i = 0; i < INSTRUMENTS; i++) {
    placido_disturbance how = at(0, 0);
    how.shift_mm[2] = 0.6;
    const placido_guidance g = guide_use_once(instruments[i], "normal", how);
    assert_true(isnan(g.focus_mm));
    how.blur_px = 3.5;
    assert_string_equal(guide_use_once(instruments[i], "normal", how).instruction, "focus");
  }
}

/* A bowl about the eye, the innermost mires far above it and the outermost close by: what is nearer
 * shows those larger by 7 % a millimetre and these by 2 %. */
static void test_focus_by_parallax(void **state) {
  (void)state;
  struct guide_use use;
  guide_use_open(&use, "cone24", "normal");
  placido_guide_free(use.guide);
  use.instrument.edge_count = 40;
  for (int k = 0; k < 40; k++) {
    const double z_mm = 90 - 84 * k / 39.0, tangent = 0.09 + 0.0265 * k;
    use.instrument.edges[k] = (placido_edge){tangent * (z_mm + 0.3 * k / 13) + 0.065 * k, z_mm};
  }
  assert_int_equal(placido_guide_new(&use.guide, &use.instrument, NULL), PLACIDO_OK);
  static const double z_mm[] = {-0.6, 0, 0.6};
  for (int k = 0; k < 3; k++) {
    placido_disturbance how = at(0.1, -0.1);
    how.shift_mm[2] = z_mm[k];
    const placido_guidance g = guide_use_see(&use, how);
    assert_true(fabs(g.focus_mm + z_mm[k]) < 0.25); /* what asphericity leaves open */
    if (fabs(z_mm[k]) > 0.5) {
      assert_non_null(strstr(g.instruction, z_mm[k] > 0 ? "back" : "closer"));
    }
  }
  guide_use_close(&use);
}

/* What makes a frame worse for measuring lowers its score. */
static void test_score(void **state) {
  (void)state;
  const placido_disturbance worse[] = {
      {.noise = 3, .blur_px = 1},  {.noise = 3, .motion_px = 2},    {.noise = 3, .lid = true},
      {.noise = 3, .break_up = 0.3, .seed = 1}, {.noise = 3, .shift_mm = {0.4, 0, 0}},
  };
  const double best = guide_use_once(quick[0], "normal", (placido_disturbance){.noise = 3}).score;
  assert_true(best > 0.85 && best <= 1);
  for (size_t i = 0; i < sizeof worse / sizeof worse[0]; i++) {
    assert_true(guide_use_once(quick[0], "normal", worse[i]).score < best - 0.05);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_decentration),
      cmocka_unit_test(test_told_move_centres_a_cone),
      cmocka_unit_test(test_directions),
      cmocka_unit_test(test_blur),
      cmocka_unit_test(test_motion),
      cmocka_unit_test(test_coverage),
      cmocka_unit_test(test_break_up),
      cmocka_unit_test(test_focus_is_not_guessed),
      cmocka_unit_test(test_focus_by_parallax),
      cmocka_unit_test(test_score),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
