/* Where the guide must not be fooled: no eye, a blink, too much light, odd frames. */
#include "tests/acquire/guide_use.h"

#include "base/memory.h"

#include <math.h>
#include <placido/image.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

static const char *const instruments[] = {"cone24", "disc18"};
enum { INSTRUMENTS = 2, NOTHINGS = 9 };

/* A repeatable sequence of -1..1. */
static double next_noise(uint32_t *state) {
  *state = *state * 1664525u + 1013904223u;
  return (double)(*state >> 8) / 8388608.0 - 1.0;
}

/* What a camera sees without an eye before it. */
static double nothing_at(int which, double x, double y, uint32_t *noise) {
  const double dx = x - 640, dy = y - 512, r = hypot(dx, dy), angle = atan2(dy, dx);
  const double pictures[NOTHINGS] = {
      0,
      255,
      128 + 30 * next_noise(noise),
      128 + 127 * next_noise(noise),
      128 + 100 * sin(0.4 * x),
      ((int)(x / 8) + (int)(y / 8)) % 2 ? 30 : 220,
      128 + 60 * sin(0.05 * x + 0.3 * sin(0.11 * y)) + 40 * sin(0.07 * y) + 5 * next_noise(noise),
      /* an eye without mires: pupil, iris, white */
      r < 150 ? 15 : r < 480 ? 60 + 30 * sin(23 * angle + 2 * sin(0.05 * r)) : 120,
      128 + 100 * sin(40 * angle),
  };
  return pictures[which];
}

static void draw(placido_frame *frame, int which) {
  uint32_t noise = 7;
  assert_int_equal(placido_frame_resize(frame, 1280, 1024, PLACIDO_MONO8, NULL), PLACIDO_OK);
  for (int y = 0; y < 1024; y++) {
    for (int x = 0; x < 1280; x++) {
      const double grey = nothing_at(which, x, y, &noise);
      frame->data[(size_t)y * frame->stride_bytes + (size_t)x] =
          (uint8_t)fmin(255, fmax(0, grey));
    }
  }
}

static void test_no_eye(void **state) {
  (void)state;
  for (int i = 0; i < INSTRUMENTS; i++) {
    struct guide_use use;
    guide_use_open(&use, instruments[i], "normal");
    for (int which = 0; which < NOTHINGS; which++) {
      size_t count;
      draw(&use.frame, which);
      const placido_guidance g = guide_use_look(&use);
      assert_int_equal(g.state, PLACIDO_GUIDE_NO_EYE);
      assert_true(isnan(g.x_mm) && g.score == 0 && g.coverage == 0);
      assert_string_equal(g.instruction, "no eye");
      placido_guide_points(use.guide, &count);
      assert_int_equal(count, 0);
    }
    guide_use_close(&use);
  }
}

/* Heavy noise hides nothing: 20 grey levels leave the decentration within the usual 0.05 mm. */
static void test_noise(void **state) {
  (void)state;
  for (int i = 0; i < INSTRUMENTS; i++) {
    const placido_guidance g = guide_use_once(
        instruments[i], "keratoconus", (placido_disturbance){.noise = 20, .shift_mm = {0.4, 0.1}});
    const placido_guidance clean = guide_use_once(
        instruments[i], "keratoconus", (placido_disturbance){.shift_mm = {0.4, 0.1}});
    assert_true(fabs(g.x_mm - clean.x_mm) < 0.05 && fabs(g.y_mm - clean.y_mm) < 0.05);
    assert_true(g.coverage > 0.9);
  }
}

/* Multiplies the frame's grey levels. */
static void expose(struct guide_use *use, double gain) {
  for (size_t i = 0; i < use->frame.stride_bytes * (size_t)use->frame.height_px; i++) {
    use->frame.data[i] = (uint8_t)fmin(255, gain * use->frame.data[i]);
  }
}

