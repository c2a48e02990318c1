/* What is recorded comes back: every sample, every time, every word of the description. */
#include "base/file.h"
#include "base/memory.h"
#include "base/session/checksum.h"
#include "tests/base/recording.h"
#include "tests/base/scratch.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static placido_session_reader *open_session(const char *path, placido_notes *notes) {
  placido_session_reader *reader;
  placido_error err = {0};
  if (placido_session_reader_open(&reader, path, notes, &err)) {
    fail_msg("%s", err.text);
  }
  return reader;
}

static const enum placido_session_codec codecs[] = {PLACIDO_CODEC_FFV1, PLACIDO_CODEC_FFVHUFF,
                                                    PLACIDO_CODEC_RAW};
enum { CODECS = sizeof codecs / sizeof *codecs };

/* Records five frames and reads them. */
static void expect_frames_back(const char *path, enum placido_session_codec codec,
                               enum placido_format format, int bits, int width_px,
                               int height_px) {
  placido_frame frame = {0};
  placido_notes notes = {0};
  recording_make_in(codec, path, 5, format, bits, width_px, height_px);
  placido_session_reader *reader = open_session(path, &notes);
  assert_int_equal(notes.count, 0);
  assert_int_equal(placido_session_reader_info(reader)->codec, codec);
  for (int n = 0; n < 5; n++) {
    assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
    recording_assert_frame(&frame, n, format, bits, width_px, height_px);
    assert_int_equal(frame.t_ns, 5000000123 + (int64_t)n * 40000007);
    assert_int_equal(frame.seq, 1000 + n);
  }
  assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_END);
  assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_END);
  placido_session_reader_close(reader);
  placido_frame_free(&frame);
}

static void samples_times_and_counters_come_back(void **state) {
  static const struct {
    enum placido_format format;
    int bits, width_px, height_px;
  } cases[] = {{PLACIDO_MONO8, 8, 64, 48},    {PLACIDO_MONO16, 16, 64, 48},
               {PLACIDO_MONO16, 12, 70, 33},  {PLACIDO_MONO16, 10, 4, 4},
               {PLACIDO_MONO8, 8, 333, 257},  {PLACIDO_MONO8, 8, 5, 2000},
               {PLACIDO_MONO8, 8, 1280, 1024}};
  for (size_t i = 0; i < CODECS * sizeof cases / sizeof *cases; i++) {
    char name[32];
    snprintf(name, sizeof name, "%zu:a.session", i); /* a colon is no protocol */
    char *path = scratch_path(state, name);
    expect_frames_back(path, codecs[i % CODECS], cases[i / CODECS].format, cases[i / CODECS].bits,
                       cases[i / CODECS].width_px, cases[i / CODECS].height_px);
    free(path);
  }
}

static void rewinding_gives_the_first_frame_again(void **state) {
  char *path = scratch_path(state, "a.session");
  recording_make_in(PLACIDO_CODEC_RAW, path, 3, PLACIDO_MONO8, 8, 32, 16);
  placido_session_reader *reader = open_session(path, NULL);
  placido_frame frame = {0};
  for (int round = 0; round < 3; round++) {
    for (int n = 0; n < 1 + round; n++) {
      assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
      recording_assert_frame(&frame, n, PLACIDO_MONO8, 8, 32, 16);
    }
    assert_int_equal(placido_session_reader_rewind(reader, NULL), PLACIDO_OK);
  }
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
  free(path);
}

