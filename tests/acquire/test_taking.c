/* Taking frames: what is recorded, when the light is on, and that it is off in every way out. The
 * devices, the guide and the session's writer are scripts: this file defines their functions
 * itself. */
#include "acquire/taking.h"
#include "tests/acquire/rings.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = 64, STEPS_MAX = 64, EVENTS_MAX = 64 };
#define FRAME_NS 10000000LL /* 100 frames a second */

/* What one call of next gives. */
struct step {
  int status;
  int contrast;  /* of the picture, grey levels */
  unsigned wish; /* of who looks on, with this frame */
  bool pedal;    /* pressed before it */
};

/* Camera, light and pedal are one script; `role` tells which one a pointer is. */
struct placido_device {
  enum { CAMERA, LIGHT, PEDAL } role;
};

/* The eye is ready where the contrast is 50 and more, which gives the score 0.5. */
struct placido_guide {
  int looks;
};

struct placido_session_writer {
  uint64_t seqs[STEPS_MAX];
  int frames;
  char events[EVENTS_MAX][200];
  int event_count;
  bool is_closed;
};

static struct placido_device camera = {CAMERA}, light = {LIGHT}, pedal = {PEDAL};

static struct {
  struct step steps[STEPS_MAX];
  int count, next;
  enum placido_format format;
  double rate_hz, speed; /* controls; NaN: there is none */
  int light, light_fails_at; /* its level; the n-th switching fails, 0: none */
  int switchings, lit_frames;
  bool is_started, pedal_pressed, is_waiting;
  int append_fails_at; /* the n-th append; 0: none */
  struct placido_session_writer writer;
  placido_session_info info;
} script;

/* A camera of 100 frames a second that gives `count` frames and ends. */
static void reset(int count) {
  memset(&script, 0, sizeof script);
  script.count = count;
  script.rate_hz = 100.0;
  script.speed = NAN;
}

int placido_device_start(placido_device *device, placido_error *err) {
  (void)err;
  if (device->role == CAMERA) {
    script.is_started = true;
  }
  return PLACIDO_OK;
}

int placido_device_stop(placido_device *device, placido_error *err) {
  (void)err;
  if (device->role == CAMERA) {
    script.is_started = false;
  }
  return PLACIDO_OK;
}

bool placido_device_is_waiting(const placido_device *device) {
  (void)device;
  return script.is_waiting;
}

int placido_device_get(placido_device *device, const char *control, double *value,
                       placido_error *err) {
  *value = 0.0;
  if (device->role == LIGHT && strcmp(control, "light") == 0) {
    *value = script.light;
  } else if (device->role == CAMERA && strcmp(control, "frame_rate_hz") == 0) {
    *value = script.rate_hz;
  } else if (device->role == CAMERA && strcmp(control, "speed") == 0) {
    *value = script.speed;
  } else {
    return placido_error_set(err, PLACIDO_INPUT, "no such control");
  }
  return PLACIDO_OK;
}

int placido_device_set(placido_device *device, const char *control, double value,
                       placido_error *err) {
  assert_int_equal(device->role, LIGHT);
  assert_string_equal(control, "light");
  if (script.light_fails_at > 0 && ++script.switchings >= script.light_fails_at) {
    return placido_error_set(err, PLACIDO_GONE, "scripted loss of the light");
  }
  script.light = (int)value;
  return PLACIDO_OK;
}

int placido_device_event(placido_device *device, placido_event *event, int timeout_ms,
                         placido_error *err) {
  assert_int_equal(device->role, PEDAL);
  assert_int_equal(timeout_ms, 0);
  if (!script.pedal_pressed) {
    return placido_error_set(err, PLACIDO_TIMEOUT, "no event");
  }
  script.pedal_pressed = false;
  *event = (placido_event){.t_ns = 77, .seq = 1, .name = "pedal", .value = 1};
  return PLACIDO_OK;
}

