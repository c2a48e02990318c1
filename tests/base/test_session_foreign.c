/* A session whose video the ffmpeg program wrote, with nothing but a hand-written session.json and
 * an instrument beside it, opens and gives ffmpeg's samples. */
#include "base/file.h"
#include "base/session/archive.h"
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
#include <sys/stat.h>

enum { FRAMES = 4, WIDTH = 40, HEIGHT = 24 };

/* Frames in a row as raw samples; returns the file's path. */
static char *write_raw(void **state, enum placido_format format, int bits) {
  char *path = scratch_path(state, "in.raw");
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  placido_frame frame = {0};
  for (int i = 0; i < FRAMES; i++) {
    recording_fill(&frame, i, format, bits, WIDTH, HEIGHT);
    size_t size = frame.stride_bytes * HEIGHT;
    assert_int_equal(fwrite(frame.data, 1, size, stream), size);
  }
  placido_frame_free(&frame);
  assert_int_equal(fclose(stream), 0);
  return path;
}

/* A session whose frames.mkv ffmpeg encodes; NULL where there is no ffmpeg on this machine. */
static char *make_session(void **state, const char *pixels, const char *encoder,
                          enum placido_format format, int bits, const char *description) {
  if (system("ffmpeg -version > /dev/null 2>&1") != 0) {
    return NULL;
  }
  char *session = scratch_path(state, "f.session"), *raw = write_raw(state, format, bits);
  mkdir(session, 0777);
  char command[3 * PLACIDO_PATH_MAX];
  snprintf(command, sizeof command,
           "ffmpeg -v error -nostdin -y -f rawvideo -pixel_format %s -video_size %dx%d "
           "-framerate 25 -i '%s' -c:v %s '%s/frames.mkv' && cp '%s' '%s/instrument.json'",
           pixels, WIDTH, HEIGHT, raw, encoder, session, RECORDING_INSTRUMENT, session);
  assert_int_equal(system(command), 0);
  free(scratch_write_text(state, "f.session/session.json", description));
  free(raw);
  return session;
}

#define BARE "{\"format\": \"placido-session/1\"}"

static void every_lossless_grey_codec_is_read(void **state) {
  static const struct {
    const char *pixels, *encoder;
    enum placido_format format;
    int bits;
    const char *description;
  } cases[] = {
      {"gray", "ffv1", PLACIDO_MONO8, 8, BARE},
      {"gray", "ffv1 -level 3 -slicecrc 1 -g 1", PLACIDO_MONO8, 8, BARE},
      {"gray", "ffv1 -level 1 -g 3", PLACIDO_MONO8, 8, BARE},
      {"gray", "ffv1 -level 3 -slicecrc 0", PLACIDO_MONO8, 8, BARE},
      {"gray", "ffvhuff", PLACIDO_MONO8, 8, BARE},
      {"gray", "rawvideo", PLACIDO_MONO8, 8, BARE},
      {"gray", "ffvhuff -context 1 -pred median", PLACIDO_MONO8, 8, BARE},
      {"gray", "png", PLACIDO_MONO8, 8, BARE},
      {"gray10le", "rawvideo -strict -1", PLACIDO_MONO16, 10, BARE},
      {"gray12le", "rawvideo -strict -1", PLACIDO_MONO16, 12, BARE},
      {"gray16le", "rawvideo -strict -1", PLACIDO_MONO16, 16, BARE},
      {"gray10le", "ffv1", PLACIDO_MONO16, 10, BARE},
      {"gray12le", "ffv1", PLACIDO_MONO16, 12, BARE},
      {"gray16le", "ffv1", PLACIDO_MONO16, 16, BARE},
      {"gray16le", "ffvhuff", PLACIDO_MONO16, 16, BARE},
      {"gray16le", "ffv1", PLACIDO_MONO16, 12,
       "{\"format\": \"placido-session/1\", \"pixel_format\": \"gray16le\", \"bit_depth\": 12}"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char *path = make_session(state, cases[i].pixels, cases[i].encoder, cases[i].format,
                              cases[i].bits, cases[i].description);
    if (!path) {
      skip();
    }
    placido_notes notes = {0};
    placido_session_reader *reader;
    placido_frame frame = {0};
    placido_error err = {0};
    if (placido_session_reader_open(&reader, path, &notes, &err)) {
      fail_msg("%s %s: %s", cases[i].pixels, cases[i].encoder, err.text);
    }
    assert_int_equal(notes.count, 0);
    assert_float_equal(placido_session_reader_info(reader)->rate_hz, 25, 1e-9);
    assert_int_equal(placido_session_reader_info(reader)->bits, cases[i].bits);
    for (int n = 0; n < FRAMES; n++) {
      assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
      recording_assert_frame(&frame, n, cases[i].format, cases[i].bits, WIDTH, HEIGHT);
      assert_int_equal(frame.seq, n);
      assert_int_equal(frame.t_ns, n * 40000000);
    }
    assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_END);
    placido_frame_free(&frame);
    placido_session_reader_close(reader);
    free(path);
  }
}