static void the_description_comes_back(void **state) {
  char *path = scratch_path(state, "a.session");
  placido_session_info info = {.created = "2025-01-02T03:04:05Z",
                               .eye = "OS",
                               .subject = "7f3a",
                               .driver = "u3v",
                               .vendor = "Vendor µ",
                               .model = "M",
                               .serial = "0042",
                               .firmware = "1.2",
                               .format = PLACIDO_MONO16,
                               .bits = 12,
                               .rate_hz = 1.0 / 3,
                               .axis_z_mm = -0.123456789012345678,
                               .axis_z_sigma_mm = 0.02,
                               .software = "placido 0"};
  placido_session_writer *writer;
  placido_frame frame = {0};
  assert_int_equal(
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL), PLACIDO_OK);
  recording_fill(&frame, 0, PLACIDO_MONO16, 12, 8, 8);
  assert_int_equal(placido_session_writer_append(writer, &frame, NULL, NULL), PLACIDO_OK);
  assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
  placido_frame_free(&frame);

  placido_session_reader *reader = open_session(path, NULL);
  const placido_session_info *read = placido_session_reader_info(reader);
  assert_string_equal(read->created, info.created);
  assert_string_equal(read->eye, info.eye);
  assert_string_equal(read->subject, info.subject);
  assert_string_equal(read->driver, info.driver);
  assert_string_equal(read->vendor, info.vendor);
  assert_string_equal(read->model, info.model);
  assert_string_equal(read->serial, info.serial);
  assert_string_equal(read->firmware, info.firmware);
  assert_string_equal(read->software, info.software);
  assert_int_equal(read->format, PLACIDO_MONO16);
  assert_int_equal(read->bits, 12);
  assert_true(read->rate_hz == info.rate_hz);
  assert_true(read->axis_z_mm == info.axis_z_mm);
  assert_true(read->axis_z_sigma_mm == info.axis_z_sigma_mm);
  placido_session_reader_close(reader);
  free(path);
}

static void what_was_not_recorded_stays_unknown(void **state) {
  char *path = scratch_path(state, "a.session");
  recording_make(path, 1, PLACIDO_MONO8, 8, 8, 8);
  placido_session_reader *reader = open_session(path, NULL);
  const placido_session_info *info = placido_session_reader_info(reader);
  assert_string_equal(info->eye, "");
  assert_true(isnan(info->axis_z_mm));
  assert_true(isnan(info->axis_z_sigma_mm));
  placido_session_reader_close(reader);
  free(path);
}

/* A session's file as a string; free with placido_memory_free. */
static char *text_of(const char *session, const char *name) {
  char path[PLACIDO_PATH_MAX], *text;
  size_t size;
  assert_int_equal(placido_path_join(path, session, name, NULL), PLACIDO_OK);
  assert_int_equal(placido_file_read(&text, &size, path, 0, NULL), PLACIDO_OK);
  return text;
}

static void the_logs_and_the_instrument_are_plain_files(void **state) {
  char *path = scratch_path(state, "a.session");
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  const placido_frame_info exposure = {.exposure_us = 1500.5, .gain_db = NAN};
  placido_session_writer *writer;
  placido_frame frame = {0};
  assert_int_equal(
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL), PLACIDO_OK);
  recording_fill(&frame, 0, PLACIDO_MONO8, 8, 8, 8);
  frame.flags = PLACIDO_FRAME_TRUNCATED;
  assert_int_equal(placido_session_writer_append(writer, &frame, &exposure, NULL), PLACIDO_OK);
  assert_int_equal(placido_session_writer_event(writer, 77, "trigger", NULL, NULL), PLACIDO_OK);
  assert_int_equal(placido_session_writer_event(writer, 78, "note", "a \"b\"", NULL), PLACIDO_OK);
  assert_int_equal(placido_session_writer_event(writer, 79, "\xff", NULL, NULL), PLACIDO_INPUT);
  assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
  placido_frame_free(&frame);

  char *frames = text_of(path, "frames.jsonl"), *events = text_of(path, "events.jsonl");
  char *instrument = text_of(path, "instrument.json");
  char *original = text_of(PLACIDO_TEST_DATA "/samples", "normal.instrument.json");
  assert_string_equal(frames, "{\"index\":0,\"timestamp_ns\":5000000123,\"sequence\":1000,"
                              "\"exposure_us\":1500.5,\"gain_db\":null,\"flags\":1,"
                              "\"crc32\":3160323885}\n");
  assert_string_equal(events, "{\"t_ns\":77,\"event\":\"trigger\"}\n"
                              "{\"t_ns\":78,\"event\":\"note\",\"text\":\"a \\\"b\\\"\"}\n");
  assert_string_equal(instrument, original);
  placido_memory_free(frames);
  placido_memory_free(events);
  placido_memory_free(instrument);
  placido_memory_free(original);

  placido_session_reader *reader = open_session(path, NULL);
  assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
  assert_int_equal(frame.flags, PLACIDO_FRAME_TRUNCATED);
  assert_non_null(strstr(placido_session_reader_instrument(reader), "a.session/instrument.json"));
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
  free(path);
}

