/* A torn or damaged session gives what is whole in it, and says what is not. */
#include "base/file.h"
#include "base/memory.h"
#include "tests/base/recording.h"
#include "tests/base/scratch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { FRAMES = 6, WIDTH = 64, HEIGHT = 48 };

static const enum placido_session_codec codecs[] = {PLACIDO_CODEC_FFV1, PLACIDO_CODEC_FFVHUFF,
                                                    PLACIDO_CODEC_RAW};
enum { CODECS = sizeof codecs / sizeof *codecs };

/* Records a session of FRAMES frames called a.session. */
static char *record(void **state) {
  char *path = scratch_path(state, "a.session");
  recording_make(path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  return path;
}

/* The same in a codec, in the place of one that may be there. */
static char *record_in(void **state, enum placido_session_codec codec) {
  static const char *const names[] = {"session.json", "instrument.json", "frames.mkv",
                                      "frames.jsonl", "events.jsonl"};
  char *path = scratch_path(state, "a.session"), file[PLACIDO_PATH_MAX];
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    assert_int_equal(placido_path_join(file, path, names[i], NULL), PLACIDO_OK);
    unlink(file);
  }
  rmdir(path);
  recording_make_in(codec, path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  return path;
}

/* A file of the session, read; free with placido_memory_free. */
static char *take(void **state, const char *name, size_t *size) {
  char inside[64], *bytes;
  snprintf(inside, sizeof inside, "a.session/%s", name);
  char *path = scratch_path(state, inside);
  assert_int_equal(placido_file_read(&bytes, size, path, 0, NULL), PLACIDO_OK);
  free(path);
  return bytes;
}

static void put(void **state, const char *name, const char *bytes, size_t size) {
  char inside[64];
  snprintf(inside, sizeof inside, "a.session/%s", name);
  free(scratch_write(state, inside, bytes, size));
}

/* Reads to the end; every frame that is given must be true. Returns how many there were. */
static int count_true_frames(placido_session_reader *reader, int *damaged) {
  placido_frame frame = {0};
  int count = 0, status;
  *damaged = 0;
  while ((status = placido_session_reader_next(reader, &frame, NULL)) != PLACIDO_END) {
    assert_true(status == PLACIDO_OK || status == PLACIDO_INPUT);
    if (status) {
      ++*damaged;
    } else {
      recording_assert_frame(&frame, (int)frame.seq - 1000, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
      count++;
    }
    assert_true(count + *damaged <= FRAMES);
  }
  placido_frame_free(&frame);
  return count;
}

/* Opens what is left of the video and counts its frames, which must be about its share. */
static int count_torn(const char *path, size_t kept, size_t size) {
  placido_notes notes = {0};
  placido_session_reader *reader;
  int count = 0, status = placido_session_reader_open(&reader, path, &notes, NULL);
  if (!status) {
    int damaged;
    count = count_true_frames(reader, &damaged);
    assert_int_equal(damaged, 0);
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "frames.mkv has no proper end"));
    /* Noise does not compress: a frame fills about its share of the file. */
    assert_true(count >= (int)((double)kept / (double)size * FRAMES) - 1);
  } else {
    assert_int_equal(status, PLACIDO_INPUT);
    assert_true(kept < size / FRAMES);
  }
  placido_notes_clear(&notes);
  placido_session_reader_close(reader);
  return count;
}

static void a_torn_video_gives_its_whole_frames_and_one_note(void **state) {
  for (int i = 0; i < CODECS; i++) {
    char *path = record_in(state, codecs[i]);
    size_t size;
    char *video = take(state, "frames.mkv", &size);
    int most = 0;
    for (size_t kept = size - 1; kept > 0; kept -= kept > size / 101 ? size / 101 : 1) {
      put(state, "frames.mkv", video, kept);
      int count = count_torn(path, kept, size);
      most = count > most ? count : most;
    }
    assert_int_equal(most, FRAMES);
    placido_memory_free(video);
    free(path);
  }
}

