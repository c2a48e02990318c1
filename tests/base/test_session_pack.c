/* Packing changes how frames are stored and nothing else, and whatever stops it, what was recorded
 * is there. */
#include "base/file.h"
#include "base/memory.h"
#include "base/session/archive.h"
#include "tests/base/recording.h"
#include "tests/base/scratch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { FRAMES = 6, WIDTH = 96, HEIGHT = 64 };

/* As `placido session pack` does it in place. */
static int pack(const char *path, placido_error *err) {
  placido_directory workshop;
  placido_pack_summary summary;
  int lock, status = placido_pack_begin(&lock, &workshop, path, err);
  if (!status) {
    status = placido_pack_video(&summary, path, workshop.temporary, err);
  }
  if (!status) {
    status = placido_pack_commit(&workshop, path, err);
  }
  placido_directory_discard(&workshop);
  placido_pack_end(lock);
  return status;
}

/* Every frame must be there and true, in the codec. */
static void expect(const char *path, enum placido_session_codec codec, int count,
                   enum placido_format format, int bits, int width_px, int height_px) {
  placido_session_reader *reader;
  placido_frame frame = {0};
  placido_error err = {0};
  if (placido_session_reader_open(&reader, path, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  assert_int_equal(placido_session_reader_info(reader)->codec, codec);
  for (int i = 0; i < count; i++) {
    assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
    recording_assert_frame(&frame, i, format, bits, width_px, height_px);
    assert_int_equal(frame.t_ns, 5000000123 + (int64_t)i * 40000007);
    assert_int_equal(frame.seq, 1000 + i);
  }
  assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_END);
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
}

static void packing_changes_the_codec_and_nothing_else(void **state) {
  static const struct {
    enum placido_session_codec codec;
    enum placido_format format;
    int bits;
  } cases[] = {{PLACIDO_CODEC_RAW, PLACIDO_MONO8, 8},     {PLACIDO_CODEC_FFVHUFF, PLACIDO_MONO8, 8},
               {PLACIDO_CODEC_RAW, PLACIDO_MONO16, 12},   {PLACIDO_CODEC_RAW, PLACIDO_MONO16, 16},
               {PLACIDO_CODEC_FFVHUFF, PLACIDO_MONO16, 10}, {PLACIDO_CODEC_FFV1, PLACIDO_MONO8, 8}};
  static const char *const others[] = {"session.json", "instrument.json", "frames.jsonl",
                                       "events.jsonl"};
  enum { OTHERS = sizeof others / sizeof *others };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char name[16], *before[OTHERS];
    size_t sizes[OTHERS];
    placido_error err = {0};
    snprintf(name, sizeof name, "%zu.session", i);
    char *path = scratch_path(state, name);
    recording_make_in(cases[i].codec, path, FRAMES, cases[i].format, cases[i].bits, WIDTH,
                      HEIGHT);
    for (int k = 0; k < OTHERS; k++) {
      before[k] = recording_take(path, others[k], &sizes[k]);
    }
    bool needed;
    assert_int_equal(placido_pack_is_needed(&needed, path, NULL), PLACIDO_OK);
    assert_int_equal(needed, cases[i].codec != PLACIDO_CODEC_FFV1);
    if (pack(path, &err)) {
      fail_msg("%s", err.text);
    }
    expect(path, PLACIDO_CODEC_FFV1, FRAMES, cases[i].format, cases[i].bits, WIDTH, HEIGHT);
    for (int k = 0; k < OTHERS; k++) {
      size_t size;
      char *after = recording_take(path, others[k], &size);
      assert_int_equal(size, sizes[k]);
      assert_memory_equal(after, before[k], size);
      placido_memory_free(after);
      placido_memory_free(before[k]);
    }
    assert_int_equal(scratch_count(path), OTHERS + 1);
    assert_int_equal(placido_pack_is_needed(&needed, path, NULL), PLACIDO_OK);
    assert_false(needed);
    free(path);
  }
}