static void a_frame_of_another_kind_is_refused(void **state) {
  char *path = scratch_path(state, "a.session");
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  placido_session_writer *writer;
  placido_frame frame = {0};
  placido_error err;
  assert_int_equal(
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL), PLACIDO_OK);
  recording_fill(&frame, 0, PLACIDO_MONO16, 16, 8, 8);
  assert_int_equal(placido_session_writer_append(writer, &frame, NULL, &err), PLACIDO_INPUT);
  recording_fill(&frame, 0, PLACIDO_MONO8, 8, 8, 8);
  assert_int_equal(placido_session_writer_append(writer, &frame, NULL, &err), PLACIDO_OK);
  recording_fill(&frame, 0, PLACIDO_MONO8, 8, 9, 8);
  assert_int_equal(placido_session_writer_append(writer, &frame, NULL, &err), PLACIDO_INPUT);
  assert_string_equal(err.text, "a frame of 9 x 8 pixels in a session of 8 x 8");
  recording_fill(&frame, 0, PLACIDO_MONO8, 8, 3, 8); /* too narrow for the codec */
  assert_int_equal(placido_session_writer_append(writer, &frame, NULL, &err), PLACIDO_INPUT);
  assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  free(path);
}

static void times_that_stand_still_do_not_stop_the_recording(void **state) {
  char *path = scratch_path(state, "a.session");
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  placido_session_writer *writer;
  placido_frame frame = {0};
  assert_int_equal(
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL), PLACIDO_OK);
  static const int64_t times[] = {0, 0, 0, 900, 5, 2000000000, 1};
  for (int i = 0; i < 7; i++) {
    recording_fill(&frame, i, PLACIDO_MONO8, 8, 8, 8);
    frame.t_ns = times[i];
    assert_int_equal(placido_session_writer_append(writer, &frame, NULL, NULL), PLACIDO_OK);
  }
  assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
  placido_session_reader *reader = open_session(path, NULL);
  for (int i = 0; i < 7; i++) {
    assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
    assert_int_equal(frame.t_ns, times[i]);
  }
  placido_session_reader_close(reader);
  placido_frame_free(&frame);
  free(path);
}

/* The reference is zlib's crc32 of the same bytes, as Python has it. */
static void the_checksum_is_of_the_rows_without_padding(void **state) {
  static const uint16_t wide[] = {0x0102, 0xfffe};
  uint8_t narrow[] = {1, 2, 99, 3, 4, 99}, bytes[sizeof wide];
  (void)state;
  memcpy(bytes, wide, sizeof wide);
  const placido_frame padded = {
      .width_px = 2, .height_px = 2, .stride_bytes = 3, .format = PLACIDO_MONO8, .data = narrow};
  const placido_frame two = {
      .width_px = 2, .height_px = 1, .stride_bytes = 4, .format = PLACIDO_MONO16, .data = bytes};
  assert_int_equal(placido_frame_checksum(&padded), 0xb63cfbcd);
  assert_int_equal(placido_frame_checksum(&two), 0x2db25e1e);
}

static void other_codecs_are_not_recorded(void **state) {
  char *path = scratch_path(state, "a.session");
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  placido_session_writer *writer;
  placido_error err = {0};
  info.codec = PLACIDO_CODEC_OTHER;
  assert_int_equal(
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, &err),
      PLACIDO_INPUT);
  assert_null(writer);
  assert_string_equal(err.text,
                      "a session is recorded as ffv1, ffvhuff or raw, not in another codec");
  free(path);
}

