/* Each pixel format becomes the samples that its layout says, and mono samples become it again. */
#include "base/memory.h"
#include "drivers/u3v/wire/pixel.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 4
#define HEIGHT 3

static unsigned sample_at(const placido_frame *frame, int x, int y) {
  const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  uint16_t wide;
  if (frame->format == PLACIDO_MONO8) {
    return row[x];
  }
  memcpy(&wide, row + 2 * x, sizeof wide);
  return wide;
}

static void set_sample(placido_frame *frame, int x, int y, unsigned value) {
  uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  const uint16_t wide = (uint16_t)value;
  if (frame->format == PLACIDO_MONO8) {
    row[x] = (uint8_t)value;
  } else {
    memcpy(row + 2 * x, &wide, sizeof wide);
  }
}

/* One row of bytes for each format, and the four samples that stand in it, computed by hand. */
static const struct {
  const char *name;
  uint8_t row[12];
  unsigned samples[WIDTH];
} layouts[] = {
    {"Mono8", {1, 2, 3, 255}, {1, 2, 3, 255}},
    {"Mono16", {1, 0, 0, 1, 0xff, 0xff, 0x34, 0x12}, {1, 256, 65535, 0x1234}},
    {"Mono14", {1, 0, 0xff, 0x3f, 0, 0x20, 0x34, 0x12}, {1, 16383, 0x2000, 0x1234}},
    {"Mono12", {1, 0, 0xff, 0x0f, 0, 8, 0x34, 0x02}, {1, 4095, 0x800, 0x234}},
    {"Mono10", {1, 0, 0xff, 0x03, 0, 2, 0x34, 0x02}, {1, 1023, 0x200, 0x234}},
    {"Mono14p", {0xff, 0x7f, 0, 0, 0, 0xd2, 0x48}, {0x3fff, 1, 0x2000, 0x1234}},
    {"Mono12p", {0xbc, 0x3a, 0x12, 0xff, 0x0f, 0x00}, {0xabc, 0x123, 0xfff, 0x000}},
    {"Mono10p", {0xff, 0x07, 0x20, 0x40, 0xa9}, {0x3ff, 1, 2, 0x2a5}},
    {"Mono12Packed", {0xab, 0x3c, 0x12, 0xff, 0x0f, 0x00}, {0xabc, 0x123, 0xfff, 0x000}},
    {"Mono10Packed", {0xa9, 0x13, 0x56, 0x00, 0x30, 0xff}, {0x2a7, 0x159, 0x000, 0x3ff}},
    {"BayerRG8", {1, 2, 3, 255}, {1, 2, 3, 255}},
    {"BayerGB12p", {0xbc, 0x3a, 0x12, 0xff, 0x0f, 0x00}, {0xabc, 0x123, 0xfff, 0x000}},
    {"RGB8", {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}, {77, 149, 29, 255}},
    {"BGR8", {0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255}, {77, 149, 29, 255}},
    {"YUV422_8", {10, 128, 20, 128, 30, 7, 40, 9}, {10, 20, 30, 40}},
    {"YUV422_8_UYVY", {128, 10, 128, 20, 7, 30, 9, 40}, {10, 20, 30, 40}},
};

static const placido_pixel_format *format_of(size_t i) {
  const placido_pixel_format *format = placido_pixel_by_name(layouts[i].name);
  assert_non_null(format);
  return format;
}

/* A picture of exactly as many bytes as it has: what lies behind is guarded by the sanitizer. */
static uint8_t *picture_of(const uint8_t *row, size_t row_bytes, size_t stride, size_t *size) {
  *size = stride * (HEIGHT - 1) + row_bytes;
  uint8_t *bytes = malloc(*size);
  assert_non_null(bytes);
  memset(bytes, 0xee, *size);
  for (size_t y = 0; y < HEIGHT; y++) {
    memcpy(bytes + y * stride, row, row_bytes);
  }
  return bytes;
}

static void samples_are_bit_exact_whatever_the_padding(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
    const placido_pixel_format *format = format_of(i);
    const size_t row_bytes = placido_pixel_row_bytes(format, WIDTH);
    for (size_t stride = row_bytes; stride <= row_bytes + 3; stride++) {
      size_t size;
      uint8_t *bytes = picture_of(layouts[i].row, row_bytes, stride, &size);
      placido_frame frame = {0};
      assert_int_equal(
          placido_pixel_to_frame(&frame, format, bytes, size, WIDTH, HEIGHT, stride, NULL),
          PLACIDO_OK);
      assert_int_equal(frame.bits, format->bits);
      assert_int_equal(frame.format, format->bits > 8 ? PLACIDO_MONO16 : PLACIDO_MONO8);
      for (int k = 0; k < WIDTH * HEIGHT; k++) {
        assert_int_equal(sample_at(&frame, k % WIDTH, k / WIDTH), layouts[i].samples[k % WIDTH]);
      }
      placido_frame_free(&frame);
      free(bytes);
    }
  }
}