static void test_light(void **state) {
  (void)state;
  struct guide_use use;
  guide_use_open(&use, "cone24", "normal");
  assert_true(guide_use_see(&use, (placido_disturbance){.noise = 2}).clipped < 0.001);
  expose(&use, 2);
  const placido_guidance bright = guide_use_look(&use);
  assert_true(bright.clipped > 0.3); /* the bright mires are about half of the disc */
  assert_string_equal(bright.instruction, "less light");
  guide_use_render(&use, (placido_disturbance){.noise = 2});
  expose(&use, 0.08);
  assert_string_equal(guide_use_look(&use).instruction, "more light");
  guide_use_close(&use);
}

/* Covers the rows above `v_px` with skin. */
static void lower_lid(placido_frame *frame, int v_px) {
  for (int y = 0; y < v_px; y++) {
    uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    for (int x = 0; x < frame->width_px; x++) {
      row[x] = (uint8_t)(126 + 7 * sin(0.05 * x + 0.01 * y));
    }
  }
}

/* A blink of 0.2 s at 30 frames a second: the lid comes down, hides everything, and opens. Where it
 * hides less than a quarter of the mires, the frame is worth measuring. */
static void test_blink(void **state) {
  (void)state;
  static const int lids_px[] = {0, 0, 300, 520, 1024, 1024, 600, 250, 0, 0};
  static uint8_t open_eye[1280 * 1024];
  for (int i = 0; i < INSTRUMENTS; i++) {
    struct guide_use use;
    guide_use_open(&use, instruments[i], "normal");
    guide_use_render(&use, (placido_disturbance){.noise = 3});
    assert_int_equal(use.frame.stride_bytes, 1280);
    memcpy(open_eye, use.frame.data, sizeof open_eye);
    for (int k = 0; k < 10; k++) {
      memcpy(use.frame.data, open_eye, sizeof open_eye);
      lower_lid(&use.frame, lids_px[k]);
      use.frame.t_ns = 1000000000 + k * 33333333LL;
      const placido_guidance g = guide_use_look(&use);
      assert_int_equal(g.state, lids_px[k] > 400 ? PLACIDO_GUIDE_BLINK : PLACIDO_GUIDE_READY);
    }
    /* Whoever keeps the eye shut does not blink. */
    lower_lid(&use.frame, 1024);
    use.frame.t_ns += 5000000000LL;
    assert_int_equal(guide_use_look(&use).state, PLACIDO_GUIDE_NO_EYE);
    guide_use_close(&use);
  }
}

/* A lid that droops from the start is no blink but asked to be lifted. */
static void test_droop(void **state) {
  (void)state;
  struct guide_use use;
  guide_use_open(&use, "cone24", "normal");
  guide_use_render(&use, (placido_disturbance){.noise = 3});
  lower_lid(&use.frame, 460);
  for (int k = 0; k < 3; k++) {
    const placido_guidance g = guide_use_look(&use);
    assert_int_equal(g.state, PLACIDO_GUIDE_ALIGN);
    assert_string_equal(g.instruction, "open the eye wider");
  }
  guide_use_close(&use);
}

/* The recorded samples: real sampling, lids, lashes, a cone. All were made to be measured. */
static void test_samples(void **state) {
  (void)state;
  static const char *const names[] = {"normal", "sphere", "keratoconus", "post-prk",
                                      "irregular-lid", "disc-normal"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char path[512];
    placido_instrument instrument;
    placido_frame frame = {0};
    placido_guide *guide;
    placido_guidance g;
    snprintf(path, sizeof path, "%s/samples/%s.instrument.json", PLACIDO_TEST_DATA, names[i]);
    assert_int_equal(placido_instrument_load(&instrument, path, NULL, NULL), PLACIDO_OK);
    snprintf(path, sizeof path, "%s/samples/%s.png", PLACIDO_TEST_DATA, names[i]);
    assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
    assert_int_equal(placido_guide_new(&guide, &instrument, NULL), PLACIDO_OK);
    assert_int_equal(placido_guide_look(guide, &frame, &g, NULL), PLACIDO_OK);
    assert_int_equal(g.state, PLACIDO_GUIDE_READY);
    assert_true(g.coverage > 0.85);
    placido_guide_free(guide);
    placido_frame_free(&frame);
  }
}