int placido_device_next(placido_device *device, placido_frame *frame, int timeout_ms,
                        placido_error *err) {
  (void)timeout_ms;
  assert_int_equal(device->role, CAMERA);
  assert_true(script.is_started);
  if (script.next == script.count) {
    return placido_error_set(err, PLACIDO_END, "scripted end");
  }
  const int index = script.next++;
  const struct step *step = &script.steps[index];
  script.pedal_pressed = step->pedal;
  script.is_waiting = step->status == PLACIDO_TIMEOUT;
  if (step->status != PLACIDO_OK) {
    return placido_error_set(err, step->status, "scripted failure");
  }
  assert_int_equal(placido_frame_resize(frame, SIDE, SIDE, script.format, err), PLACIDO_OK);
  rings_draw(frame, step->contrast);
  frame->seq = (uint64_t)index;
  frame->t_ns = 1000000000LL + index * FRAME_NS;
  frame->flags = 0;
  script.lit_frames += script.light;
  return PLACIDO_OK;
}

int placido_session_writer_create(placido_session_writer **writer, const char *path,
                                  const placido_session_info *info, const char *instrument_path,
                                  placido_error *err) {
  (void)path;
  (void)instrument_path;
  (void)err;
  script.info = *info;
  *writer = &script.writer;
  return PLACIDO_OK;
}

int placido_session_writer_append(placido_session_writer *writer, const placido_frame *frame,
                                  const placido_frame_info *frame_info, placido_error *err) {
  (void)frame_info;
  if (script.append_fails_at > 0 && writer->frames + 1 >= script.append_fails_at) {
    return placido_error_set(err, PLACIDO_SYSTEM, "scripted full disk");
  }
  writer->seqs[writer->frames++] = frame->seq;
  return PLACIDO_OK;
}

int placido_session_writer_event(placido_session_writer *writer, int64_t t_ns, const char *name,
                                 const char *text, placido_error *err) {
  (void)err;
  assert_true(writer->event_count < EVENTS_MAX);
  snprintf(writer->events[writer->event_count++], sizeof writer->events[0], "%lld %s: %s",
           (long long)t_ns, name, text ? text : "-");
  return PLACIDO_OK;
}

int placido_session_writer_close(placido_session_writer *writer, placido_error *err) {
  (void)err;
  writer->is_closed = true;
  return PLACIDO_OK;
}

int placido_guide_look(placido_guide *guide, const placido_frame *frame,
                       placido_guidance *guidance, placido_error *err) {
  (void)err;
  const int contrast = script.steps[frame->seq].contrast;
  guide->looks++;
  *guidance = (placido_guidance){
      .state = contrast >= 50 ? PLACIDO_GUIDE_READY : PLACIDO_GUIDE_ALIGN,
      .score = contrast / 100.0};
  return PLACIDO_OK;
}

static unsigned wish(void *user, const placido_taking_view *view) {
  (void)user;
  return view->frame && view->frame->data ? script.steps[view->frame->seq].wish : 0;
}

static const placido_taking_settings plain = {.device = &camera,
                                              .path = "nowhere.session",
                                              .instrument_path = "",
                                              .chooses_codec = true,
                                              .look = wish};

/* With light and pedal: bursts of three, after one frame of warming up. */
static placido_taking_settings bursts(void) {
  placido_taking_settings settings = plain;
  settings.light = &light;
  settings.pedal = &pedal;
  settings.trigger = (placido_trigger_settings){
      .sources = PLACIDO_TRIGGER_KEY | PLACIDO_TRIGGER_PEDAL, .burst = 3, .warm_up = 1};
  return settings;
}

static int run(const placido_taking_settings *settings, placido_taking_result *result,
               placido_error *err) {
  const int status = placido_taking_run(result, settings, err);
  assert_false(script.is_started);
  assert_true(script.light == 0 || script.light_fails_at > 0);
  assert_int_equal(result->is_begun, script.writer.is_closed);
  return status;
}

static void assert_event(int index, const char *text) {
  assert_true(index < script.writer.event_count);
  assert_string_equal(script.writer.events[index], text);
}