static void mono_frames_become_bit_exact_samples(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
    const placido_pixel_format *format = format_of(i);
    placido_frame frame = {0};
    assert_int_equal(placido_frame_resize(&frame, WIDTH, HEIGHT,
                                          format->bits > 8 ? PLACIDO_MONO16 : PLACIDO_MONO8, NULL),
                     PLACIDO_OK);
    frame.bits = format->bits;
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
      set_sample(&frame, k % WIDTH, k / WIDTH, layouts[i].samples[k % WIDTH]);
    }
    const size_t row_bytes = placido_pixel_row_bytes(format, WIDTH);
    uint8_t *bytes = malloc(row_bytes * HEIGHT);
    assert_non_null(bytes);
    const int status = placido_pixel_from_frame(bytes, format, &frame, NULL);
    const int is_mono = strncmp(format->name, "Mono", 4) == 0;
    assert_int_equal(status, is_mono ? PLACIDO_OK : PLACIDO_UNSUPPORTED);
    for (size_t y = 0; is_mono && y < HEIGHT; y++) {
      assert_memory_equal(bytes + y * row_bytes, layouts[i].row, row_bytes);
    }
    free(bytes);
    placido_frame_free(&frame);
  }
}

/* Sample x of a row whose bits follow each other from the lowest, bit by bit. */
static unsigned reference_sample(const uint8_t *row, int x, int bits) {
  unsigned sample = 0;
  for (int k = 0; k < bits; k++) {
    const int place = x * bits + k;
    sample |= (unsigned)(row[place / 8] >> place % 8 & 1) << k;
  }
  return sample;
}

/* Widths that end within a group, and such as are longer than what is packed at a time. */
static void every_width_goes_there_and_back(void **state) {
  (void)state;
  static const int widths[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 255, 256, 257, 258, 259, 515};
  size_t count;
  const placido_pixel_format *formats = placido_pixel_table(&count);
  for (size_t i = 0; i < count * (sizeof widths / sizeof *widths); i++) {
    const placido_pixel_format *format = &formats[i % count];
    const int width = widths[i / count];
    const size_t row_bytes = placido_pixel_row_bytes(format, width), size = 2 * row_bytes;
    uint8_t *bytes = malloc(size), *back = malloc(size);
    assert_true(bytes && back);
    for (size_t k = 0; k < size; k++) {
      bytes[k] = (uint8_t)(k * 151 + k / 7);
    }
    placido_frame frame = {0};
    assert_int_equal(placido_pixel_to_frame(&frame, format, bytes, size, width, 2, row_bytes, NULL),
                     PLACIDO_OK);
    for (int x = 0; format->packing == PLACIDO_PIXEL_LSB && x < width; x++) {
      assert_int_equal(sample_at(&frame, x, 1),
                       reference_sample(bytes + row_bytes, x, format->bits));
    }
    if (!placido_pixel_from_frame(back, format, &frame, NULL)) {
      placido_frame again = {0};
      assert_int_equal(
          placido_pixel_to_frame(&again, format, back, size, width, 2, row_bytes, NULL),
          PLACIDO_OK);
      assert_memory_equal(again.data, frame.data, 2 * frame.stride_bytes);
      placido_frame_free(&again);
    }
    placido_frame_free(&frame);
    free(bytes);
    free(back);
  }
}

static void bits_above_the_format_are_not_light(void **state) {
  (void)state;
  const uint8_t bytes[] = {0x34, 0xf2};
  placido_frame frame = {0};
  assert_int_equal(placido_pixel_to_frame(&frame, placido_pixel_by_name("Mono10"), bytes, 2, 1, 1,
                                          2, NULL),
                   PLACIDO_OK);
  assert_int_equal(sample_at(&frame, 0, 0), 0x234);
  placido_frame_free(&frame);
}

static void depths_are_scaled_by_shifts(void **state) {
  (void)state;
  static const struct {
    enum placido_format format;
    int bits;
    unsigned sample;
    const char *name;
    uint8_t bytes[2];
  } cases[] = {
      {PLACIDO_MONO8, 8, 0xc8, "Mono12", {0x80, 0x0c}},
      {PLACIDO_MONO8, 8, 0xff, "Mono16", {0x00, 0xff}},
      {PLACIDO_MONO16, 12, 0xabc, "Mono8", {0xab}},
      {PLACIDO_MONO16, 16, 0xabcd, "Mono10", {0xaf, 0x02}},
      {PLACIDO_MONO16, 10, 0x3ff, "Mono12Packed", {0xff, 0x0c}},
      {PLACIDO_MONO16, 10, 0xffff, "Mono12p", {0xfc, 0x0f}}, /* a sample beyond its bits */
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const placido_pixel_format *format = placido_pixel_by_name(cases[i].name);
    placido_frame frame = {0};
    assert_int_equal(placido_frame_resize(&frame, 1, 1, cases[i].format, NULL), PLACIDO_OK);
    frame.bits = cases[i].bits;
    set_sample(&frame, 0, 0, cases[i].sample);
    uint8_t bytes[2] = {0};
    assert_int_equal(placido_pixel_from_frame(bytes, format, &frame, NULL), PLACIDO_OK);
    assert_memory_equal(bytes, cases[i].bytes, 2);
    placido_frame_free(&frame);
  }
}

