/* A script of faults is read strictly, and a replay does what it says, the same each time. */
#include "base/memory.h"
#include "drivers/replay/faults.h"
#include "tests/base/recording.h"
#include "tests/base/scratch.h"

#include <placido/device.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 10, WIDTH = 32, HEIGHT = 24, FIRST_SEQ = 1000, STEP_MS = 40 };

static int64_t clock_ms(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static void a_script_is_read(void **state) {
  (void)state;
  static const char text[] = "# a bad day\n"
                             "at frame 12 drop 3\n"
                             "\n"
                             "  at 2.5s   truncate   # once\r\n"
                             "at frame 0 delay 200ms\n"
                             "at 1500ms disconnect 2s\n"
                             "at frame 99 disconnect";
  placido_faults faults;
  placido_error err = {0};
  if (placido_faults_parse(&faults, text, sizeof text - 1, "bad.faults", &err)) {
    fail_msg("%s", err.text);
  }
  static const placido_fault expected[] = {
      {PLACIDO_FAULT_DROP, false, 12, 3, 0},
      {PLACIDO_FAULT_TRUNCATE, true, 2500000000, 1, 0},
      {PLACIDO_FAULT_DELAY, false, 0, 1, 200000000},
      {PLACIDO_FAULT_DISCONNECT, true, 1500000000, 1, 2000000000},
      {PLACIDO_FAULT_DISCONNECT, false, 99, 1, INT64_MAX},
  };
  assert_int_equal(faults.count, sizeof expected / sizeof expected[0]);
  for (size_t i = 0; i < faults.count; i++) {
    const placido_fault *got = &faults.list[i], *want = &expected[i];
    assert_int_equal(got->kind, want->kind);
    assert_int_equal(got->is_by_time, want->is_by_time);
    assert_int_equal(got->at, want->at);
    assert_int_equal(got->frames, want->frames);
    assert_int_equal(got->duration_ns, want->duration_ns);
  }
}

static void a_wrong_script_is_refused_with_its_line(void **state) {
  (void)state;
  static const struct {
    const char *text, *message;
  } cases[] = {
      {"at frame 1 drop\nin frame 2 drop\n", "bad.faults:2: \"in\": a line is"},
      {"at", "bad.faults:1: \"at\": a line is"},
      {"at frame", "\"\" is no frame's number"},
      {"at frame -1 drop", "\"-1\" is no frame's number"},
      {"at frame 99999999999 drop", "is no frame's number"},
      {"at 2.5 drop", "\"2.5\" is neither \"frame\" nor a time"},
      {"at 1.2.3s drop", "is neither"},
      {"at .s drop", "is neither"},
      {"at 0x10s drop", "is neither"},
      {"at 9999999s drop", "is neither"},
      {"at frame 3", "what goes wrong is missing"},
      {"at frame 3 dorp", "\"dorp\" is not drop, truncate"},
      {"at frame 3 drop 0", "drop \"0\": a number of frames"},
      {"at frame 3 drop 2s", "drop \"2s\": a number of frames"},
      {"at frame 3 delay", "delay \"\": a time was expected"},
      {"at frame 3 delay 3", "delay \"3\": a time was expected"},
      {"at 1s drop 3 4", "\"4\" is one word too many"},
      {"at frame 3 drop 3 4", "\"4\" is one word too many"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    placido_faults faults;
    placido_error err = {0};
    assert_int_equal(
        placido_faults_parse(&faults, cases[i].text, strlen(cases[i].text), "bad.faults", &err),
        PLACIDO_INPUT);
    if (!strstr(err.text, cases[i].message)) {
      fail_msg("\"%s\" gave: %s", cases[i].text, err.text);
    }
    assert_int_equal(faults.count, 0);
  }
  placido_faults faults;
  assert_int_equal(placido_faults_parse(&faults, "at frame 1 dr\0p", 15, "bad", NULL),
                   PLACIDO_INPUT);
}

static void no_more_faults_than_there_is_room_for(void **state) {
  (void)state;
  static const char line[] = "at frame 1 drop\n";
  static char text[(PLACIDO_FAULTS_MAX + 1) * sizeof line];
  for (int i = 0; i <= PLACIDO_FAULTS_MAX; i++) {
    strcat(text, line);
  }
  placido_faults faults;
  placido_error err = {0};
  const size_t room = PLACIDO_FAULTS_MAX * (sizeof line - 1);
  assert_int_equal(placido_faults_parse(&faults, text, room, "long", &err), PLACIDO_OK);
  assert_int_equal(faults.count, PLACIDO_FAULTS_MAX);
  assert_int_equal(placido_faults_parse(&faults, text, strlen(text), "long", &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "long:257: more than 256 faults"));
}

/* A replay of ten frames, 40 ms apart, with a script; `more` are settings beside it. */
static placido_device *open_with(void **state, const char *script, const char *more) {
  char *path = scratch_path(state, "a.session"), uri[1024];
  char *faults = scratch_write(state, "a.faults", script, strlen(script));
  recording_make(path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  snprintf(uri, sizeof uri, "replay:%s?%s&faults=%s", path, more, faults);
  placido_device *device;
  placido_error err = {0};
  if (placido_device_open(&device, uri, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  free(faults);
  free(path);
  return device;
}

/* What comes of a replay, one character a call of next: the frame's last digit, t and c behind it
 * where it is flagged, - a time-out, ? undecodable, ! an error, x gone, . the end. */
static void play(char *told, placido_device *device, int calls, int timeout_ms) {
  placido_frame frame = {0};
  char *out = told;
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  for (int i = 0; i < calls; i++) {
    const int status = placido_device_next(device, &frame, timeout_ms, NULL);
    if (status == PLACIDO_OK) {
      *out++ = (char)('0' + (frame.seq - FIRST_SEQ) % 10);
      if (frame.flags & PLACIDO_FRAME_TRUNCATED) {
        *out++ = 't';
      }
      if (frame.flags & PLACIDO_FRAME_CORRUPT) {
        *out++ = 'c';
      }
      continue;
    }
    *out++ = status == PLACIDO_TIMEOUT  ? '-'
             : status == PLACIDO_INPUT  ? '?'
             : status == PLACIDO_SYSTEM ? '!'
             : status == PLACIDO_GONE   ? 'x'
                                        : '.';
    if (status == PLACIDO_END || status == PLACIDO_GONE) {
      break;
    }
  }
  *out = '\0';
  placido_frame_free(&frame);
}

static void faults_strike_where_the_script_says(void **state) {
  static const struct {
    const char *script, *told;
  } cases[] = {
      {"", "0123456789."},
      {"at frame 2 drop", "013456789."},
      {"at frame 0 drop 3\nat frame 9 drop 5", "345678."},
      {"at frame 0 drop 10", "."},
      {"at 100ms truncate 2", "0123t4t56789."},
      {"at 0s corrupt", "0c123456789."},
      {"at frame 4 truncate\nat frame 4 corrupt", "01234tc56789."},
      {"at frame 4 damage 2", "0123??6789."},
      {"at frame 4 error", "0123!56789."},
      {"at frame 9 disconnect", "012345678x"},
      {"at frame 4 drop\nat frame 4 error", "012356789."},
      {"at frame 20 error", "0123456789."},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    placido_device *device = open_with(state, cases[i].script, "speed=0");
    for (int round = 0; round < 2; round++) {
      char told[64];
      play(told, device, 20, 0);
      assert_string_equal(told, cases[i].told);
      assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
      if (strchr(told, 'x')) {
        break; /* it stays away: there is no second round */
      }
    }
    placido_device_close(device);
    scratch_teardown(state);
    scratch_setup(state);
  }
}

static void what_was_done_is_counted(void **state) {
  placido_device *device = open_with(
      state, "at frame 1 drop 2\nat frame 4 truncate\nat frame 5 corrupt\nat frame 7 damage",
      "speed=0");
  char told[64];
  play(told, device, 20, 0);
  placido_device_statistics counts;
  placido_device_statistics_get(device, &counts);
  assert_int_equal(counts.frames, 7);
  assert_int_equal(counts.dropped, 2);
  assert_int_equal(counts.truncated, 1);
  assert_int_equal(counts.corrupt, 2);
  placido_device_close(device);
}

/* Above the cut and outside the garbled rows all is as it was. */
static void spoiled_frames_look_spoiled(void **state) {
  placido_device *device = open_with(state, "at frame 0 truncate\nat frame 1 corrupt", "speed=0");
  placido_frame frame = {0}, whole = {0};
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  for (int i = 0; i < 2; i++) {
    recording_fill(&whole, i, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
    assert_int_equal(placido_device_next(device, &frame, 0, NULL), PLACIDO_OK);
    const uint8_t *first = frame.data, *last = frame.data + (HEIGHT - 1) * frame.stride_bytes;
    const uint8_t *middle = frame.data + HEIGHT / 3 * frame.stride_bytes;
    const uint8_t *whole_last = whole.data + (HEIGHT - 1) * whole.stride_bytes;
    const uint8_t *whole_middle = whole.data + HEIGHT / 3 * whole.stride_bytes;
    assert_memory_equal(first, whole.data, WIDTH);
    for (int x = 0; x < WIDTH; x++) {
      assert_int_equal(last[x], i == 0 ? 0 : whole_last[x]);
      assert_int_equal(middle[x], i == 0 ? whole_middle[x] : 255 - whole_middle[x]);
    }
  }
  placido_frame_free(&frame);
  placido_frame_free(&whole);
  placido_device_close(device);
}

static void faults_count_on_through_the_rounds(void **state) {
  placido_device *device =
      open_with(state, "at frame 9 drop 2\nat 480ms truncate", "speed=0&loop=1");
  char told[64];
  play(told, device, 14, 0);
  assert_string_equal(told, "01234567812t345"); /* the tenth and the eleventh are lost */
  placido_device_close(device);
}

static void a_loop_of_nothing_but_loss_does_not_hold_up(void **state) {
  placido_device *device = open_with(state, "at frame 0 drop 1000000000", "speed=0&loop=1");
  char told[64];
  play(told, device, 2, 20);
  assert_string_equal(told, "--");
  placido_device_close(device);
}

static void a_delayed_frame_comes_late_and_is_not_lost(void **state) {
  placido_device *device = open_with(state, "at frame 1 delay 150ms", "speed=0");
  char told[64];
  const int64_t begin_ms = clock_ms();
  play(told, device, 40, 30);
  assert_true(clock_ms() - begin_ms >= 149);
  assert_memory_equal(told, "0----", 3); /* how often next is called meanwhile, the machine says */
  assert_string_equal(told + strspn(told, "0-"), "123456789.");
  placido_device_close(device);
}

/* What was recorded meanwhile is lost: 100 ms of frames that are 40 ms apart. */
static void an_unplugged_replay_comes_back_in_its_time(void **state) {
  placido_device *device = open_with(state, "at frame 3 disconnect 100ms", "speed=0");
  placido_frame frame = {0};
  placido_error err = {0};
  char told[64];
  const int64_t begin_ms = clock_ms();
  play(told, device, 20, 0);
  assert_string_equal(told, "012x");
  assert_int_equal(placido_device_next(device, &frame, 0, NULL), PLACIDO_GONE);
  assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
  int status;
  while ((status = placido_device_start(device, &err)) == PLACIDO_GONE) {
    assert_non_null(strstr(err.text, "is unplugged for another 0."));
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(clock_ms() - begin_ms >= 99);
  assert_int_equal(placido_device_next(device, &frame, 0, NULL), PLACIDO_OK);
  assert_int_equal(frame.seq, FIRST_SEQ + 6);
  placido_frame_free(&frame);
  placido_device_close(device);
}

static void the_device_layer_waits_for_it(void **state) {
  placido_device *device = open_with(state, "at frame 3 disconnect 200ms", "speed=0&replug_s=20");
  placido_device_statistics counts;
  char told[64];
  play(told, device, 20, 5000);
  assert_string_equal(told, "01289.");
  placido_device_statistics_get(device, &counts);
  assert_int_equal(counts.replugs, 1);
  assert_int_equal(counts.dropped, 5);
  placido_device_close(device);
}

static void frames_keep_their_time_behind_a_gap(void **state) {
  placido_device *device = open_with(state, "at frame 1 drop 4", "speed=2");
  char told[64];
  const int64_t begin_ms = clock_ms();
  play(told, device, 2, 1000);
  assert_string_equal(told, "05");
  assert_true(clock_ms() - begin_ms >= 5 * STEP_MS / 2 - 1);
  placido_device_close(device);
}

/* As a camera does, unless a speed is asked for. */
static void a_replay_takes_the_time_of_its_recording(void **state) {
  char *path = scratch_path(state, "a.session");
  recording_make(path, 3, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  placido_device *device;
  double speed;
  char told[64];
  assert_int_equal(placido_device_open(&device, path, NULL, NULL), PLACIDO_OK);
  assert_int_equal(placido_device_get(device, "speed", &speed, NULL), PLACIDO_OK);
  assert_true(speed == 1);
  const int64_t begin_ms = clock_ms();
  play(told, device, 4, 1000);
  assert_string_equal(told, "012.");
  assert_true(clock_ms() - begin_ms >= 2 * STEP_MS - 1);
  placido_device_close(device);
  free(path);
}

static void what_cannot_be_read_is_told_before_anything_else(void **state) {
  char *path = scratch_path(state, "a.session"), uri[1024];
  recording_make(path, 1, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  char *faults = scratch_write(state, "a.faults", "at frame 1 explode\n", 19);
  placido_device *device;
  placido_error err = {0};
  snprintf(uri, sizeof uri, "%s?faults=%s", path, faults);
  assert_int_equal(placido_device_open(&device, uri, NULL, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "a.faults:1: \"explode\" is not drop"));
  snprintf(uri, sizeof uri, "%s?faults=%s-not-there", path, faults);
  assert_int_equal(placido_device_open(&device, uri, NULL, &err), PLACIDO_SYSTEM);
  assert_null(device);
  free(faults);
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_script_is_read),
      cmocka_unit_test(a_wrong_script_is_refused_with_its_line),
      cmocka_unit_test(no_more_faults_than_there_is_room_for),
      TEST(faults_strike_where_the_script_says),
      TEST(what_was_done_is_counted),
      TEST(spoiled_frames_look_spoiled),
      TEST(faults_count_on_through_the_rounds),
      TEST(a_loop_of_nothing_but_loss_does_not_hold_up),
      TEST(a_delayed_frame_comes_late_and_is_not_lost),
      TEST(an_unplugged_replay_comes_back_in_its_time),
      TEST(the_device_layer_waits_for_it),
      TEST(frames_keep_their_time_behind_a_gap),
      TEST(a_replay_takes_the_time_of_its_recording),
      TEST(what_cannot_be_read_is_told_before_anything_else),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
