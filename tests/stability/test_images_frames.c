/* Frames without mires, of all sizes: never an edge is found where none is, and every refusal says
 * why. A pretty map of noise is worse than none.
 *
 * Where there is nothing to measure there is nothing to bound: the verdict of every row is that the
 * frame was refused. */
#include "tests/base/recording.h"
#include "tests/base/scratch.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"

#include "acquire/acquire.h"
#include "base/cv/cv.h"
#include "base/random.h"

#include <placido/image.h>
#include <placido/reconstruct.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 640, HEIGHT = 512, MIDDLE = 128 };

/* A disc of mires whose image has this size, its camera at the middle. */
static placido_instrument instrument_of(int width, int height) {
  placido_instrument instrument = {.name = "hard frames",
                                   .model = PLACIDO_PINHOLE,
                                   .width_px = width,
                                   .height_px = height,
                                   .focal_px = {4500, 4500},
                                   .principal_px = {(width - 1) / 2.0, (height - 1) / 2.0},
                                   .position_mm = {0, 0, 100},
                                   .first_band_bright = true,
                                   .edge_count = 24};
  for (int i = 0; i < instrument.edge_count; i++) {
    instrument.edges[i] = (placido_edge){.radius_mm = 4 + 2.5 * i, .z_mm = 45};
  }
  return instrument;
}

/* Grey level of a sample, 0 to 255, of which those beyond are cut off. */
typedef double (*drawing)(int x, int y);

static double noise(int x, int y) {
  return placido_random_normal(11, (uint64_t)y, (uint64_t)x);
}

static double radius(int x, int y) { return hypot(x - WIDTH / 2 + 0.3, y - HEIGHT / 2 - 0.2); }

static double even(int x, int y, double level) {
  (void)x;
  (void)y;
  return level;
}

static double black(int x, int y) { return even(x, y, 0); }
static double white(int x, int y) { return even(x, y, 255); }
static double grey(int x, int y) { return even(x, y, MIDDLE); }
static double one_bright_sample(int x, int y) { return x == 300 && y == 200 ? 255 : 0; }
static double faint_noise(int x, int y) { return 100 + 2 * noise(x, y); }
static double strong_noise(int x, int y) { return MIDDLE + 60 * noise(x, y); }
static double salt_and_pepper(int x, int y) { return noise(x, y) > 0 ? 255 : 0; }
static double fine_checker(int x, int y) { return (x + y) % 2 * 255; }
static double wide_checker(int x, int y) { return (x / 16 + y / 16) % 2 * 255; }
static double stripes(int x, int y) { return even(x, y, x / 10 % 2 * 255); }
static double ramp(int x, int y) { return even(x, y, x * 255.0 / WIDTH); }
static double star(int x, int y) {
  return MIDDLE + 100 * sin(24 * atan2(y - HEIGHT / 2.0, x - WIDTH / 2.0));
}
static double blurred_rings(int x, int y) { /* a contrast of a tenth of a grey level */
  return 100 + 0.1 * cos(radius(x, y) / 2.2) + 2 * noise(x, y);
}
static double three_rings(int x, int y) {
  return radius(x, y) < 30 ? (int)(radius(x, y) / 10) % 2 * 200 : 20;
}
static double quarter(int x, int y) {
  return x > WIDTH / 2 + 20 && y < HEIGHT / 2 - 20 ? 100 + 80 * cos(radius(x, y) / 2.2) : 90;
}
static double burnt_out(int x, int y) { return 5000 + 4000 * cos(radius(x, y) / 2.2); }

static const struct {
  const char *name;
  drawing draw;
} drawings[] = {{"black", black},
                {"white", white},
                {"grey", grey},
                {"one bright sample", one_bright_sample},
                {"faint noise", faint_noise},
                {"strong noise", strong_noise},
                {"salt and pepper", salt_and_pepper},
                {"a checker of one sample", fine_checker},
                {"a checker of 16 samples", wide_checker},
                {"stripes", stripes},
                {"a ramp", ramp},
                {"a star", star},
                {"rings blurred away", blurred_rings},
                {"three rings alone", three_rings},
                {"rings in one quarter", quarter},
                {"rings burnt out", burnt_out}};