/* Without a log, the depth of the samples and the times are the video's own. */
static void a_foreign_session_is_packed_as_it_is(void **state) {
  static const struct {
    const char *pixels, *encoder;
    int bits;
  } cases[] = {{"gray10le", "rawvideo -strict -1", 10},
               {"gray12le", "rawvideo -strict -1", 12},
               {"gray16le", "ffvhuff", 16},
               {"gray16le", "ffv1 -level 3 -slicecrc 0", 16}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char *path =
        make_session(state, cases[i].pixels, cases[i].encoder, PLACIDO_MONO16, cases[i].bits, BARE);
    if (!path) {
      skip();
    }
    placido_pack_summary summary;
    placido_session_reader *reader;
    placido_frame frame = {0};
    placido_directory workshop;
    placido_error err = {0};
    int lock;
    assert_int_equal(placido_pack_begin(&lock, &workshop, path, NULL), PLACIDO_OK);
    if (placido_pack_video(&summary, path, workshop.temporary, &err)) {
      fail_msg("%s %s: %s", cases[i].pixels, cases[i].encoder, err.text);
    }
    assert_int_equal(placido_pack_commit(&workshop, path, NULL), PLACIDO_OK);
    placido_directory_discard(&workshop);
    placido_pack_end(lock);
    assert_int_equal(placido_session_reader_open(&reader, path, NULL, NULL), PLACIDO_OK);
    assert_int_equal(placido_session_reader_info(reader)->codec, PLACIDO_CODEC_FFV1);
    assert_int_equal(placido_session_reader_info(reader)->bits, cases[i].bits);
    assert_float_equal(placido_session_reader_info(reader)->rate_hz, 25, 1e-9);
    for (int n = 0; n < FRAMES; n++) {
      assert_int_equal(placido_session_reader_next(reader, &frame, NULL), PLACIDO_OK);
      recording_assert_frame(&frame, n, PLACIDO_MONO16, cases[i].bits, WIDTH, HEIGHT);
      assert_int_equal(frame.t_ns, n * 40000000);
    }
    placido_frame_free(&frame);
    placido_session_reader_close(reader);
    free(path);
  }
}

static void lossy_and_coloured_video_is_refused(void **state) {
  static const struct {
    const char *encoder, *said;
  } cases[] = {
      {"mjpeg -pix_fmt yuvj420p", "codec mjpeg is not one for lossless frames"},
      {"ffv1 -pix_fmt yuv420p", "has yuv420p pixels, gray of 8 to 16 bit is expected"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char *path = make_session(state, "gray", cases[i].encoder, PLACIDO_MONO8, 8, BARE);
    if (!path) {
      skip();
    }
    placido_session_reader *reader;
    placido_error err = {0};
    assert_int_equal(placido_session_reader_open(&reader, path, NULL, &err), PLACIDO_UNSUPPORTED);
    if (!strstr(err.text, cases[i].said)) {
      fail_msg("\"%s\" does not say \"%s\"", err.text, cases[i].said);
    }
    free(path);
  }
}

static void samples_other_than_described_are_noted(void **state) {
  char *path = make_session(
      state, "gray", "ffv1", PLACIDO_MONO8, 8,
      "{\"format\": \"placido-session/1\", \"pixel_format\": \"gray16le\", \"bit_depth\": 12}");
  if (!path) {
    skip();
  }
  placido_notes notes = {0};
  placido_session_reader *reader;
  assert_int_equal(placido_session_reader_open(&reader, path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "has 8-bit samples, which is not what session.json says"));
  assert_int_equal(placido_session_reader_info(reader)->bits, 8);
  placido_notes_clear(&notes);
  placido_session_reader_close(reader);
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(every_lossless_grey_codec_is_read),
      TEST(a_foreign_session_is_packed_as_it_is),
      TEST(lossy_and_coloured_video_is_refused),
      TEST(samples_other_than_described_are_noted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
