/* The recorder: nothing is lost unseen, whoever is slow and whatever fails. The session's writer is
 * a script: this file defines its functions itself, and says when an append may go on. */
#include "acquire/recorder.h"
#include "base/memory.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = 16, FRAME_BYTES = SIDE * SIDE, FRAMES_MAX = 4096, EVENTS_MAX = 64 };

/* What arrived at the writer. The recorder's thread writes it, and the test reads it after close:
 * joining the thread orders the two. */
struct placido_session_writer {
  uint64_t seqs[FRAMES_MAX];
  uint8_t samples[FRAMES_MAX];
  double exposures_us[FRAMES_MAX];
  int frames;
  char events[EVENTS_MAX][200];
  int event_count;
  bool is_gated;  /* an append waits until the test lets it */
  int fails_at;   /* the append of that number fails; 0: none */
  bool refuses;   /* create fails */
  bool is_closed;
  sem_t began, may_go;
};

static struct placido_session_writer script;

static void reset_script(bool is_gated) {
  script = (struct placido_session_writer){.is_gated = is_gated};
  sem_init(&script.began, 0, 0);
  sem_init(&script.may_go, 0, 0);
}

int placido_session_writer_create(placido_session_writer **writer, const char *path,
                                  const placido_session_info *info, const char *instrument_path,
                                  placido_error *err) {
  (void)path;
  (void)info;
  (void)instrument_path;
  *writer = script.refuses ? NULL : &script;
  return script.refuses ? placido_error_set(err, PLACIDO_SYSTEM, "scripted refusal") : PLACIDO_OK;
}

int placido_session_writer_append(placido_session_writer *writer, const placido_frame *frame,
                                  const placido_frame_info *frame_info, placido_error *err) {
  if (writer->is_gated) {
    sem_post(&writer->began);
    while (sem_wait(&writer->may_go) != 0 && errno == EINTR) {
    }
  }
  if (writer->fails_at > 0 && writer->frames + 1 >= writer->fails_at) {
    return placido_error_set(err, PLACIDO_SYSTEM, "scripted full disk");
  }
  writer->seqs[writer->frames] = frame->seq;
  writer->samples[writer->frames] = frame->data[FRAME_BYTES - 1];
  writer->exposures_us[writer->frames] = frame_info ? frame_info->exposure_us : -1.0;
  writer->frames++;
  return PLACIDO_OK;
}

int placido_session_writer_event(placido_session_writer *writer, int64_t t_ns, const char *name,
                                 const char *text, placido_error *err) {
  (void)err;
  if (writer->event_count < EVENTS_MAX) {
    snprintf(writer->events[writer->event_count++], sizeof writer->events[0], "%lld %s: %s",
             (long long)t_ns, name, text ? text : "-");
  }
  return PLACIDO_OK;
}

int placido_session_writer_close(placido_session_writer *writer, placido_error *err) {
  (void)err;
  if (writer) {
    writer->is_closed = true;
  }
  return PLACIDO_OK;
}

static placido_recorder *open_recorder(size_t queue_bytes) {
  placido_recorder *recorder;
  const placido_session_info info = {.bits = 8};
  placido_error err = {0};
  assert_int_equal(placido_recorder_open(&recorder, "nowhere", &info, "", queue_bytes, &err),
                   PLACIDO_OK);
  return recorder;
}

/* Puts frame number `seq`, whose samples all say so, too. */
static int put(placido_recorder *recorder, placido_frame *frame, uint64_t seq,
               placido_error *err) {
  assert_int_equal(placido_frame_resize(frame, SIDE, SIDE, PLACIDO_MONO8, err), PLACIDO_OK);
  memset(frame->data, (int)(seq & 0xff), FRAME_BYTES);
  frame->seq = seq;
  frame->t_ns = (int64_t)seq * 1000;
  frame->flags = 0;
  const placido_frame_info info = {.exposure_us = (double)seq};
  return placido_recorder_put(recorder, frame, &info, err);
}

static void let_go(int appends) {
  for (int i = 0; i < appends; i++) {
    sem_post(&script.may_go);
  }
}

static void wait_for_append(void) {
  while (sem_wait(&script.began) != 0 && errno == EINTR) {
  }
}

static int count_events(const char *part) {
  int count = 0;
  for (int i = 0; i < script.event_count; i++) {
    count += strstr(script.events[i], part) != NULL;
  }
  return count;
}

static void test_all_arrive_in_order(void **state) {
  (void)state;
  reset_script(false);
  placido_recorder *recorder = open_recorder(0);
  placido_frame frame = {0};
  placido_recorder_summary summary;
  for (uint64_t seq = 10; seq < 1010; seq++) {
    assert_int_equal(put(recorder, &frame, seq, NULL), PLACIDO_OK);
  }
  assert_int_equal(placido_recorder_index(recorder), 1000);
  assert_int_equal(placido_recorder_close(recorder, &summary, NULL), PLACIDO_OK);
  assert_true(script.is_closed);
  assert_int_equal(script.frames, 1000);
  for (int i = 0; i < 1000; i++) {
    assert_int_equal(script.seqs[i], i + 10);
    assert_int_equal(script.samples[i], (i + 10) & 0xff);
    assert_true(script.exposures_us[i] == i + 10);
  }
  assert_int_equal(summary.written, 1000);
  assert_int_equal(summary.dropped, 0);
  assert_int_equal(summary.missing, 0);
  assert_true(summary.seconds == (double)(999 * 1000) * 1e-9);
  assert_int_equal(script.event_count, 0);
  placido_frame_free(&frame);
}