static void a_colour_frame_is_no_mono_picture(void **state) {
  (void)state;
  placido_frame frame = {0};
  placido_error err = {0};
  uint8_t bytes[8];
  assert_int_equal(placido_frame_resize(&frame, 2, 2, PLACIDO_RGB8, NULL), PLACIDO_OK);
  assert_int_equal(placido_pixel_from_frame(bytes, placido_pixel_by_name("Mono8"), &frame, &err),
                   PLACIDO_UNSUPPORTED);
  assert_non_null(strstr(err.text, "colour"));
  placido_frame_free(&frame);
}

static void too_few_bytes_are_refused(void **state) {
  (void)state;
  static const struct {
    size_t size, row_bytes;
    int width_px, height_px, status;
  } cases[] = {
      {18, 6, 4, 3, PLACIDO_OK},     {17, 6, 4, 3, PLACIDO_INPUT}, {18, 5, 4, 3, PLACIDO_INPUT},
      {18, 7, 4, 3, PLACIDO_INPUT},  {18, 0, 4, 3, PLACIDO_INPUT}, {0, 6, 4, 1, PLACIDO_INPUT},
      {18, 6, 0, 3, PLACIDO_INPUT},  {18, 6, 4, 0, PLACIDO_INPUT}, {18, 6, -1, 3, PLACIDO_INPUT},
      {18, SIZE_MAX, 4, 1, PLACIDO_OK},
      {18, SIZE_MAX, 4, 2, PLACIDO_INPUT},
      {18, 6, 65537, 1, PLACIDO_INPUT},
  };
  const placido_pixel_format *format = placido_pixel_by_name("Mono12p");
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    uint8_t *bytes = calloc(1, cases[i].size + 1);
    placido_frame frame = {0};
    assert_int_equal(placido_pixel_to_frame(&frame, format, bytes, cases[i].size,
                                            cases[i].width_px, cases[i].height_px,
                                            cases[i].row_bytes, NULL),
                     cases[i].status);
    placido_frame_free(&frame);
    free(bytes);
  }
}

static void no_memory_is_told(void **state) {
  (void)state;
  const uint8_t sample = 0;
  placido_frame frame = {0};
  placido_memory_fail_at(1);
  assert_int_equal(
      placido_pixel_to_frame(&frame, placido_pixel_by_name("Mono8"), &sample, 1, 1, 1, 1, NULL),
      PLACIDO_MEMORY);
  placido_memory_fail_at(0);
  placido_frame_free(&frame);
}

/* Plain mono, packed mono, Bayer, colour. */
static int class_of(const placido_pixel_format *format) {
  const int is_colour = format->code >> 24 == 2;
  return is_colour ? 3 : format->is_bayer ? 2 : format->packing != PLACIDO_PIXEL_PLAIN;
}

static void the_table_is_sound_and_in_order(void **state) {
  (void)state;
  size_t count;
  const placido_pixel_format *formats = placido_pixel_table(&count);
  assert_string_equal(formats[0].name, "Mono8");
  for (size_t i = 0; i < count; i++) {
    assert_ptr_equal(placido_pixel_by_code(formats[i].code), &formats[i]); /* also: it is unique */
    assert_ptr_equal(placido_pixel_by_name(formats[i].name), &formats[i]);
    /* the code itself tells the bits of a pixel (PFNC) */
    assert_int_equal(formats[i].bits_per_pixel, formats[i].code >> 16 & 0xff);
    assert_true(formats[i].bits >= 8 && formats[i].bits <= 16);
    assert_true(i == 0 || class_of(&formats[i - 1]) <= class_of(&formats[i]));
    assert_int_equal(placido_pixel_is_plain(&formats[i]),
                     formats[i].packing == PLACIDO_PIXEL_PLAIN);
  }
  assert_null(placido_pixel_by_code(0));
  assert_null(placido_pixel_by_name("Mono"));
  assert_null(placido_pixel_by_name(""));
  assert_int_equal(placido_pixel_by_name("BayerGR16")->code, 0x0110002E);
}

static void rows_are_filled_up_to_bytes(void **state) {
  (void)state;
  const placido_pixel_format *format = placido_pixel_by_name("Mono10p");
  static const size_t bytes[] = {0, 2, 3, 4, 5, 7};
  for (int width = 0; width < 6; width++) {
    assert_int_equal(placido_pixel_row_bytes(format, width), bytes[width]);
  }
  assert_int_equal(placido_pixel_row_bytes(format, -1), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(samples_are_bit_exact_whatever_the_padding),
      cmocka_unit_test(mono_frames_become_bit_exact_samples),
      cmocka_unit_test(every_width_goes_there_and_back),
      cmocka_unit_test(bits_above_the_format_are_not_light),
      cmocka_unit_test(depths_are_scaled_by_shifts),
      cmocka_unit_test(a_colour_frame_is_no_mono_picture),
      cmocka_unit_test(too_few_bytes_are_refused),
      cmocka_unit_test(no_memory_is_told),
      cmocka_unit_test(the_table_is_sound_and_in_order),
      cmocka_unit_test(rows_are_filled_up_to_bytes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
