/* Small recorded sessions for tests. */
#include "tests/base/recording.h"

#include "base/file.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

void recording_fill(placido_frame *frame, int index, enum placido_format format, int bits,
                    int width_px, int height_px) {
  assert_int_equal(placido_frame_resize(frame, width_px, height_px, format, NULL), PLACIDO_OK);
  uint32_t value = (uint32_t)index * 7919u + 1;
  for (int y = 0; y < height_px; y++) {
    uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    for (int x = 0; x < width_px; x++) {
      value = value * 1664525u + 1013904223u;
      if (format == PLACIDO_MONO16) {
        uint16_t sample = (uint16_t)(value >> (32 - bits));
        memcpy(row + 2 * x, &sample, sizeof sample);
      } else {
        row[x] = (uint8_t)(value >> 24);
      }
    }
  }
  frame->bits = bits;
  frame->t_ns = 5000000123 + (int64_t)index * 40000007;
  frame->seq = 1000 + (uint64_t)index;
  frame->flags = 0;
}

void recording_assert_frame(const placido_frame *frame, int index, enum placido_format format,
                            int bits, int width_px, int height_px) {
  placido_frame expected = {0};
  recording_fill(&expected, index, format, bits, width_px, height_px);
  assert_int_equal(frame->format, format);
  assert_int_equal(frame->bits, bits);
  assert_int_equal(frame->width_px, width_px);
  assert_int_equal(frame->height_px, height_px);
  for (int y = 0; y < height_px; y++) {
    assert_memory_equal(frame->data + (size_t)y * frame->stride_bytes,
                        expected.data + (size_t)y * expected.stride_bytes,
                        (size_t)width_px * placido_format_bytes(format));
  }
  placido_frame_free(&expected);
}

placido_session_info recording_info(enum placido_format format, int bits) {
  return (placido_session_info){
      .format = format, .bits = bits, .rate_hz = 25, .axis_z_mm = NAN, .axis_z_sigma_mm = NAN};
}

void recording_make(const char *path, int count, enum placido_format format, int bits,
                    int width_px, int height_px) {
  recording_make_in(PLACIDO_CODEC_FFV1, path, count, format, bits, width_px, height_px);
}

void recording_make_in(enum placido_session_codec codec, const char *path, int count,
                       enum placido_format format, int bits, int width_px, int height_px) {
  placido_session_info info = recording_info(format, bits);
  info.codec = codec;
  placido_session_writer *writer;
  placido_frame frame = {0};
  placido_error err = {0};
  if (placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, &err)) {
    fail_msg("%s", err.text);
  }
  for (int i = 0; i < count; i++) {
    recording_fill(&frame, i, format, bits, width_px, height_px);
    if (placido_session_writer_append(writer, &frame, NULL, &err)) {
      fail_msg("%s", err.text);
    }
  }
  placido_frame_free(&frame);
  assert_int_equal(placido_session_writer_close(writer, &err), PLACIDO_OK);
}

char *recording_take(const char *session, const char *name, size_t *size) {
  char path[PLACIDO_PATH_MAX], *bytes;
  assert_int_equal(placido_path_join(path, session, name, NULL), PLACIDO_OK);
  assert_int_equal(placido_file_read(&bytes, size, path, 0, NULL), PLACIDO_OK);
  return bytes;
}

void recording_put(const char *session, const char *name, const char *bytes, size_t size) {
  char path[PLACIDO_PATH_MAX];
  assert_int_equal(placido_path_join(path, session, name, NULL), PLACIDO_OK);
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  assert_int_equal(fwrite(bytes, 1, size, stream), size);
  assert_int_equal(fclose(stream), 0);
}
