/* Each pixel format becomes the samples that its layout says, bit by bit. */
#include "drivers/v4l2/convert.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 4
#define HEIGHT 3
#define STRIDE_MAX 16

static unsigned sample_at(const placido_frame *frame, int x, int y) {
  const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  uint16_t wide;
  memcpy(&wide, row + (frame->format == PLACIDO_MONO16 ? 2 * x : 0), sizeof wide);
  return frame->format == PLACIDO_MONO16 ? wide : row[x];
}

/* One row of bytes for each format, and the four samples that stand in it. */
static const struct {
  const char *name;
  uint8_t row[10];
  unsigned samples[WIDTH];
} layouts[] = {
    {"GREY", {1, 2, 3, 255}, {1, 2, 3, 255}},
    {"Y16", {1, 0, 0, 1, 0xff, 0xff, 0x34, 0x12}, {1, 256, 65535, 0x1234}},
    {"Y16_BE", {0, 1, 1, 0, 0xff, 0xff, 0x12, 0x34}, {1, 256, 65535, 0x1234}},
    {"Y12", {1, 0, 0xff, 0x0f, 0xff, 0xff, 0x34, 0x12}, {1, 4095, 4095, 0x234}},
    {"Y10", {1, 0, 0xff, 0x03, 0xff, 0xff, 0x34, 0x12}, {1, 1023, 1023, 0x234}},
    {"Y12P", {0xab, 0x12, 0x3c, 0xff, 0x00, 0x0f}, {0xabc, 0x123, 0xfff, 0x000}},
    {"Y10P", {0xff, 0x00, 0x80, 0x01, 0xe4}, {1020, 1, 514, 7}},
    {"Y10B", {0xff, 0xc0, 0x10, 0x08, 0x03}, {1023, 1, 2, 3}},
    {"YUYV", {10, 128, 20, 128, 30, 7, 40, 9}, {10, 20, 30, 40}},
    {"YVYU", {10, 128, 20, 128, 30, 7, 40, 9}, {10, 20, 30, 40}},
    {"UYVY", {128, 10, 128, 20, 7, 30, 9, 40}, {10, 20, 30, 40}},
    {"VYUY", {128, 10, 128, 20, 7, 30, 9, 40}, {10, 20, 30, 40}},
};

/* A picture of exactly as many bytes as it has: what lies behind is guarded by the sanitizer. */
static uint8_t *picture_of(const uint8_t *row, size_t row_bytes, size_t stride, size_t *size) {
  *size = stride * (HEIGHT - 1) + row_bytes;
  uint8_t *bytes = calloc(1, *size);
  assert_non_null(bytes);
  for (size_t y = 0; y < HEIGHT; y++) {
    memcpy(bytes + y * stride, row, row_bytes);
  }
  return bytes;
}

static void grey_formats_are_bit_exact(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
    const placido_v4l2_format *format = placido_v4l2_format_named(layouts[i].name);
    assert_non_null(format);
    const size_t row_bytes = placido_v4l2_row_bytes(format, WIDTH);
    for (size_t stride = row_bytes; stride <= row_bytes + 3; stride++) {
      size_t size;
      uint8_t *bytes = picture_of(layouts[i].row, row_bytes, stride, &size);
      placido_frame frame = {0};
      assert_int_equal(
          placido_v4l2_convert(&frame, format, WIDTH, HEIGHT, bytes, size, stride, NULL),
          PLACIDO_OK);
      assert_int_equal(frame.bits, format->bits);
      assert_int_equal(frame.format, format->bits > 8 ? PLACIDO_MONO16 : PLACIDO_MONO8);
      assert_int_equal(frame.flags, 0);
      for (int k = 0; k < WIDTH * HEIGHT; k++) {
        assert_int_equal(sample_at(&frame, k % WIDTH, k / WIDTH), layouts[i].samples[k % WIDTH]);
      }
      placido_frame_free(&frame);
      free(bytes);
    }
  }
}

/* Odd widths end within a group of packed pixels. */
static void every_width_stays_within_its_bytes(void **state) {
  (void)state;
  size_t count;
  const placido_v4l2_format *formats = placido_v4l2_formats(&count);
  for (size_t i = 0; i < count; i++) {
    for (int width = 1; formats[i].unpack && width <= 9; width++) {
      const size_t row_bytes = placido_v4l2_row_bytes(&formats[i], width);
      uint8_t *bytes = malloc(2 * row_bytes);
      assert_non_null(bytes);
      memset(bytes, 0xff, 2 * row_bytes);
      placido_frame frame = {0};
      assert_int_equal(placido_v4l2_convert(&frame, &formats[i], width, 2, bytes, 2 * row_bytes,
                                            row_bytes, NULL),
                       PLACIDO_OK);
      for (int k = 0; k < 2 * width; k++) {
        assert_int_equal(sample_at(&frame, k % width, k / width), (1u << formats[i].bits) - 1);
      }
      placido_frame_free(&frame);
      free(bytes);
    }
  }
}