enum { DRAWINGS = sizeof drawings / sizeof *drawings };

static void put_sample(placido_frame *frame, int x, int y, double level) {
  uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  double cut = fmin(fmax(level, 0), 255);
  if (frame->format == PLACIDO_MONO16) {
    uint16_t wide = (uint16_t)(cut * 257);
    memcpy(row + 2 * x, &wide, sizeof wide);
  } else if (frame->format == PLACIDO_RGB8) {
    memset(row + 3 * x, (int)cut, 3);
  } else {
    row[x] = (uint8_t)cut;
  }
}

static placido_frame drawn(drawing draw, int width, int height, enum placido_format format) {
  placido_frame frame = {0};
  assert_int_equal(placido_frame_resize(&frame, width, height, format, NULL), PLACIDO_OK);
  for (int y = 0; y < height; y++) {
    for (int x = 0; x < width; x++) {
      put_sample(&frame, x, y, draw(x, y));
    }
  }
  return frame;
}

/* What an examination makes of it: mires, then a cornea. The knots are wide, as nothing is to be
 * measured. */
static int find_with(const placido_frame *frame, const placido_instrument *instrument,
                     placido_error *err) {
  const placido_fit_options options = {.knot_mm = 1};
  placido_mires mires;
  placido_fit *fit = NULL;
  int status = placido_mires_find(&mires, frame, instrument, NULL, NULL, err);
  assert_true(status == PLACIDO_OK || mires.points == NULL);
  if (status == PLACIDO_OK) {
    status = placido_fit_new(&fit, &mires, instrument, &options, NULL, err);
    assert_true(status == PLACIDO_OK || fit == NULL);
  }
  placido_fit_free(fit);
  placido_mires_free(&mires);
  return status;
}

static int find(const placido_frame *frame, placido_error *err) {
  const placido_instrument instrument = instrument_of(frame->width_px, frame->height_px);
  return find_with(frame, &instrument, err);
}

static void frames_without_mires_are_refused(void **state) {
  (void)state;
  static const char *const formats[] = {"MONO8", "MONO16", "RGB8"};
  for (int i = 0; i < DRAWINGS; i++) {
    enum placido_format format = (enum placido_format)(i % 3);
    placido_frame frame = drawn(drawings[i].draw, WIDTH, HEIGHT, format);
    placido_error err = {0};
    int status = find(&frame, &err);
    case_refused(status, PLACIDO_QUALITY, &err, "", "%s, %s", drawings[i].name, formats[format]);
    placido_frame_free(&frame);
  }
}

static void frames_of_any_size_are_refused(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {1, 512},  {640, 1}, {2, 2},   {3, 65536}, {16, 16},
                                 {17, 31}, {4096, 2}, {7, 9},   {101, 103}};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    placido_frame frame = drawn(strong_noise, sizes[i][0], sizes[i][1], PLACIDO_MONO8);
    placido_error err = {0};
    int status = find(&frame, &err);
    case_refused(status, PLACIDO_QUALITY, &err, "", "noise, %d by %d", sizes[i][0], sizes[i][1]);
    placido_frame_free(&frame);
  }
}

/* Whichever way the noise falls. */
static uint64_t seed;
static double seeded_noise(int x, int y) {
  return MIDDLE + 40 * placido_random_normal(seed, (uint64_t)y, (uint64_t)x);
}

static void no_noise_is_taken_for_mires(void **state) {
  (void)state;
  placido_error err = {0};
  for (seed = 100; seed < 110; seed++) {
    placido_frame frame = drawn(seeded_noise, WIDTH / 2, HEIGHT / 2, PLACIDO_MONO8);
    if (find(&frame, &err) != PLACIDO_QUALITY) {
      fail_msg("noise of seed %d is taken for mires", (int)seed);
    }
    placido_frame_free(&frame);
  }
  case_refused(err.status, PLACIDO_QUALITY, &err, "", "noise, 10 frames");
}

static void invert(placido_frame *frame) {
  for (size_t i = 0; i < frame->stride_bytes * (size_t)frame->height_px; i++) {
    frame->data[i] = (uint8_t)(255 - frame->data[i]);
  }
}