static void a_session_is_never_written_over(void **state) {
  char *path = scratch_path(state, "a.session"), *folder = scratch_path(state, "");
  char *wrong = scratch_write_text(state, "wrong.json", "{}");
  char *fresh = scratch_path(state, "b.session"), *nowhere = scratch_path(state, "no/c.session");
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  placido_session_writer *writer;
  recording_make(path, 1, PLACIDO_MONO8, 8, 8, 8);
  assert_int_equal(
      placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL),
      PLACIDO_SYSTEM);
  assert_null(writer);
  assert_int_equal(
      placido_session_writer_create(&writer, nowhere, &info, RECORDING_INSTRUMENT, NULL),
      PLACIDO_SYSTEM);
  assert_int_equal(placido_session_writer_create(&writer, fresh, &info, wrong, NULL),
                   PLACIDO_INPUT);
  info.bits = 12;
  assert_int_equal(
      placido_session_writer_create(&writer, fresh, &info, RECORDING_INSTRUMENT, NULL),
      PLACIDO_INPUT);
  assert_int_equal(scratch_count(folder), 2); /* the first session and wrong.json */
  assert_int_equal(placido_session_writer_close(NULL, NULL), PLACIDO_OK);
  placido_session_reader_close(NULL);
  free(path);
  free(folder);
  free(wrong);
  free(fresh);
  free(nowhere);
}

/* Opens, reads and rewinds with the n-th allocation failing; OK where there were fewer. */
static int read_with_failure(const char *path, unsigned long n) {
  placido_session_reader *reader;
  placido_frame frame = {0};
  placido_memory_fail_at(n);
  int status = placido_session_reader_open(&reader, path, NULL, NULL);
  assert_true((reader != NULL) == (status == PLACIDO_OK));
  while (!status) {
    status = placido_session_reader_next(reader, &frame, NULL);
  }
  if (status == PLACIDO_END) {
    status = placido_session_reader_rewind(reader, NULL);
  }
  placido_memory_fail_at(0);
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
  return status;
}

static void every_allocation_of_reading_may_fail(void **state) {
  char *path = scratch_path(state, "a.session");
  recording_make(path, 2, PLACIDO_MONO8, 8, 8, 8);
  int status = PLACIDO_MEMORY;
  unsigned long n = 0;
  while (status == PLACIDO_MEMORY) {
    status = read_with_failure(path, ++n);
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 8);
  free(path);
}

static void every_allocation_of_writing_may_fail(void **state) {
  char *path = scratch_path(state, "a.session"), *folder = scratch_path(state, "");
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_session_writer *writer;
    placido_memory_fail_at(n);
    status = placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL);
    placido_memory_fail_at(0);
    assert_int_equal(scratch_count(folder), status ? 0 : 1); /* nothing half-written */
    placido_frame frame = {0};
    recording_fill(&frame, 0, PLACIDO_MONO8, 8, 8, 8);
    int appended = PLACIDO_MEMORY;
    for (unsigned long m = 1; !status && appended == PLACIDO_MEMORY; m++) {
      placido_memory_fail_at(m);
      appended = placido_session_writer_append(writer, &frame, NULL, NULL);
      placido_memory_fail_at(0);
    }
    assert_int_equal(appended, status ? PLACIDO_MEMORY : PLACIDO_OK);
    placido_frame_free(&frame);
    assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
  }
  assert_int_equal(status, PLACIDO_OK);
  free(path);
  free(folder);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(samples_times_and_counters_come_back),
      TEST(rewinding_gives_the_first_frame_again),
      TEST(the_description_comes_back),
      TEST(what_was_not_recorded_stays_unknown),
      TEST(the_logs_and_the_instrument_are_plain_files),
      TEST(a_frame_of_another_kind_is_refused),
      TEST(times_that_stand_still_do_not_stop_the_recording),
      TEST(the_checksum_is_of_the_rows_without_padding),
      TEST(other_codecs_are_not_recorded),
      TEST(a_session_is_never_written_over),
      TEST(every_allocation_of_reading_may_fail),
      TEST(every_allocation_of_writing_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