/* Room for three, one of which is being written: the fourth and the following are dropped, as many
 * as there are, and what is written has a gap just there. */
static void test_a_slow_writer_drops_visibly(void **state) {
  (void)state;
  reset_script(true);
  placido_recorder *recorder = open_recorder(3 * FRAME_BYTES);
  placido_frame frame = {0};
  placido_recorder_summary summary;
  put(recorder, &frame, 0, NULL);
  wait_for_append();
  for (uint64_t seq = 1; seq < 10; seq++) {
    assert_int_equal(put(recorder, &frame, seq, NULL), PLACIDO_OK);
  }
  placido_recorder_summary_get(recorder, &summary);
  assert_int_equal(summary.dropped, 7);
  assert_int_equal(summary.queue_most, 2);
  let_go(2);
  wait_for_append(); /* of frame 1 */
  wait_for_append(); /* of frame 2: the two before it have given their room back */
  assert_int_equal(put(recorder, &frame, 10, NULL), PLACIDO_OK);
  let_go(2);
  assert_int_equal(placido_recorder_close(recorder, &summary, NULL), PLACIDO_OK);
  const uint64_t expected[] = {0, 1, 2, 10};
  assert_int_equal(script.frames, 4);
  assert_memory_equal(script.seqs, expected, sizeof expected);
  assert_int_equal(summary.written, 4);
  assert_int_equal(summary.dropped, 7);
  assert_int_equal(summary.missing, 0); /* they came here, and are not the camera's fault */
  assert_int_equal(script.event_count, 1);
  assert_non_null(strstr(script.events[0], "3000 frames dropped: 7, sequence 3 to 9"));
  placido_frame_free(&frame);
}

/* A run of drops that the end cuts off is told as well; one frame has room in any queue. */
static void test_drops_at_the_end_are_told(void **state) {
  (void)state;
  reset_script(true);
  placido_recorder *recorder = open_recorder(1);
  placido_frame frame = {0};
  placido_recorder_summary summary;
  put(recorder, &frame, 0, NULL);
  put(recorder, &frame, 1, NULL);
  let_go(1);
  assert_int_equal(placido_recorder_close(recorder, &summary, NULL), PLACIDO_OK);
  assert_int_equal(summary.written, 1);
  assert_int_equal(summary.dropped, 1);
  assert_int_equal(count_events("frames dropped: 1, sequence 1 to 1"), 1);
  placido_frame_free(&frame);
}

static void test_gaps_of_the_counter_are_told(void **state) {
  (void)state;
  reset_script(false);
  placido_recorder *recorder = open_recorder(0);
  placido_frame frame = {0};
  placido_recorder_summary summary;
  put(recorder, &frame, 5, NULL);
  put(recorder, &frame, 9, NULL);
  frame.seq = 12;
  placido_recorder_pass(recorder, &frame);
  put(recorder, &frame, 13, NULL);
  put(recorder, &frame, 2, NULL); /* a counter that began anew skips nothing */
  put(recorder, &frame, 3, NULL);
  assert_int_equal(placido_recorder_close(recorder, &summary, NULL), PLACIDO_OK);
  assert_int_equal(summary.missing, 3);
  assert_int_equal(summary.written, 5);
  assert_int_equal(script.event_count, 1);
  assert_non_null(strstr(script.events[0], "9000 frames missing: 3 before sequence 9"));
  placido_frame_free(&frame);
}

static void test_a_source_that_waits_drops_nothing(void **state) {
  (void)state;
  reset_script(false);
  placido_recorder *recorder = open_recorder(2 * FRAME_BYTES);
  placido_frame frame = {0};
  placido_recorder_summary summary;
  for (uint64_t seq = 0; seq < 2000; seq++) {
    placido_frame_resize(&frame, SIDE, SIDE, PLACIDO_MONO8, NULL);
    placido_recorder_wait(recorder, &frame);
    put(recorder, &frame, seq, NULL);
  }
  assert_int_equal(placido_recorder_close(recorder, &summary, NULL), PLACIDO_OK);
  assert_int_equal(summary.written, 2000);
  assert_int_equal(summary.dropped, 0);
  assert_true(summary.queue_most <= 2);
  placido_frame_free(&frame);
}

/* Full disk at the third frame: what is before it stands, what waits is dropped, and everybody
 * hears of it. */