static void a_session_that_is_not_whole_is_not_packed(void **state) {
  char *path = scratch_path(state, "a.session");
  size_t size, log_size;
  placido_error err = {0};
  recording_make_in(PLACIDO_CODEC_RAW, path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  char *video = recording_take(path, "frames.mkv", &size);
  char *log = recording_take(path, "frames.jsonl", &log_size);

  recording_put(path, "frames.mkv", video, size - 1);
  assert_int_equal(pack(path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "its video has no proper end: not packed"));

  video[size / 2] ^= 1;
  recording_put(path, "frames.mkv", video, size);
  assert_int_equal(pack(path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "a frame is not the one that was recorded: not packed"));
  size_t left_size;
  char *left = recording_take(path, "frames.mkv", &left_size);
  assert_int_equal(left_size, size);
  assert_memory_equal(left, video, size);
  video[size / 2] ^= 1;
  recording_put(path, "frames.mkv", video, size);

  recording_put(path, "frames.jsonl", log, log_size - 5);
  assert_int_equal(pack(path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "frames.jsonl has bad lines: not packed"));
  static const char beyond[] = "{\"index\":6,\"timestamp_ns\":9000000000}\n";
  recording_put(path, "frames.jsonl", beyond, sizeof beyond - 1);
  assert_int_equal(pack(path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "frames.jsonl has frames that the video has not"));
  recording_put(path, "frames.jsonl", log, log_size);

  assert_int_equal(scratch_count(path), 5); /* nothing was left behind */
  assert_int_equal(pack(path, &err), PLACIDO_OK);
  placido_memory_free(left);
  placido_memory_free(video);
  placido_memory_free(log);
  free(path);
}

static void when_memory_runs_out_the_fast_copy_stays(void **state) {
  char *path = scratch_path(state, "a.session");
  recording_make_in(PLACIDO_CODEC_RAW, path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  int status = PLACIDO_MEMORY;
  unsigned long n = 0;
  while (status == PLACIDO_MEMORY) {
    placido_memory_fail_at(++n);
    status = pack(path, NULL);
    placido_memory_fail_at(0);
    if (status) {
      expect(path, PLACIDO_CODEC_RAW, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
      assert_int_equal(scratch_count(path), 5);
    }
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 10);
  expect(path, PLACIDO_CODEC_FFV1, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  free(path);
}

/* Killed at moments from before its start to after its end: one of the two copies is there, whole,
 * and the next packing finishes and cleans up. */
static void a_packing_that_is_killed_loses_nothing(void **state) {
  enum { KILLS = 24, COUNT = 20, WIDE = 320, HIGH = 240 };
  static const long step_ns = 4000000; /* the whole takes some 50 ms */
  int unfinished = 0;
  for (int i = 0; i < KILLS; i++) {
    char name[16];
    snprintf(name, sizeof name, "%d.session", i);
    char *path = scratch_path(state, name);
    recording_make_in(PLACIDO_CODEC_RAW, path, COUNT, PLACIDO_MONO8, 8, WIDE, HIGH);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
      _exit(pack(path, NULL) ? 1 : 0);
    }
    const struct timespec pause = {.tv_nsec = i * step_ns};
    nanosleep(&pause, NULL);
    kill(child, SIGKILL);
    int ended;
    assert_int_equal(waitpid(child, &ended, 0), child);
    bool needed;
    assert_int_equal(placido_pack_is_needed(&needed, path, NULL), PLACIDO_OK);
    expect(path, needed ? PLACIDO_CODEC_RAW : PLACIDO_CODEC_FFV1, COUNT, PLACIDO_MONO8, 8, WIDE,
           HIGH);
    unfinished += needed;
    assert_int_equal(pack(path, NULL), PLACIDO_OK);
    expect(path, PLACIDO_CODEC_FFV1, COUNT, PLACIDO_MONO8, 8, WIDE, HIGH);
    assert_int_equal(scratch_count(path), 5);
    free(path);
  }
  assert_true(unfinished > 0);
}

static void two_do_not_pack_at_once(void **state) {
  char *path = scratch_path(state, "a.session");
  placido_directory workshop;
  placido_error err = {0};
  int lock;
  recording_make_in(PLACIDO_CODEC_RAW, path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  assert_int_equal(placido_pack_begin(&lock, &workshop, path, NULL), PLACIDO_OK);
  assert_int_equal(pack(path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "is being packed by another process"));
  assert_int_equal(access(workshop.temporary, F_OK), 0);
  placido_directory_discard(&workshop);
  placido_pack_end(lock);
  assert_int_equal(pack(path, &err), PLACIDO_OK);
  free(path);
}

/* What is called frames-new and is not ours is not removed. */
static void a_file_of_anothers_is_not_touched(void **state) {
  char *path = scratch_path(state, "a.session");
  char *folder = scratch_path(state, "a.session/" PLACIDO_PACK_FOLDER);
  placido_error err = {0};
  recording_make_in(PLACIDO_CODEC_RAW, path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  assert_int_equal(mkdir(folder, 0777), 0);
  recording_put(folder, "letter.txt", "dear", 4);
  assert_int_equal(pack(path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "cannot make"));
  assert_int_equal(scratch_count(folder), 1);
  free(path);
  free(folder);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(packing_changes_the_codec_and_nothing_else),
      TEST(a_session_that_is_not_whole_is_not_packed),
      TEST(when_memory_runs_out_the_fast_copy_stays),
      TEST(a_packing_that_is_killed_loses_nothing),
      TEST(two_do_not_pack_at_once),
      TEST(a_file_of_anothers_is_not_touched),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