static void missing_rows_are_black_and_flagged(void **state) {
  (void)state;
  const uint8_t bytes[12] = {9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9};
  const placido_v4l2_format *format = placido_v4l2_format_named("GREY");
  for (size_t size = 0; size <= 12; size++) {
    placido_frame frame = {0};
    assert_int_equal(placido_v4l2_convert(&frame, format, 4, 3, bytes, size, 4, NULL), PLACIDO_OK);
    assert_int_equal(frame.flags, size < 12 ? PLACIDO_FRAME_TRUNCATED : 0);
    for (int y = 0; y < 3; y++) {
      assert_int_equal(sample_at(&frame, 3, y), size >= 4 * (size_t)(y + 1) ? 9 : 0);
    }
    placido_frame_free(&frame);
  }
}

/* The colour of a filter of the mosaic: 0 red, 1 green, 2 blue. */
static int colour_at(const char *order, int x, int y) {
  const char letter = order[y % 2 * 2 + x % 2];
  return letter == 'R' ? 0 : letter == 'G' ? 1 : 2;
}

/* Under uniform light of red 40, green 100, blue 200 every pixel, borders too, has the luminance
 * (40 + 2 * 100 + 200) / 4 = 110, whatever the order of the colours. */
static void a_mosaic_gives_its_luminance_everywhere(void **state) {
  (void)state;
  static const char *const orders[] = {"RGGB", "GRBG", "GBRG", "BGGR"};
  static const uint8_t light[] = {40, 100, 200};
  for (size_t i = 0; i < 4; i++) {
    const char name[] = {'S', orders[i][0], orders[i][1], orders[i][2], orders[i][3], '8', 0};
    uint8_t mosaic[7 * 5];
    for (int k = 0; k < 35; k++) {
      mosaic[k] = light[colour_at(orders[i], k % 7, k / 7)];
    }
    placido_frame frame = {0};
    assert_int_equal(placido_v4l2_convert(&frame, placido_v4l2_format_named(name), 7, 5, mosaic,
                                          sizeof mosaic, 7, NULL),
                     PLACIDO_OK);
    for (int k = 0; k < 35; k++) {
      assert_int_equal(sample_at(&frame, k % 7, k / 7), 110);
    }
    placido_frame_free(&frame);
  }
}

/* The binomial kernel is symmetric, so that edges stay where they are: a point of 160 becomes
 * 10 20 10, 20 40 20, 10 20 10. */
static void a_point_of_a_mosaic_spreads_evenly(void **state) {
  (void)state;
  uint8_t mosaic[25] = {0};
  mosaic[12] = 160;
  placido_frame frame = {0};
  assert_int_equal(placido_v4l2_convert(&frame, placido_v4l2_format_named("SRGGB8"), 5, 5, mosaic,
                                        25, 5, NULL),
                   PLACIDO_OK);
  static const unsigned weights[] = {0, 1, 2, 1, 0};
  for (int k = 0; k < 25; k++) {
    assert_int_equal(sample_at(&frame, k % 5, k / 5), 10 * weights[k % 5] * weights[k / 5]);
  }
  placido_frame_free(&frame);
}

static void packed_and_wide_mosaics_agree(void **state) {
  (void)state;
  const uint8_t wide[] = {0xbc, 0x0a, 0x23, 0x01}, packed[] = {0xab, 0x12, 0x3c};
  placido_frame a = {0}, b = {0};
  assert_int_equal(placido_v4l2_convert(&a, placido_v4l2_format_named("SRGGB12"), 2, 1, wide, 4, 4,
                                        NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_v4l2_convert(&b, placido_v4l2_format_named("srggb12p"), 2, 1, packed, 3,
                                        3, NULL),
                   PLACIDO_OK);
  assert_memory_equal(a.data, b.data, 4);
  placido_frame_free(&a);
  placido_frame_free(&b);
}

static void what_cannot_be_read_is_refused(void **state) {
  (void)state;
  const uint8_t byte = 0;
  placido_frame frame = {0};
  const placido_v4l2_format *grey = placido_v4l2_format_named("grey");
  assert_int_equal(placido_v4l2_convert(&frame, grey, 0, 1, &byte, 1, 1, NULL), PLACIDO_INPUT);
  assert_null(placido_v4l2_format_named("XYZ"));
  assert_null(placido_v4l2_format_of(0));
  placido_frame_free(&frame);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(grey_formats_are_bit_exact),
      cmocka_unit_test(every_width_stays_within_its_bytes),
      cmocka_unit_test(missing_rows_are_black_and_flagged),
      cmocka_unit_test(a_mosaic_gives_its_luminance_everywhere),
      cmocka_unit_test(a_point_of_a_mosaic_spreads_evenly),
      cmocka_unit_test(packed_and_wide_mosaics_agree),
      cmocka_unit_test(what_cannot_be_read_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