/* 16 bits and colour tell the same as 8 bits of grey. */
static void test_formats(void **state) {
  (void)state;
  struct guide_use use;
  placido_frame colour = {0};
  placido_guidance g;
  guide_use_open(&use, "cone24", "keratoconus");
  const placido_guidance grey = guide_use_see(&use, (placido_disturbance){.noise = 2});
  assert_int_equal(placido_frame_resize(&colour, 1280, 1024, PLACIDO_RGB8, NULL), PLACIDO_OK);
  for (size_t y = 0; y < 1024; y++) {
    for (size_t x = 0; x < 1280; x++) {
      uint8_t *pixel = colour.data + y * colour.stride_bytes + 3 * x;
      pixel[0] = 20;
      pixel[1] = use.frame.data[y * use.frame.stride_bytes + x] / 4;
      pixel[2] = use.frame.data[y * use.frame.stride_bytes + x];
    }
  }
  assert_int_equal(placido_guide_look(use.guide, &colour, &g, NULL), PLACIDO_OK);
  assert_true(g.x_mm == grey.x_mm && g.coverage == grey.coverage && g.blur_px == grey.blur_px);
  g = guide_use_see(&use, (placido_disturbance){.noise = 2, .bits = 12});
  /* 8 bits round to a grey level; a hundredth of a millimetre is a pixel. */
  assert_true(fabs(g.x_mm - grey.x_mm) < 0.01 && fabs(g.blur_px - grey.blur_px) < 0.1);
  placido_frame_free(&colour);
  guide_use_close(&use);
}

static void test_wrong_size_is_refused(void **state) {
  (void)state;
  struct guide_use use;
  placido_guidance g;
  placido_error err = {0};
  guide_use_open(&use, "cone24", "sphere");
  assert_int_equal(placido_frame_resize(&use.frame, 640, 480, PLACIDO_MONO8, NULL), PLACIDO_OK);
  assert_int_equal(placido_guide_look(use.guide, &use.frame, &g, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "640"));
  guide_use_close(&use);
}

static void test_poor_instruments_are_refused(void **state) {
  (void)state;
  placido_instrument instrument;
  placido_guide *guide;
  placido_error err = {0};
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  instrument.edge_count = 3;
  assert_int_equal(placido_guide_new(&guide, &instrument, &err), PLACIDO_INPUT);
  assert_null(guide);
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  instrument.focal_px[0] = instrument.focal_px[1] = 2000;
  assert_int_equal(placido_guide_new(&guide, &instrument, &err), PLACIDO_INPUT);
  assert_null(guide);
  placido_guide_free(NULL);
}

static void test_memory(void **state) {
  (void)state;
  placido_instrument instrument;
  placido_guide *guide = NULL;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  placido_memory_fail_at(0);
  assert_int_equal(placido_guide_new(&guide, &instrument, NULL), PLACIDO_OK);
  placido_guide_free(guide);
  const unsigned long allocations = placido_memory_fail_at(0);
  for (unsigned long n = 1; n <= allocations; n++) {
    placido_memory_fail_at(n);
    assert_int_equal(placido_guide_new(&guide, &instrument, NULL), PLACIDO_MEMORY);
    assert_null(guide);
  }
  placido_memory_fail_at(0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_no_eye),
      cmocka_unit_test(test_noise),
      cmocka_unit_test(test_light),
      cmocka_unit_test(test_blink),
      cmocka_unit_test(test_droop),
      cmocka_unit_test(test_samples),
      cmocka_unit_test(test_formats),
      cmocka_unit_test(test_wrong_size_is_refused),
      cmocka_unit_test(test_poor_instruments_are_refused),
      cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