static bool has_event(const char *part) {
  bool found = false;
  for (int i = 0; i < script.writer.event_count; i++) {
    found = found || strstr(script.writer.events[i], part);
  }
  return found;
}

static void test_every_frame_is_recorded(void **state) {
  (void)state;
  placido_taking_result result;
  reset(10);
  assert_int_equal(run(&plain, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.writer.frames, 10);
  for (int i = 0; i < 10; i++) {
    assert_int_equal(script.writer.seqs[i], i);
  }
  assert_int_equal(script.writer.event_count, 0);
  assert_int_equal(result.summary.written, 10);
  assert_true(script.info.rate_hz == 100.0);
  assert_int_equal(script.info.bits, 8);
}

/* Two frames tell it, wherever the device does not; one frame alone is recorded all the same. */
static void test_the_rate_is_found(void **state) {
  (void)state;
  placido_taking_result result;
  for (int count = 1; count <= 3; count++) {
    reset(count);
    script.rate_hz = NAN;
    assert_int_equal(run(&plain, &result, NULL), PLACIDO_OK);
    assert_int_equal(script.writer.frames, count);
    assert_int_equal(script.writer.seqs[count - 1], count - 1);
    assert_true(count == 1 ? isnan(script.info.rate_hz) : script.info.rate_hz == 100.0);
  }
}

static void test_the_codec_follows_the_rate(void **state) {
  (void)state;
  placido_taking_result result;
  placido_taking_settings asked = plain;
  asked.chooses_codec = false;
  asked.info.codec = PLACIDO_CODEC_RAW;
  reset(2);
  run(&plain, &result, NULL);
  assert_int_equal(result.codec, PLACIDO_CODEC_FFV1); /* 0.4 MB/s */
  reset(2);
  script.rate_hz = 1e9;
  run(&plain, &result, NULL);
  assert_int_equal(result.codec, PLACIDO_CODEC_FFVHUFF);
  reset(2);
  script.rate_hz = 1e9;
  script.speed = 0; /* a replay that waits */
  run(&plain, &result, NULL);
  assert_int_equal(result.codec, PLACIDO_CODEC_FFV1);
  reset(2);
  run(&asked, &result, NULL);
  assert_int_equal(script.info.codec, PLACIDO_CODEC_RAW);
}

static void test_it_ends_when_asked(void **state) {
  (void)state;
  placido_taking_result result;
  placido_taking_settings settings = plain;
  reset(20);
  settings.frames = 7;
  assert_int_equal(run(&settings, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.writer.frames, 7);
  reset(20);
  settings.frames = 0;
  settings.for_s = 0.05; /* frames 0 to 4, at 0 to 40 ms */
  assert_int_equal(run(&settings, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.writer.frames, 5);
  reset(20);
  script.steps[3].wish = PLACIDO_TAKING_END;
  assert_int_equal(run(&plain, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.writer.frames, 4);
}

/* The light is on from the frame that asked to the last one of the burst, and the best is the one
 * of most contrast. Frames outside bursts are not missing. */
static void test_a_burst(void **state) {
  (void)state;
  placido_taking_result result;
  const placido_taking_settings settings = bursts();
  reset(12);
  script.steps[2].wish = PLACIDO_TAKING_FIRE;
  script.steps[5].contrast = 90;
  script.steps[4].contrast = script.steps[6].contrast = 40;
  assert_int_equal(run(&settings, &result, NULL), PLACIDO_OK);
  const uint64_t expected[] = {4, 5, 6};
  assert_int_equal(script.writer.frames, 3);
  assert_memory_equal(script.writer.seqs, expected, sizeof expected);
  assert_int_equal(script.lit_frames, 4); /* 3 to 6 */
  assert_int_equal(result.bursts, 1);
  assert_int_equal(result.summary.missing, 0);
  assert_event(0, "1020000000 trigger: key");
  assert_event(1, "1020000000 light on: -");
  assert_event(2, "1040000000 burst begins: index 0");
  assert_event(3, "1060000000 burst ends: index 3");
  assert_non_null(strstr(script.writer.events[4], "1060000000 best frame: index "));
  assert_event(5, "1060000000 light off: -");
  assert_int_equal(script.writer.event_count, 6);
}

static void test_the_pedal_starts_bursts_until_there_were_enough(void **state) {
  (void)state;
  placido_taking_result result;
  placido_taking_settings settings = bursts();
  settings.trigger.bursts = 2;
  reset(30);
  script.steps[1].pedal = script.steps[3].pedal = script.steps[10].pedal = true;
  assert_int_equal(run(&settings, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.writer.frames, 6);
  assert_int_equal(result.bursts, 2);
  assert_true(script.next < 20);
  assert_true(has_event("77 pedal: pressed"));
  assert_true(has_event("trigger: pedal"));
}

/* Ready for 30 ms, from frame 5 to 8; the light comes on, and one frame later the burst. */
static void test_a_ready_eye_starts_a_burst(void **state) {
  (void)state;
  placido_taking_result result;
  placido_taking_settings settings = bursts();
  placido_guide guide = {0};
  settings.guide = &guide;
  settings.trigger.sources = PLACIDO_TRIGGER_AUTO;
  settings.trigger.score_min = 0.6;
  settings.trigger.hold_s = 0.03;
  settings.trigger.rest_s = 1.0;
  reset(20);
  script.speed = 0; /* a source that waits has every frame judged */
  for (int i = 0; i < 20; i++) {
    script.steps[i].contrast = i < 3 ? 90 : i < 5 ? 40 : 70;
  }
  script.steps[3].contrast = 55; /* ready, and not good enough */
  script.steps[11].contrast = 80;
  assert_int_equal(run(&settings, &result, NULL), PLACIDO_OK);
  const uint64_t expected[] = {10, 11, 12};
  assert_int_equal(script.writer.frames, 3);
  assert_memory_equal(script.writer.seqs, expected, sizeof expected);
  assert_int_equal(guide.looks, 20);
  assert_true(has_event("1080000000 trigger: auto"));
  assert_true(has_event("best frame: index 1, sequence 11, score 0.8000"));
}

/* In the middle of a burst, with the light on: however it ends, it is dark then, and what came
 * before is an orderly session. */
static void test_the_light_is_off_in_every_way_out(void **state) {
  (void)state;
  static const int statuses[] = {PLACIDO_GONE, PLACIDO_SYSTEM, PLACIDO_MEMORY, PLACIDO_END,
                                 PLACIDO_OK};
  const placido_taking_settings settings = bursts();
  for (size_t i = 0; i < sizeof statuses / sizeof *statuses; i++) {
    placido_taking_result result;
    placido_error err = {0};
    reset(20);
    script.steps[2].wish = PLACIDO_TAKING_FIRE;
    script.steps[5].status = statuses[i];
    script.steps[5].wish = PLACIDO_TAKING_END; /* comes through where the status is OK */
    const int status = run(&settings, &result, &err);
    assert_int_equal(status, statuses[i] == PLACIDO_END ? PLACIDO_OK : statuses[i]);
    assert_true(script.lit_frames > 0);
    assert_int_equal(script.writer.frames, statuses[i] == PLACIDO_OK ? 2 : 1);
    assert_true(has_event("burst ends"));
    assert_true(has_event("light off"));
    assert_int_equal(has_event("device lost: scripted failure"), status == PLACIDO_GONE);
    assert_int_equal(has_event("recording failed: scripted failure"),
                     status == PLACIDO_SYSTEM || status == PLACIDO_MEMORY);
  }
}

static void test_the_light_is_off_after_a_full_disk(void **state) {
  (void)state;
  placido_taking_result result;
  placido_taking_settings settings = plain;
  placido_error err = {0};
  settings.light = &light;
  reset(20);
  script.speed = 0; /* waits for the writer, so that it hears of the failure */
  script.append_fails_at = 3;
  settings.queue_bytes = 1;
  assert_int_equal(run(&settings, &result, &err), PLACIDO_SYSTEM);
  assert_string_equal(err.text, "scripted full disk");
  assert_int_equal(result.summary.written, 2);
  assert_true(script.lit_frames > 0);
}

/* Without bursts the light is on for the recording. */
static void test_the_light_is_on_for_a_recording(void **state) {
  (void)state;
  placido_taking_result result;
  placido_taking_settings settings = plain;
  settings.light = &light;
  reset(5);
  assert_int_equal(run(&settings, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.lit_frames, 4); /* all but the first, which says how to record */
}

/* A light that cannot be switched off is told whatever else has failed. */
static void test_a_lost_light_is_told(void **state) {
  (void)state;
  placido_taking_result result;
  placido_error err = {0};
  const placido_taking_settings settings = bursts();
  reset(20);
  script.steps[2].wish = PLACIDO_TAKING_FIRE;
  script.light_fails_at = 2;
  assert_int_equal(run(&settings, &result, &err), PLACIDO_GONE);
  assert_non_null(strstr(err.text, "switched OFF"));
  reset(20);
  script.steps[2].wish = PLACIDO_TAKING_FIRE;
  script.steps[4].status = PLACIDO_SYSTEM;
  script.light_fails_at = 2;
  assert_int_equal(run(&settings, &result, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "scripted failure; and the light cannot be switched OFF"));
}

static void test_undecodable_frames_are_passed_over(void **state) {
  (void)state;
  placido_taking_result result;
  reset(6);
  script.steps[2].status = script.steps[4].status = PLACIDO_INPUT;
  assert_int_equal(run(&plain, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.writer.frames, 4);
  assert_int_equal(result.undecodable, 2);
  assert_int_equal(result.summary.missing, 2);
  assert_true(has_event("frame lost: scripted failure"));
}

static void test_an_unplugged_camera_is_told(void **state) {
  (void)state;
  placido_taking_result result;
  reset(8);
  script.steps[3].status = script.steps[4].status = PLACIDO_TIMEOUT;
  assert_int_equal(run(&plain, &result, NULL), PLACIDO_OK);
  assert_int_equal(script.writer.frames, 6);
  assert_true(has_event("1020000000 device unplugged"));
  assert_true(has_event("1050000000 device back"));
}

static void test_colour_is_refused(void **state) {
  (void)state;
  placido_taking_result result;
  placido_error err = {0};
  reset(3);
  script.format = PLACIDO_RGB8;
  assert_int_equal(run(&plain, &result, &err), PLACIDO_INPUT);
  assert_false(result.is_begun);
  assert_non_null(strstr(err.text, "colour"));
}

static void test_no_frame_at_all(void **state) {
  (void)state;
  placido_taking_result result;
  reset(0);
  assert_int_equal(run(&plain, &result, NULL), PLACIDO_OK);
  assert_false(result.is_begun);
  assert_int_equal(result.seen, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_every_frame_is_recorded),
      cmocka_unit_test(test_the_rate_is_found),
      cmocka_unit_test(test_the_codec_follows_the_rate),
      cmocka_unit_test(test_it_ends_when_asked),
      cmocka_unit_test(test_a_burst),
      cmocka_unit_test(test_the_pedal_starts_bursts_until_there_were_enough),
      cmocka_unit_test(test_a_ready_eye_starts_a_burst),
      cmocka_unit_test(test_the_light_is_off_in_every_way_out),
      cmocka_unit_test(test_the_light_is_off_after_a_full_disk),
      cmocka_unit_test(test_the_light_is_on_for_a_recording),
      cmocka_unit_test(test_a_lost_light_is_told),
      cmocka_unit_test(test_undecodable_frames_are_passed_over),
      cmocka_unit_test(test_an_unplugged_camera_is_told),
      cmocka_unit_test(test_colour_is_refused),
      cmocka_unit_test(test_no_frame_at_all),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