static void test_a_failure_is_told_at_put_and_at_close(void **state) {
  (void)state;
  reset_script(true);
  script.fails_at = 3;
  placido_recorder *recorder = open_recorder(0);
  placido_frame frame = {0};
  placido_recorder_summary summary;
  placido_error err = {0};
  for (uint64_t seq = 0; seq < 5; seq++) {
    assert_int_equal(put(recorder, &frame, seq, &err), PLACIDO_OK);
  }
  let_go(5);
  int status = PLACIDO_OK, puts = 5;
  for (uint64_t seq = 5; status == PLACIDO_OK && seq < 1000000; seq++, puts++) {
    status = put(recorder, &frame, seq, &err);
  }
  assert_int_equal(status, PLACIDO_SYSTEM);
  assert_string_equal(err.text, "scripted full disk");
  assert_int_equal(placido_recorder_close(recorder, &summary, &err), PLACIDO_SYSTEM);
  assert_string_equal(err.text, "scripted full disk");
  assert_true(script.is_closed);
  assert_int_equal(script.frames, 2);
  assert_int_equal(summary.written, 2);
  assert_int_equal(summary.dropped, puts - 2);
  placido_frame_free(&frame);
}

/* Who waits for room is not left waiting by a writer that has failed. */
static void test_a_failure_wakes_who_waits(void **state) {
  (void)state;
  reset_script(false);
  script.fails_at = 1;
  placido_recorder *recorder = open_recorder(1);
  placido_frame frame = {0};
  for (uint64_t seq = 0; seq < 3; seq++) {
    placido_frame_resize(&frame, SIDE, SIDE, PLACIDO_MONO8, NULL);
    placido_recorder_wait(recorder, &frame);
    put(recorder, &frame, seq, NULL);
  }
  assert_int_equal(placido_recorder_close(recorder, NULL, NULL), PLACIDO_SYSTEM);
  placido_frame_free(&frame);
}

static void test_a_refused_session_leaves_nothing(void **state) {
  (void)state;
  reset_script(false);
  script.refuses = true;
  placido_recorder *recorder;
  const placido_session_info info = {.bits = 8};
  placido_error err = {0};
  assert_int_equal(placido_recorder_open(&recorder, "nowhere", &info, "", 0, &err),
                   PLACIDO_SYSTEM);
  assert_null(recorder);
  assert_string_equal(err.text, "scripted refusal");
  assert_int_equal(placido_recorder_close(NULL, NULL, NULL), PLACIDO_OK);
}

/* Samples that the caller keeps are copied, and his frame stays as it is. */
static void test_borrowed_samples_are_copied(void **state) {
  (void)state;
  reset_script(true);
  placido_recorder *recorder = open_recorder(0);
  uint8_t samples[2 * FRAME_BYTES];
  memset(samples, 7, sizeof samples);
  placido_frame frame = {.width_px = SIDE, .height_px = SIDE, .stride_bytes = 2 * SIDE,
                         .bits = 8, .seq = 4, .data = samples};
  assert_int_equal(placido_recorder_put(recorder, &frame, NULL, NULL), PLACIDO_OK);
  assert_ptr_equal(frame.data, samples);
  memset(samples, 8, sizeof samples);
  let_go(1);
  assert_int_equal(placido_recorder_close(recorder, NULL, NULL), PLACIDO_OK);
  assert_int_equal(script.samples[0], 7);
  assert_int_equal(script.seqs[0], 4);
  assert_true(script.exposures_us[0] < 0.0); /* no information was given */
}

/* Whichever allocation fails, the frame is counted as dropped and nothing leaks. */
static void test_out_of_memory_is_survived(void **state) {
  (void)state;
  for (unsigned long n = 1; n < 12; n++) {
    reset_script(false);
    placido_recorder *recorder;
    const placido_session_info info = {.bits = 8};
    placido_frame frame = {0};
    placido_recorder_summary summary = {0};
    placido_memory_fail_at(n);
    int status = placido_recorder_open(&recorder, "nowhere", &info, "", 0, NULL);
    int accepted = 0, puts = 0;
    for (uint64_t seq = 0; status == PLACIDO_OK && seq < 8; seq += 2) {
      if (placido_frame_resize(&frame, SIDE, SIDE, PLACIDO_MONO8, NULL) == PLACIDO_OK) {
        frame.seq = seq;
        accepted += placido_recorder_put(recorder, &frame, NULL, NULL) == PLACIDO_OK;
        puts++;
      }
    }
    placido_memory_fail_at(0);
    placido_recorder_close(recorder, &summary, NULL);
    assert_int_equal(summary.written, accepted);
    assert_int_equal(summary.written + summary.dropped, puts);
    placido_frame_free(&frame);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_all_arrive_in_order),
      cmocka_unit_test(test_a_slow_writer_drops_visibly),
      cmocka_unit_test(test_drops_at_the_end_are_told),
      cmocka_unit_test(test_gaps_of_the_counter_are_told),
      cmocka_unit_test(test_a_source_that_waits_drops_nothing),
      cmocka_unit_test(test_a_failure_is_told_at_put_and_at_close),
      cmocka_unit_test(test_a_failure_wakes_who_waits),
      cmocka_unit_test(test_a_refused_session_leaves_nothing),
      cmocka_unit_test(test_borrowed_samples_are_copied),
      cmocka_unit_test(test_out_of_memory_is_survived),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
