/* The best frame is the one that shows the most mires, sharply: the score must fall with every
 * thing that makes a frame worse for measuring. */
#include "acquire/acquire.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

enum { WIDTH = 640, HEIGHT = 512 };

/* How a picture of rings is spoilt. */
struct spoiling {
  double softness_px;    /* width of an edge [1] */
  double contrast;       /* [1] */
  double gain;           /* beyond full scale samples saturate [1] */
  double noise;          /* grey levels, peak */
  double lid_share;      /* of the height, covered from above by skin */
  double centre_u, centre_v; /* offset of the rings, px */
};

/* A repeatable sequence of -1..1. */
static double next_noise(uint32_t *state) {
  *state = *state * 1664525u + 1013904223u;
  return (double)(*state >> 8) / 8388608.0 - 1.0;
}

static double grey_at(const struct spoiling *how, int x, int y, uint32_t *state) {
  const double noise = how->noise * next_noise(state);
  if (y < how->lid_share * HEIGHT) {
    return 90.0 + 12.0 * next_noise(state) + noise; /* bright skin with texture */
  }
  const double dx = x - 0.5 * WIDTH - how->centre_u, dy = y - 0.5 * HEIGHT - how->centre_v;
  const double radius = hypot(dx, dy), period = 20.0;
  const double wave = sin(2.0 * 3.14159265358979 * radius / period);
  const double softness = how->softness_px > 0.0 ? how->softness_px : 1.0;
  const double edge = tanh(wave * period / 6.0 / softness);
  const double contrast = how->contrast > 0.0 ? how->contrast : 1.0;
  return (how->gain > 0.0 ? how->gain : 1.0) * (100.0 + 80.0 * contrast * edge) + noise;
}

static void draw(placido_frame *frame, const struct spoiling *how) {
  uint32_t state = 1;
  assert_int_equal(placido_frame_resize(frame, WIDTH, HEIGHT, PLACIDO_MONO8, NULL), PLACIDO_OK);
  for (int y = 0; y < HEIGHT; y++) {
    for (int x = 0; x < WIDTH; x++) {
      const double grey = fmin(255.0, fmax(0.0, grey_at(how, x, y, &state)));
      frame->data[(size_t)y * frame->stride_bytes + (size_t)x] = (uint8_t)(grey + 0.5);
    }
  }
}

static double score_of(struct spoiling how) {
  placido_frame frame = {0};
  double score;
  draw(&frame, &how);
  assert_int_equal(placido_frame_score(&score, &frame, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  return score;
}

static void test_sharp_beats_soft(void **state) {
  (void)state;
  assert_true(score_of((struct spoiling){.softness_px = 1}) >
              1.2 * score_of((struct spoiling){.softness_px = 3}));
}

static void test_contrast_counts(void **state) {
  (void)state;
  assert_true(score_of((struct spoiling){.contrast = 1}) >
              1.5 * score_of((struct spoiling){.contrast = 0.5}));
}

/* Half the rings are half the information: the score falls in proportion, within a fifth for the
 * skin's own texture and the cells that the lid cuts. */
static void test_lid_counts_in_proportion(void **state) {
  (void)state;
  const double open = score_of((struct spoiling){.lid_share = 0});
  const double half = score_of((struct spoiling){.lid_share = 0.5});
  assert_true(half < 0.6 * open);
  assert_true(half > 0.4 * open);
}

/* A blinking frame that is sharper than the others must not win. */
static void test_half_lid_loses_against_soft(void **state) {
  (void)state;
  assert_true(score_of((struct spoiling){.softness_px = 2}) >
              score_of((struct spoiling){.lid_share = 0.5}));
}

static void test_saturation_counts(void **state) {
  (void)state;
  assert_true(score_of((struct spoiling){.gain = 1}) > score_of((struct spoiling){.gain = 2.4}));
}

/* Noise has no direction: alone it scores next to nothing, though its slopes are as steep as the
 * mires'. */
static void test_noise_is_no_mire(void **state) {
  (void)state;
  const double rings = score_of((struct spoiling){.contrast = 1});
  const double noise = score_of((struct spoiling){.contrast = 1e-9, .noise = 60});
  assert_true(noise < 0.1 * rings);
}

/* An eye that is not centred (0.5 mm are some 45 px of 1280) keeps most of its score. */
static void test_decentred_keeps_score(void **state) {
  (void)state;
  const double centred = score_of((struct spoiling){.centre_u = 0});
  const double aside = score_of((struct spoiling){.centre_u = 25, .centre_v = -10});
  assert_true(aside > 0.8 * centred);
}

static void test_grey_is_zero(void **state) {
  (void)state;
  placido_frame frame = {0};
  double score = 1.0;
  draw(&frame, &(struct spoiling){0});
  memset(frame.data, 128, frame.stride_bytes * HEIGHT);
  assert_int_equal(placido_frame_score(&score, &frame, NULL), PLACIDO_OK);
  assert_true(score == 0.0);
  placido_frame_free(&frame);
}

/* The same picture in 16 bit and in colour has the same score. */
static void test_formats_agree(void **state) {
  (void)state;
  placido_frame grey = {0}, deep = {0}, colour = {0};
  double score, other;
  draw(&grey, &(struct spoiling){0});
  assert_int_equal(placido_frame_resize(&deep, WIDTH, HEIGHT, PLACIDO_MONO16, NULL), 0);
  assert_int_equal(placido_frame_resize(&colour, WIDTH, HEIGHT, PLACIDO_RGB8, NULL), 0);
  deep.bits = 16;
  for (int y = 0; y < HEIGHT; y++) {
    for (int x = 0; x < WIDTH; x++) {
      const uint8_t value = grey.data[(size_t)y * grey.stride_bytes + (size_t)x];
      const uint16_t wide = (uint16_t)(value * 257); /* 255 becomes 65535 */
      memcpy(deep.data + (size_t)y * deep.stride_bytes + 2 * (size_t)x, &wide, 2);
      uint8_t *pixel = colour.data + (size_t)y * colour.stride_bytes + 3 * (size_t)x;
      pixel[0] = 10;
      pixel[1] = value;
      pixel[2] = 0;
    }
  }
  assert_int_equal(placido_frame_score(&score, &grey, NULL), PLACIDO_OK);
  assert_int_equal(placido_frame_score(&other, &deep, NULL), PLACIDO_OK);
  assert_true(fabs(score - other) < 1e-6 * score);
  assert_int_equal(placido_frame_score(&other, &colour, NULL), PLACIDO_OK);
  assert_true(fabs(score - other) < 1e-6 * score);
  placido_frame_free(&grey);
  placido_frame_free(&deep);
  placido_frame_free(&colour);
}

static void test_tiny_frame_is_refused(void **state) {
  (void)state;
  placido_frame frame = {0};
  placido_error err = {0};
  double score;
  assert_int_equal(placido_frame_resize(&frame, 8, 8, PLACIDO_MONO8, NULL), PLACIDO_OK);
  assert_int_equal(placido_frame_score(&score, &frame, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "8"));
  placido_frame_free(&frame);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sharp_beats_soft),
      cmocka_unit_test(test_contrast_counts),
      cmocka_unit_test(test_lid_counts_in_proportion),
      cmocka_unit_test(test_half_lid_loses_against_soft),
      cmocka_unit_test(test_saturation_counts),
      cmocka_unit_test(test_noise_is_no_mire),
      cmocka_unit_test(test_decentred_keeps_score),
      cmocka_unit_test(test_grey_is_zero),
      cmocka_unit_test(test_formats_agree),
      cmocka_unit_test(test_tiny_frame_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