/* Out of focus: beyond the mires' own period of 8 to 16 px nothing of them is left. */
static void blur(placido_frame *frame) {
  const int width = frame->width_px, height = frame->height_px;
  placido_image image;
  assert_int_equal(placido_image_new(&image, width, height, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < width * height; i++) {
    image.data[i] = frame->data[(size_t)(i / width) * frame->stride_bytes + (size_t)(i % width)];
  }
  assert_int_equal(placido_cv_blur(&image, 10, 10, NULL), PLACIDO_OK);
  for (int i = 0; i < width * height; i++) {
    frame->data[(size_t)(i / width) * frame->stride_bytes + (size_t)(i % width)] =
      (uint8_t)(image.data[i] + 0.5f);
  }
  placido_image_free(&image);
}

/* Real mires that cannot be what the instrument has: dark for bright, which would shift every
 * number by one, and blurred away. */
static void spoilt_mires_are_refused(void **state) {
  (void)state;
  static const char *const samples[] = {"normal", "keratoconus", "irregular-lid"};
  for (int i = 0; i < 6; i++) {
    char path[1024];
    placido_instrument instrument;
    placido_frame frame = {0};
    placido_error err = {0};
    snprintf(path, sizeof path, "%s/samples/%s.instrument.json", PLACIDO_TEST_DATA, samples[i / 2]);
    assert_int_equal(placido_instrument_load(&instrument, path, NULL, NULL), PLACIDO_OK);
    snprintf(path, sizeof path, "%s/samples/%s.png", PLACIDO_TEST_DATA, samples[i / 2]);
    assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
    (i % 2 ? blur : invert)(&frame);
    int status = find_with(&frame, &instrument, &err);
    case_refused(status, PLACIDO_QUALITY, &err, "", "%s, %s", samples[i / 2],
                 i % 2 ? "blurred by 10 px" : "inverted");
    placido_frame_free(&frame);
  }
}

/* A recording of nothing but such frames: one of them is chosen, as one has to be, with a score
 * that is a number, and is refused for what it shows. */
static void a_recording_without_mires_is_refused(void **state) {
  static const drawing frames[] = {black, white, salt_and_pepper, fine_checker};
  char *path = scratch_path(state, "session"), address[600];
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  placido_session_writer *writer;
  placido_error err = {0};
  assert_int_equal(placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, &err),
                   PLACIDO_OK);
  for (int i = 0; i < 4; i++) {
    placido_frame frame = drawn(frames[i], WIDTH / 2, HEIGHT / 2, PLACIDO_MONO8);
    double score;
    frame.t_ns = i * 40000000;
    frame.seq = (uint64_t)i;
    assert_int_equal(placido_frame_score(&score, &frame, NULL), PLACIDO_OK);
    assert_true(score >= 0 && score <= 1); /* of full scale a pixel */
    assert_int_equal(placido_session_writer_append(writer, &frame, NULL, NULL), PLACIDO_OK);
    placido_frame_free(&frame);
  }
  assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
  snprintf(address, sizeof address, "replay:%s?speed=0", path);
  placido_device *device;
  placido_frame chosen = {0};
  placido_choice choice;
  if (placido_device_open(&device, address, NULL, &err) != PLACIDO_OK ||
      placido_frame_choose(&chosen, &choice, device, -1, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  assert_int_equal(choice.frames, 4);
  int status = find(&chosen, &err);
  case_refused(status, PLACIDO_QUALITY, &err, "", "the best of 4 frames without mires");
  placido_device_close(device);
  placido_frame_free(&chosen);
  free(path);
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Images: frames without mires"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(frames_without_mires_are_refused),
    cmocka_unit_test(frames_of_any_size_are_refused),
    cmocka_unit_test(no_noise_is_taken_for_mires),
    cmocka_unit_test(spoilt_mires_are_refused),
    cmocka_unit_test_setup_teardown(a_recording_without_mires_is_refused, scratch_setup,
                                    scratch_teardown),
    cmocka_unit_test(the_table_is_good)};
  return cmocka_run_group_tests_name("stability_images_frames", tests, NULL, NULL);
}