/* In every codec: FFV1 by its own checksums, the others by that of frames.jsonl. */
static void a_damaged_frame_is_told_and_the_next_ones_follow(void **state) {
  for (int i = 0; i < CODECS; i++) {
    char *path = record_in(state, codecs[i]);
    size_t size;
    char *video = take(state, "frames.mkv", &size);
    int hit = 0;
    for (size_t at = size / 5; at < size - size / 5; at += size / 23) {
      placido_session_reader *reader;
      video[at] ^= 0x10;
      put(state, "frames.mkv", video, size);
      assert_int_equal(placido_session_reader_open(&reader, path, NULL, NULL), PLACIDO_OK);
      int damaged, count = count_true_frames(reader, &damaged);
      assert_true(count >= FRAMES - 1);
      hit += damaged == 1 && count == FRAMES - 1;
      placido_session_reader_close(reader);
      video[at] ^= 0x10;
    }
    assert_true(hit >= 10);
    placido_memory_free(video);
    free(path);
  }
}

/* Where the demuxer skips a frame without a trace, the frames behind it keep their numbers, times
 * and counters all the same. */
static void frames_behind_a_lost_one_keep_their_numbers(void **state) {
  for (int i = 0; i < CODECS; i++) {
    char *path = record_in(state, codecs[i]);
    size_t size;
    char *video = take(state, "frames.mkv", &size);
    const char cluster[] = {0x1f, 0x43, (char)0xb6, 0x75};
    int seen = 0;
    for (size_t at = 0; at + sizeof cluster < size; at++) {
      seen += memcmp(video + at, cluster, sizeof cluster) == 0;
      if (seen == 2) {
        memset(video + at, 0, 256); /* its head, and the block's */
        break;
      }
    }
    put(state, "frames.mkv", video, size);
    placido_session_reader *reader;
    assert_int_equal(placido_session_reader_open(&reader, path, NULL, NULL), PLACIDO_OK);
    int damaged, count = count_true_frames(reader, &damaged);
    assert_true(count < FRAMES && count >= FRAMES - 3); /* 256 bytes are less than three */
    assert_int_equal(count + damaged, FRAMES);
    assert_int_equal(placido_session_reader_frame_info(reader).index, FRAMES - 1);
    placido_session_reader_close(reader);
    placido_memory_free(video);
    free(path);
  }
}

