/* A replayed session gives its frames in order and in time, round after round, past its damage. */
#include "base/file.h"
#include "base/memory.h"
#include "tests/base/recording.h"
#include "tests/base/scratch.h"

#include <placido/device.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 5, WIDTH = 32, HEIGHT = 24 };
/* Between two frames of a recording. */
static const int64_t step_ns = 40000007;

static int64_t clock_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static char *record(void **state) {
  char *path = scratch_path(state, "a.session");
  recording_make(path, FRAMES, PLACIDO_MONO16, 12, WIDTH, HEIGHT);
  return path;
}

/* Opens the recording, sets its controls and starts it. */
static placido_device *start(const char *path, double speed, double loop) {
  placido_device *device;
  placido_error err = {0};
  if (placido_device_open(&device, path, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  assert_int_equal(placido_device_set(device, "speed", speed, NULL), PLACIDO_OK);
  assert_int_equal(placido_device_set(device, "loop", loop, NULL), PLACIDO_OK);
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  return device;
}

static void frames_come_in_order_and_again_after_a_start(void **state) {
  char *path = record(state);
  placido_device *device = start(path, 0, 0);
  placido_frame frame = {0};
  for (int round = 0; round < 3; round++) {
    for (int i = 0; i < FRAMES - round; i++) {
      assert_int_equal(placido_device_next(device, &frame, 0, NULL), PLACIDO_OK);
      recording_assert_frame(&frame, i, PLACIDO_MONO16, 12, WIDTH, HEIGHT);
      assert_int_equal(frame.t_ns, 5000000123 + i * step_ns);
      assert_int_equal(frame.seq, 1000 + i);
    }
    if (round == 0) {
      assert_int_equal(placido_device_next(device, &frame, 0, NULL), PLACIDO_END);
    }
    assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
    assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  }
  placido_frame_free(&frame);
  placido_device_close(device);
  free(path);
}

static void the_session_tells_of_itself(void **state) {
  char *path = scratch_path(state, "a.session");
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  strcpy(info.eye, "OD");
  strcpy(info.serial, "17");
  info.axis_z_mm = 0.25;
  info.axis_z_sigma_mm = 0.01;
  placido_session_writer *writer;
  placido_frame frame = {0};
  assert_int_equal(
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL), PLACIDO_OK);
  recording_fill(&frame, 0, PLACIDO_MONO8, 8, 16, 16);
  assert_int_equal(placido_session_writer_append(writer, &frame, NULL, NULL), PLACIDO_OK);
  assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  placido_device *device = start(path, 0, 0);
  const placido_device_info *told = placido_device_info_get(device);
  assert_string_equal(told->eye, "OD");
  assert_string_equal(told->serial, "17");
  assert_true(told->axis_z_mm == 0.25 && told->axis_z_sigma_mm == 0.01);
  assert_non_null(strstr(told->instrument_path, "a.session/instrument.json"));
  placido_device_close(device);
  free(path);
}

static void rounds_go_on_in_time_and_number(void **state) {
  char *path = record(state);
  placido_device *device = start(path, 0, 1);
  placido_frame frame = {0};
  int64_t last_t_ns = 0;
  for (int i = 0; i < 3 * FRAMES + 1; i++) {
    assert_int_equal(placido_device_next(device, &frame, 0, NULL), PLACIDO_OK);
    recording_assert_frame(&frame, i % FRAMES, PLACIDO_MONO16, 12, WIDTH, HEIGHT);
    assert_int_equal(frame.seq, 1000 + i);
    assert_true(i == 0 || frame.t_ns - last_t_ns >= 40000000);
    last_t_ns = frame.t_ns;
  }
  placido_frame_free(&frame);
  placido_device_close(device);
  free(path);
}

static void frames_wait_for_their_time(void **state) {
  char *path = record(state);
  placido_device *device = start(path, 2, 0);
  placido_frame frame = {0};
  assert_int_equal(placido_device_next(device, &frame, 1000, NULL), PLACIDO_OK);
  int64_t begin_ns = clock_ns();
  for (int i = 1; i < FRAMES; i++) {
    assert_int_equal(placido_device_next(device, &frame, 1000, NULL), PLACIDO_OK);
  }
  /* The clock was started within the first call, so what is left of it here may be shorter by
   * that call's copying: far less than a quarter of a step. How long it takes beyond, a busy
   * machine decides. */
  assert_true(clock_ns() - begin_ns >= (FRAMES - 1) * step_ns / 2 - step_ns / 4);
  placido_frame_free(&frame);
  placido_device_close(device);
  free(path);
}

static void a_deadline_passes_and_the_frame_is_not_lost(void **state) {
  char *path = record(state);
  placido_device *device = start(path, 0.4, 0); /* a frame every 100 ms */
  placido_frame frame = {0};
  int timeouts = 0, got = 0, status;
  while ((status = placido_device_next(device, &frame, 10, NULL)) != PLACIDO_END) {
    if (status == PLACIDO_TIMEOUT) {
      timeouts++;
    } else {
      assert_int_equal(status, PLACIDO_OK);
      recording_assert_frame(&frame, got++, PLACIDO_MONO16, 12, WIDTH, HEIGHT);
    }
  }
  assert_int_equal(got, FRAMES);
  assert_true(timeouts >= FRAMES - 1);
  placido_frame_free(&frame);
  placido_device_close(device);
  free(path);
}

/* Turns one bit in `count` places of the middle part of the recording's video. */
static void damage(void **state, size_t count, double from, double to) {
  char *path = scratch_path(state, "a.session/frames.mkv"), *bytes;
  size_t size;
  assert_int_equal(placido_file_read(&bytes, &size, path, 0, NULL), PLACIDO_OK);
  for (size_t i = 0; i < count; i++) {
    double share = from + (to - from) * (double)i / (double)count;
    bytes[(size_t)((double)size * share)] ^= 4;
  }
  free(path);
  path = scratch_write(state, "a.session/frames.mkv", bytes, size);
  placido_memory_free(bytes);
  free(path);
}

static void a_damaged_frame_is_told_in_its_turn(void **state) {
  char *path = record(state);
  damage(state, 1, 0.5, 0.5);
  placido_device *device = start(path, 0, 0);
  placido_frame frame = {0};
  placido_error err = {0};
  int turn = 0, damaged = 0, status;
  while ((status = placido_device_next(device, &frame, 0, &err)) != PLACIDO_END) {
    if (status == PLACIDO_INPUT) {
      damaged++;
    } else {
      assert_int_equal(status, PLACIDO_OK);
      recording_assert_frame(&frame, turn, PLACIDO_MONO16, 12, WIDTH, HEIGHT);
    }
    turn++;
  }
  assert_int_equal(turn, FRAMES);
  assert_int_equal(damaged, 1);
  assert_non_null(strstr(err.text, "1 were damaged"));
  placido_frame_free(&frame);
  placido_device_close(device);
  free(path);
}

static void a_round_that_opens_with_damage_joins_the_last_one(void **state) {
  char *path = record(state);
  damage(state, 1, 0.15, 0.15);
  placido_device *device = start(path, 0, 1);
  placido_frame frame = {0};
  int64_t last_ns = INT64_MIN;
  int damaged = 0;
  for (int i = 0; i < 3 * FRAMES; i++) {
    int status = placido_device_next(device, &frame, 0, NULL);
    if (status == PLACIDO_INPUT) {
      assert_int_equal(i % FRAMES, 0);
      damaged++;
      continue;
    }
    assert_int_equal(status, PLACIDO_OK);
    assert_true(frame.t_ns > last_ns);
    last_ns = frame.t_ns;
  }
  assert_int_equal(damaged, 3);
  placido_frame_free(&frame);
  placido_device_close(device);
  free(path);
}

static void a_loop_over_nothing_but_damage_ends(void **state) {
  char *path = record(state);
  damage(state, 2 * FRAMES, 0.1, 0.95);
  placido_device *device = start(path, 0, 1);
  placido_frame frame = {0};
  placido_error err = {0};
  for (int i = 0; i < FRAMES; i++) {
    assert_int_equal(placido_device_next(device, &frame, 0, &err), PLACIDO_INPUT);
  }
  assert_int_equal(placido_device_next(device, &frame, 0, &err), PLACIDO_END);
  assert_non_null(strstr(err.text, "5 were damaged"));
  placido_frame_free(&frame);
  placido_device_close(device);
  free(path);
}

static void every_allocation_may_fail(void **state) {
  char *path = record(state);
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_device *device;
    placido_frame frame = {0};
    placido_memory_fail_at(n);
    status = placido_device_open(&device, path, NULL, NULL);
    if (!status) {
      assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
      status = placido_device_next(device, &frame, 0, NULL);
    }
    placido_memory_fail_at(0);
    placido_frame_free(&frame);
    placido_device_close(device);
  }
  assert_int_equal(status, PLACIDO_OK);
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(frames_come_in_order_and_again_after_a_start),
      TEST(the_session_tells_of_itself),
      TEST(rounds_go_on_in_time_and_number),
      TEST(frames_wait_for_their_time),
      TEST(a_deadline_passes_and_the_frame_is_not_lost),
      TEST(a_damaged_frame_is_told_in_its_turn),
      TEST(a_round_that_opens_with_damage_joins_the_last_one),
      TEST(a_loop_over_nothing_but_damage_ends),
      TEST(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
