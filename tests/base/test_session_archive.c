/* A session that is looked after stays what was recorded: a check finds what is wrong, an export
 * gives every sample, a repair keeps every whole frame. */
#include "base/file.h"
#include "base/memory.h"
#include "base/session/archive.h"
#include "tests/base/recording.h"
#include "tests/base/scratch.h"

#include <placido/image.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FRAMES = 6, WIDTH = 96, HEIGHT = 64 };

static const enum placido_session_codec codecs[] = {PLACIDO_CODEC_FFV1, PLACIDO_CODEC_FFVHUFF,
                                                    PLACIDO_CODEC_RAW};
enum { CODECS = sizeof codecs / sizeof *codecs };

static char *record(void **state, const char *name, enum placido_session_codec codec) {
  char *path = scratch_path(state, name);
  recording_make_in(codec, path, FRAMES, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
  return path;
}

/* The first finding of a part that is not sound, or NULL. */
static const placido_finding *find(const placido_findings *findings, const char *part,
                                   enum placido_finding_state state) {
  for (size_t i = 0; i < findings->count; i++) {
    if (strcmp(findings->items[i].part, part) == 0 && findings->items[i].state == state) {
      return &findings->items[i];
    }
  }
  return NULL;
}

static size_t check(placido_findings *findings, placido_session_survey *survey,
                    const char *path) {
  placido_error err = {0};
  if (placido_session_check(findings, survey, path, &err)) {
    fail_msg("%s", err.text);
  }
  return findings->damage;
}

static void what_was_recorded_is_sound(void **state) {
  for (int i = 0; i < CODECS; i++) {
    char name[16];
    snprintf(name, sizeof name, "%d.session", i);
    char *path = record(state, name, codecs[i]);
    placido_findings findings;
    placido_session_survey survey, quick;
    assert_int_equal(check(&findings, &survey, path), 0);
    assert_int_equal(survey.frames, FRAMES);
    assert_int_equal(survey.lines, FRAMES);
    assert_int_equal(survey.width_px, WIDTH);
    assert_true(survey.is_finished);
    /* 40.000007 ms a frame, exactly: the jitter is rounding only. */
    assert_float_equal(survey.clock.rate_hz, 1e9 / 40000007, 1e-6);
    assert_true(survey.clock.jitter_ms < 1e-6);
    assert_float_equal(survey.clock.longest_ms, 40.000007, 1e-9);
    assert_int_equal(placido_session_survey_take(&quick, path, NULL, NULL), PLACIDO_OK);
    assert_int_equal(quick.frames, FRAMES);
    assert_int_equal(quick.height_px, HEIGHT);
    assert_int_equal(quick.bytes, survey.bytes);
    assert_string_equal(quick.codec, survey.codec);
    assert_float_equal(quick.clock.seconds, survey.clock.seconds, 0);
    free(path);
  }
}

static void a_check_finds_what_is_wrong(void **state) {
  static const struct {
    const char *file, *text; /* NULL: the file is removed */
    const char *part;
    enum placido_finding_state state;
    const char *said;
  } cases[] = {
      {"session.json", NULL, "session.json", PLACIDO_FINDING_DAMAGE, "No such file"},
      {"session.json", "{\"format\": \"plac", "session.json", PLACIDO_FINDING_DAMAGE, "JSON"},
      {"session.json", "{\"format\": \"placido-session/1\", \"pixel_format\": \"gray16le\"}",
       "frames.mkv", PLACIDO_FINDING_DAMAGE, "has 8-bit samples, session.json says 16"},
      {"session.json", "{\"format\": \"placido-session/1\", \"extra\": 1}", "session.json",
       PLACIDO_FINDING_NOTE, "extra"},
      {"instrument.json", NULL, "instrument.json", PLACIDO_FINDING_DAMAGE, "No such file"},
      {"instrument.json", "{}", "instrument.json", PLACIDO_FINDING_DAMAGE, "format"},
      {"frames.mkv", NULL, "frames.mkv", PLACIDO_FINDING_DAMAGE, "it has no frames.mkv"},
      {"frames.mkv", "words", "frames.mkv", PLACIDO_FINDING_DAMAGE, "is not a Matroska file"},
      {"frames.jsonl", NULL, "frames.jsonl", PLACIDO_FINDING_NOTE, "is missing"},
      {"frames.jsonl", "{\"index\":0,\"timestamp_ns\":1}\n{\"ind", "frames.jsonl",
       PLACIDO_FINDING_DAMAGE, "1 bad lines; the first: "},
      {"frames.jsonl", "{\"index\":0,\"timestamp_ns\":1}\n", "frames.jsonl",
       PLACIDO_FINDING_DAMAGE, "5 frames have no line: 1-5"},
      {"frames.jsonl",
       "{\"index\":0,\"timestamp_ns\":1}\n{\"index\":1,\"timestamp_ns\":2}\n"
       "{\"index\":2,\"timestamp_ns\":3}\n{\"index\":3,\"timestamp_ns\":4}\n"
       "{\"index\":4,\"timestamp_ns\":5}\n{\"index\":5,\"timestamp_ns\":6}\n"
       "{\"index\":6,\"timestamp_ns\":7}\n",
       "frames.jsonl", PLACIDO_FINDING_DAMAGE, "1 frames that it has are not in the video"},
      {"frames.jsonl",
       "{\"index\":0,\"timestamp_ns\":9}\n{\"index\":1,\"timestamp_ns\":2}\n"
       "{\"index\":2,\"timestamp_ns\":2}\n{\"index\":3,\"timestamp_ns\":4}\n"
       "{\"index\":4,\"timestamp_ns\":5}\n{\"index\":5,\"timestamp_ns\":6}\n",
       "clock", PLACIDO_FINDING_DAMAGE, "does not go forward 2 times"},
      {"frames.jsonl",
       "{\"index\":0,\"timestamp_ns\":1,\"sequence\":7}\n"
       "{\"index\":1,\"timestamp_ns\":2,\"sequence\":8}\n"
       "{\"index\":2,\"timestamp_ns\":3,\"sequence\":12}\n"
       "{\"index\":3,\"timestamp_ns\":4,\"sequence\":13}\n"
       "{\"index\":4,\"timestamp_ns\":5,\"sequence\":0}\n"
       "{\"index\":5,\"timestamp_ns\":6,\"sequence\":2}\n",
       "sequence", PLACIDO_FINDING_NOTE, "4 frames of the camera's were not recorded, before 2, 5"},
      {"events.jsonl", "{\"t_ns\":1,\"event\":\"a\"}\n{\"t_ns\":1,\"ev", "events.jsonl",
       PLACIDO_FINDING_DAMAGE, "1 bad lines; the first is line 2"},
      {"letter.txt", "dear", "folder", PLACIDO_FINDING_NOTE, "letter.txt is no part"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char name[16];
    snprintf(name, sizeof name, "%zu.session", i);
    char *path = record(state, name, PLACIDO_CODEC_FFV1), file[PLACIDO_PATH_MAX];
    placido_findings findings;
    placido_session_survey survey;
    if (cases[i].text) {
      recording_put(path, cases[i].file, cases[i].text, strlen(cases[i].text));
    } else {
      assert_int_equal(placido_path_join(file, path, cases[i].file, NULL), PLACIDO_OK);
      assert_int_equal(unlink(file), 0);
    }
    check(&findings, &survey, path);
    const placido_finding *found = find(&findings, cases[i].part, cases[i].state);
    if (!found || !strstr(found->text, cases[i].said)) {
      fail_msg("case %zu: \"%s\" does not say \"%s\"", i, found ? found->text : "(nothing)",
               cases[i].said);
    }
    if (cases[i].state == PLACIDO_FINDING_NOTE) {
      assert_int_equal(findings.damage, 0);
    }
    free(path);
  }
}

/* A bit that flips anywhere within the frames is found, in every codec. */
static void a_check_finds_every_flipped_bit(void **state) {
  for (int i = 0; i < CODECS; i++) {
    char name[16];
    snprintf(name, sizeof name, "%d.session", i);
    char *path = record(state, name, codecs[i]);
    size_t size;
    char *video = recording_take(path, "frames.mkv", &size);
    placido_findings findings;
    placido_session_survey survey;
    int found = 0, tried = 0;
    for (size_t at = size / 4; at < size - size / 4; at += size / 53, tried++) {
      video[at] ^= 4;
      recording_put(path, "frames.mkv", video, size);
      found += check(&findings, &survey, path) > 0;
      video[at] ^= 4;
    }
    /* A hit may be on a byte that carries no sample, such as a cluster's time. */
    assert_true(found >= tried - 2);
    placido_memory_free(video);
    free(path);
  }
}

/* Every frame of `path` must be one that was recorded, in order; returns how many there are. */
static int count_true(const char *path) {
  placido_session_reader *reader;
  placido_frame frame = {0};
  placido_error err = {0};
  int count = 0, last = -1;
  if (placido_session_reader_open(&reader, path, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  for (; placido_session_reader_next(reader, &frame, &err) == PLACIDO_OK; count++) {
    const int number = (int)frame.seq - 1000;
    assert_true(number > last);
    recording_assert_frame(&frame, number, PLACIDO_MONO8, 8, WIDTH, HEIGHT);
    assert_true(llabs(frame.t_ns - (5000000123 + number * 40000007LL)) <= 1000000);
    last = number;
  }
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
  return count;
}

/* How many frames a torn session still gives. */
static int count_left(const char *path) {
  placido_session_reader *reader;
  placido_frame frame = {0};
  int count = 0, status = placido_session_reader_open(&reader, path, NULL, NULL);
  while (!status || status == PLACIDO_INPUT) {
    if (!reader) {
      return 0;
    }
    status = placido_session_reader_next(reader, &frame, NULL);
    count += status == PLACIDO_OK;
  }
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
  return count;
}

static void a_repair_keeps_every_whole_frame(void **state) {
  for (int i = 0; i < CODECS; i++) {
    char name[16], good_name[16];
    snprintf(name, sizeof name, "%d.session", i);
    char *path = record(state, name, codecs[i]);
    size_t size;
    char *video = recording_take(path, "frames.mkv", &size);
    int most = 0, run = 0;
    for (size_t kept = size - 1; kept > size / 101; kept -= size / 101, run++) {
      placido_findings findings;
      placido_session_survey survey;
      placido_repair_summary summary;
      snprintf(good_name, sizeof good_name, "%d-%d", i, run);
      char *good = scratch_path(state, good_name);
      recording_put(path, "frames.mkv", video, kept);
      const int left = count_left(path);
      const int status = placido_session_repair(&summary, path, good, NULL, NULL, NULL);
      assert_int_equal(status, left > 0 ? PLACIDO_OK : PLACIDO_INPUT);
      if (!status) {
        assert_int_equal(summary.kept, left);
        assert_int_equal(summary.kept + summary.cut_off, FRAMES);
        assert_int_equal(count_true(good), left);
        assert_int_equal(check(&findings, &survey, good), 0);
      }
      most = left > most ? left : most;
      placido_repair_summary_free(&summary);
      free(good);
    }
    assert_int_equal(most, FRAMES);
    placido_memory_free(video);
    free(path);
  }
}

static void a_repair_tells_what_was_lost(void **state) {
  char *path = record(state, "a.session", PLACIDO_CODEC_RAW);
  char *good = scratch_path(state, "good"), *instrument;
  size_t video_size, log_size;
  char *video = recording_take(path, "frames.mkv", &video_size);
  char *log = recording_take(path, "frames.jsonl", &log_size);
  placido_repair_summary summary;
  placido_notes notes = {0};
  video[video_size / 2] ^= 1; /* in a frame in the middle */
  recording_put(path, "frames.mkv", video, video_size);
  recording_put(path, "frames.jsonl", log, log_size - 20); /* in its last line */
  recording_put(path, "session.json", "{", 1);
  static const char events[] = "{\"t_ns\":1,\"event\":\"trigger\",\"own\":7}\n{\"t_";
  recording_put(path, "events.jsonl", events, sizeof events - 1);
  recording_put(path, "truth-surface.json", "{}", 2);
  instrument = recording_take(path, "instrument.json", &video_size);
  assert_int_equal(placido_session_repair(&summary, path, good, NULL, &notes, NULL), PLACIDO_OK);
  assert_int_equal(summary.kept, FRAMES - 1);
  assert_int_equal(placido_ranges_total(&summary.lost), 1);
  assert_int_equal(summary.bad_lines, 1);
  assert_int_equal(summary.bad_events, 1);
  assert_false(summary.has_description);
  assert_int_equal(count_true(good), FRAMES - 1);
  char *kept = recording_take(good, "events.jsonl", &log_size);
  assert_non_null(strstr(kept, "\"own\":7"));
  assert_non_null(strstr(kept, "\"repaired\""));
  placido_memory_free(kept);
  kept = recording_take(good, "truth-surface.json", &log_size);
  assert_string_equal(kept, "{}");
  placido_memory_free(kept);
  kept = recording_take(good, "instrument.json", &log_size);
  assert_string_equal(kept, instrument);
  placido_memory_free(kept);
  placido_memory_free(instrument);
  placido_memory_free(video);
  placido_memory_free(log);
  placido_repair_summary_free(&summary);
  placido_notes_clear(&notes);
  free(path);
  free(good);
}

static void a_repair_needs_an_instrument(void **state) {
  char *path = record(state, "a.session", PLACIDO_CODEC_FFV1), *good = scratch_path(state, "good");
  char *instrument = scratch_path(state, "a.session/instrument.json");
  placido_repair_summary summary;
  placido_error err = {0};
  assert_int_equal(unlink(instrument), 0);
  assert_int_equal(placido_session_repair(&summary, path, good, NULL, NULL, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "has no instrument.json: give the instrument's file"));
  assert_int_equal(access(good, F_OK), -1);
  assert_int_equal(
      placido_session_repair(&summary, path, good, RECORDING_INSTRUMENT, NULL, &err), PLACIDO_OK);
  assert_int_equal(count_true(good), FRAMES);
  placido_repair_summary_free(&summary);
  free(path);
  free(good);
  free(instrument);
}

static void exported_samples_are_those_recorded(void **state) {
  static const struct {
    enum placido_format format;
    int bits;
    enum placido_export_type type;
    const char *name;
  } cases[] = {{PLACIDO_MONO8, 8, PLACIDO_EXPORT_PNG, "frame-000002.png"},
               {PLACIDO_MONO8, 8, PLACIDO_EXPORT_TIFF, "frame-000002.tiff"},
               {PLACIDO_MONO16, 12, PLACIDO_EXPORT_PNG, "frame-000002.png"},
               {PLACIDO_MONO16, 16, PLACIDO_EXPORT_TIFF, "frame-000002.tiff"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char name[16], file[PLACIDO_PATH_MAX];
    snprintf(name, sizeof name, "%zu.session", i);
    char *path = scratch_path(state, name);
    snprintf(name, sizeof name, "%zu", i);
    char *folder = scratch_path(state, name);
    placido_ranges wanted = {0};
    placido_frame frame = {0};
    int64_t count;
    recording_make(path, FRAMES, cases[i].format, cases[i].bits, 61, 33);
    assert_int_equal(mkdir(folder, 0777), 0);
    assert_int_equal(placido_ranges_parse(&wanted, "0,2-3", NULL), PLACIDO_OK);
    assert_int_equal(
        placido_session_export(&count, path, folder, &wanted, cases[i].type, NULL, NULL),
        PLACIDO_OK);
    assert_int_equal(count, 3);
    assert_int_equal(scratch_count(folder), 3);
    assert_int_equal(placido_path_join(file, folder, cases[i].name, NULL), PLACIDO_OK);
    assert_int_equal(placido_frame_load(&frame, file, NULL), PLACIDO_OK);
    frame.bits = cases[i].bits; /* a picture file tells 8 or 16 */
    recording_assert_frame(&frame, 2, cases[i].format, cases[i].bits, 61, 33);
    placido_frame_free(&frame);
    placido_ranges_free(&wanted);
    free(path);
    free(folder);
  }
}

static void a_damaged_frame_is_not_exported(void **state) {
  char *path = record(state, "a.session", PLACIDO_CODEC_RAW), *folder = scratch_path(state, "out");
  size_t size;
  char *video = recording_take(path, "frames.mkv", &size);
  placido_ranges all = {0}, wanted = {0};
  placido_notes notes = {0};
  placido_error err = {0};
  int64_t count;
  video[size / 2] ^= 1;
  recording_put(path, "frames.mkv", video, size);
  assert_int_equal(mkdir(folder, 0777), 0);
  assert_int_equal(
      placido_session_export(&count, path, folder, &all, PLACIDO_EXPORT_PNG, &notes, NULL),
      PLACIDO_OK);
  assert_int_equal(count, FRAMES - 1);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "is damaged"));
  assert_int_equal(placido_ranges_parse(&wanted, "0-5", NULL), PLACIDO_OK);
  assert_int_equal(
      placido_session_export(&count, path, folder, &wanted, PLACIDO_EXPORT_PNG, &notes, &err),
      PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "is damaged"));
  placido_ranges_free(&wanted);
  assert_int_equal(placido_ranges_parse(&wanted, "6", NULL), PLACIDO_OK);
  assert_int_equal(
      placido_session_export(&count, path, folder, &wanted, PLACIDO_EXPORT_PNG, &notes, &err),
      PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "has no frame 6 (it has 6, counted from 0)"));
  placido_ranges_free(&wanted);
  placido_notes_clear(&notes);
  placido_memory_free(video);
  free(path);
  free(folder);
}

static void ranges_are_read_and_told(void **state) {
  (void)state;
  static const char *const wrong[] = {"", "a", "3,", ",3", "3-", "5-3", "-1", "3 ,4", "99999999999",
                                      "99999999999999999999999", "3--4"};
  placido_ranges ranges = {0};
  char text[80];
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    assert_int_equal(placido_ranges_parse(&ranges, wrong[i], NULL), PLACIDO_INPUT);
    placido_ranges_free(&ranges);
  }
  assert_int_equal(placido_ranges_parse(&ranges, "3,5-9,7", NULL), PLACIDO_OK);
  assert_true(placido_ranges_have(&ranges, 9) && !placido_ranges_have(&ranges, 4));
  assert_int_equal(placido_ranges_total(&ranges), 7);
  placido_ranges_text(text, sizeof text, &ranges);
  assert_string_equal(text, "3, 5-9, 7");
  placido_ranges_free(&ranges);
  for (int i = 0; i < 40; i++) {
    assert_int_equal(placido_ranges_add(&ranges, i + i / 2, NULL), PLACIDO_OK);
  }
  placido_ranges_text(text, sizeof text, &ranges);
  assert_string_equal(text, "0-1, 3-4, 6-7, 9-10, ...");
  placido_ranges_free(&ranges);
}