/* A log that ends in mid-line: the times go on by the video's, to its millisecond. */
static void times_go_on_behind_a_torn_log(void **state) {
  char *path = record(state);
  size_t size;
  char *log = take(state, "frames.jsonl", &size);
  placido_frame frame = {0};
  for (size_t kept = size - 2; kept > size / FRAMES; kept -= size / 101 + 1) {
    placido_session_reader *reader;
    put(state, "frames.jsonl", log, kept);
    assert_int_equal(placido_session_reader_open(&reader, path, NULL, NULL), PLACIDO_OK);
    for (int i = 0; i < FRAMES; i++) {
      assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
      recording_assert_frame(&frame, i, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
      assert_int_equal(frame.seq, 1000 + i);
      assert_true(llabs(frame.t_ns - (5000000123 + i * 40000007LL)) <= 1000000);
    }
    placido_session_reader_close(reader);
  }
  placido_frame_free(&frame);
  placido_memory_free(log);
  free(path);
}

/* Records without an end, as a process that is killed does. */
static void record_and_vanish(const char *path, enum placido_session_codec codec, int count) {
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  info.codec = codec;
  placido_session_writer *writer;
  placido_frame frame = {0};
  int status =
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL);
  for (int i = 0; !status && i < count; i++) {
    recording_fill(&frame, i, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
    status = placido_session_writer_append(writer, &frame, NULL, NULL);
  }
  _exit(status ? 1 : 0);
}

static int count_after_crash(const char *path) {
  placido_notes notes = {0};
  placido_session_reader *reader;
  placido_frame frame = {0};
  assert_int_equal(placido_session_reader_open(&reader, path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 1);
  int count = 0;
  while (placido_session_reader_next(reader, &frame, NULL) == PLACIDO_OK) {
    recording_assert_frame(&frame, count, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
    assert_int_equal(frame.seq, 1000 + count);
    count++;
  }
  placido_frame_free(&frame);
  placido_notes_clear(&notes);
  placido_session_reader_close(reader);
  return count;
}

static void a_crash_costs_at_most_the_last_second(void **state) {
  enum { RECORDED = 100, PER_SECOND = 25 };
  for (int i = 0; i < CODECS; i++) {
    char name[16];
    snprintf(name, sizeof name, "%d.session", i);
    char *path = scratch_path(state, name);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
      record_and_vanish(path, codecs[i], RECORDED);
    }
    int ended;
    assert_int_equal(waitpid(child, &ended, 0), child);
    assert_true(WIFEXITED(ended) && WEXITSTATUS(ended) == 0);
    assert_true(count_after_crash(path) >= RECORDED - PER_SECOND);
    free(path);
  }
}

static void a_missing_part_is_named(void **state) {
  static const char *const names[] = {"session.json", "instrument.json", "frames.mkv"};
  char *path = record(state);
  for (size_t i = 0; i < 3; i++) {
    placido_session_reader *reader;
    placido_error err = {0};
    size_t size;
    char *bytes = take(state, names[i], &size), inside[64];
    snprintf(inside, sizeof inside, "a.session/%s", names[i]);
    char *part = scratch_path(state, inside);
    assert_int_equal(unlink(part), 0);
    assert_int_equal(placido_session_reader_open(&reader, path, NULL, &err), PLACIDO_INPUT);
    assert_null(reader);
    assert_non_null(strstr(err.text, "is not a whole session: it has no "));
    assert_non_null(strstr(err.text, names[i]));
    put(state, names[i], bytes, size);
    placido_memory_free(bytes);
    free(part);
  }
  free(path);
}

static void what_is_no_session_is_refused(void **state) {
  char *file = scratch_write_text(state, "file", "x"), *nowhere = scratch_path(state, "nowhere");
  placido_session_reader *reader;
  placido_error err;
  assert_int_equal(placido_session_reader_open(&reader, nowhere, NULL, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "nowhere"));
  assert_int_equal(placido_session_reader_open(&reader, file, NULL, &err), PLACIDO_SYSTEM);
  free(file);
  free(nowhere);
}

static void a_video_that_is_none_is_refused(void **state) {
  static const char *const videos[] = {"", "words", "\x1a\x45\xdf\xa3\x80\x18\x53\x80\x67\xff",
                                       "\x1a\x45\xdf\xa3"};
  char *path = record(state);
  for (size_t i = 0; i < sizeof videos / sizeof *videos; i++) {
    placido_session_reader *reader;
    placido_error err = {0};
    put(state, "frames.mkv", videos[i], strlen(videos[i]));
    assert_int_equal(placido_session_reader_open(&reader, path, NULL, &err), PLACIDO_INPUT);
    assert_non_null(strstr(err.text, "frames.mkv"));
  }
  free(path);
}

static void wrong_descriptions_are_refused_at_their_line(void **state) {
  static const struct {
    const char *text, *said;
  } cases[] = {
      {"{\"format\": \"placido-session/9\"}", "session.json:1: field format: unknown version"},
      {"{\"format\": \"placido-session/1\",\n\"eye\": \"left\"}",
       "session.json:2: field eye: is \"left\", \"OD\" or \"OS\" is expected"},
      {"{\"format\": \"placido-session/1\",\n\"axis_z_mm\": \"0\"}",
       "session.json:2: field axis_z_mm: is a string, a number is expected"},
      {"{\"format\": \"placido-session/1\",\n\"axis_z_mm\": -101}",
       "session.json:2: field axis_z_mm: is -101, -100 to 100 is expected"},
      {"{\"format\": \"placido-session/1\",\n\"device\": \"camera\"}",
       "session.json:2: field device: an object is expected"},
      {"{\"format\": \"placido-session/1\",\n\"axis_z_sigma_mm\": -1}",
       "session.json:2: field axis_z_sigma_mm: is -1"},
      {"{\"format\": \"placido-session/1\",\n\"pixel_format\": \"rgb24\"}",
       "session.json:2: field pixel_format: is \"rgb24\""},
      {"{\"format\": \"placido-session/1\",\n\"pixel_format\": \"gray8\", \"bit_depth\": 12}",
       "session.json:2: field bit_depth: is 12"},
      {"{\"format\": \"placido-session/1\",\n\"device\": {\"vendor\": 3}}",
       "session.json:2: field device.vendor: is a number"},
  };
  char *path = record(state);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    placido_session_reader *reader;
    placido_error err = {0};
    put(state, "session.json", cases[i].text, strlen(cases[i].text));
    assert_int_equal(placido_session_reader_open(&reader, path, NULL, &err), PLACIDO_INPUT);
    if (!strstr(err.text, cases[i].said)) {
      fail_msg("\"%s\" does not say \"%s\"", err.text, cases[i].said);
    }
  }
  free(path);
}

static void bad_lines_of_the_log_are_noted_and_ignored(void **state) {
  static const char log[] = "{\"index\": 1, \"timestamp_ns\": 77, \"sequence\": 5}\n"
                            "words\n"
                            "{\"index\": -2, \"timestamp_ns\": 1}\n"
                            "{\"index\": 2}\n"
                            "{\"index\": 3, \"timestamp_ns\": 1, \"flags\": \"no\"}\n"
                            "\n"
                            "{\"index\": 0, \"timestamp_ns\": 66, \"exposure_us\": null}\n"
                            "{\"index\": 4, \"timestamp";
  char *path = record(state);
  placido_notes notes = {0};
  placido_session_reader *reader;
  placido_frame frame = {0};
  put(state, "frames.jsonl", log, sizeof log - 1);
  assert_int_equal(placido_session_reader_open(&reader, path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 6);
  assert_non_null(strstr(notes.lines[0], "frames.jsonl:2: ignored, the line is not a JSON object"));
  assert_non_null(strstr(notes.lines[5], "frames.jsonl:8: ignored"));
  assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
  assert_int_equal(frame.t_ns, 66);
  assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
  assert_int_equal(frame.t_ns, 77);
  assert_int_equal(frame.seq, 5);
  assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
  /* Without a line: on from the last one, by the stream's time in whole ms. */
  assert_int_equal(frame.seq, 6);
  assert_int_equal(frame.t_ns, 77 + 40000000);
  placido_frame_free(&frame);
  placido_notes_clear(&notes);
  placido_session_reader_close(reader);
  free(path);
}

static void a_ruined_log_is_noted_briefly(void **state) {
  char *path = record(state), log[4000];
  placido_notes notes = {0};
  placido_session_reader *reader;
  for (size_t i = 0; i < sizeof log; i++) {
    log[i] = i % 2 ? '\n' : 'x';
  }
  put(state, "frames.jsonl", log, sizeof log);
  assert_int_equal(placido_session_reader_open(&reader, path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 11);
  assert_non_null(strstr(notes.lines[10], "1990 more lines are ignored"));
  placido_notes_clear(&notes);
  placido_session_reader_close(reader);
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(a_torn_video_gives_its_whole_frames_and_one_note),
      TEST(a_damaged_frame_is_told_and_the_next_ones_follow),
      TEST(frames_behind_a_lost_one_keep_their_numbers),
      TEST(times_go_on_behind_a_torn_log),
      TEST(a_crash_costs_at_most_the_last_second),
      TEST(a_missing_part_is_named),
      TEST(what_is_no_session_is_refused),
      TEST(a_video_that_is_none_is_refused),
      TEST(wrong_descriptions_are_refused_at_their_line),
      TEST(bad_lines_of_the_log_are_noted_and_ignored),
      TEST(a_ruined_log_is_noted_briefly),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