/* With the n-th allocation failing; what comes back is its status. */
static int care_with_failure(const char *path, const char *good, unsigned long n) {
  placido_findings findings;
  placido_session_survey survey;
  placido_repair_summary summary = {0};
  placido_memory_fail_at(n);
  int status = placido_session_check(&findings, &survey, path, NULL);
  if (!status) {
    status = placido_session_survey_take(&survey, path, NULL, NULL);
  }
  if (!status) {
    status = placido_session_repair(&summary, path, good, NULL, NULL, NULL);
  }
  placido_memory_fail_at(0);
  placido_repair_summary_free(&summary);
  return status;
}

static void every_allocation_may_fail(void **state) {
  char *path = record(state, "a.session", PLACIDO_CODEC_RAW), name[16];
  int status = PLACIDO_MEMORY;
  unsigned long n = 0;
  while (status == PLACIDO_MEMORY) {
    snprintf(name, sizeof name, "%lu", ++n);
    char *good = scratch_path(state, name);
    status = care_with_failure(path, good, n);
    free(good);
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 30);
  assert_int_equal(count_true(path), FRAMES);
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(what_was_recorded_is_sound),
      TEST(a_check_finds_what_is_wrong),
      TEST(a_check_finds_every_flipped_bit),
      TEST(a_repair_keeps_every_whole_frame),
      TEST(a_repair_tells_what_was_lost),
      TEST(a_repair_needs_an_instrument),
      TEST(exported_samples_are_those_recorded),
      TEST(a_damaged_frame_is_not_exported),
      TEST(ranges_are_read_and_told),
      TEST(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
