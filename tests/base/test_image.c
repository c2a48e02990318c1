/* Image files give the samples they hold: every depth, colour order, alpha and orientation; broken
 * ones are refused without a word on stderr. */
#include "base/file.h"
#include "base/memory.h"
#include "tests/base/scratch.h"

#include <placido/image.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A frame of a size with samples that all differ from their neighbours. */
static placido_frame pattern(int width_px, int height_px, enum placido_format format) {
  placido_frame frame = {0};
  assert_int_equal(placido_frame_resize(&frame, width_px, height_px, format, NULL), PLACIDO_OK);
  uint32_t value = 12345;
  for (size_t i = 0; i < frame.stride_bytes * (size_t)height_px; i++) {
    value = value * 1664525u + 1013904223u;
    frame.data[i] = (uint8_t)(value >> 24);
  }
  return frame;
}

static void assert_same_samples(const placido_frame *a, const placido_frame *b) {
  assert_int_equal(a->width_px, b->width_px);
  assert_int_equal(a->height_px, b->height_px);
  assert_int_equal(a->format, b->format);
  size_t row = (size_t)a->width_px * placido_format_bytes(a->format);
  for (int y = 0; y < a->height_px; y++) {
    assert_memory_equal(a->data + (size_t)y * a->stride_bytes,
                        b->data + (size_t)y * b->stride_bytes, row);
  }
}

static void frames_survive_a_png_bit_for_bit(void **state) {
  static const enum placido_format formats[] = {PLACIDO_MONO8, PLACIDO_MONO16, PLACIDO_RGB8};
  char *path = scratch_path(state, "frame.png"), *folder = scratch_path(state, "");
  placido_frame read = {0};
  for (size_t i = 0; i < 3; i++) {
    placido_frame frame = pattern(37, 21, formats[i]);
    placido_error err = {0};
    assert_int_equal(placido_frame_save_png(&frame, path, &err), PLACIDO_OK);
    assert_int_equal(placido_frame_load(&read, path, &err), PLACIDO_OK);
    assert_same_samples(&frame, &read);
    assert_int_equal(read.bits, formats[i] == PLACIDO_MONO16 ? 16 : 8);
    placido_frame_free(&frame);
  }
  assert_int_equal(scratch_count(folder), 1);
  placido_frame_free(&read);
  free(path);
  free(folder);
}

static void an_image_survives_a_png_with_its_planes_in_order(void **state) {
  static const int planes[] = {1, 3, 4};
  char *path = scratch_path(state, "image.png");
  for (size_t i = 0; i < 3; i++) {
    placido_image image, read;
    assert_int_equal(placido_image_new(&image, 5, 4, planes[i], NULL), PLACIDO_OK);
    for (int s = 0; s < 20 * planes[i]; s++) {
      image.data[s] = (float)(s * 3 + 1) / 255;
    }
    image.data[0] = -1;
    image.data[1] = 2;
    assert_int_equal(placido_image_save_png(&image, path, NULL), PLACIDO_OK);
    assert_int_equal(placido_image_load(&read, path, NULL), PLACIDO_OK);
    assert_int_equal(read.planes, planes[i]);
    assert_true(read.data[0] == 0 && read.data[1] == 1); /* clipped */
    for (int s = 2; s < 20 * planes[i]; s++) {
      assert_float_equal(read.data[s], image.data[s], 1e-6);
    }
    placido_image_free(&image);
    placido_image_free(&read);
  }
  free(path);
}

static void portable_maps_are_read_to_their_own_white(void **state) {
  static const unsigned char wide[] = "P5 # a comment\n2 1\n1023\n\x03\xff\x01\x00";
  static const unsigned char colour[] = "P6\n1 1\n255\n\xff\x80\x01";
  placido_image image;
  placido_frame frame = {0};
  char *path = scratch_write(state, "a.pgm", wide, sizeof wide - 1);
  assert_int_equal(placido_image_load(&image, path, NULL), PLACIDO_OK);
  assert_float_equal(image.data[0], 1, 1e-6);
  assert_float_equal(image.data[1], 256.0 / 1023, 1e-6);
  placido_image_free(&image);
  assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
  assert_int_equal(frame.format, PLACIDO_MONO16);
  assert_int_equal(frame.bits, 10);
  uint16_t first;
  memcpy(&first, frame.data, sizeof first);
  assert_int_equal(first, 1023);
  free(path);
  path = scratch_write(state, "a.ppm", colour, sizeof colour - 1);
  assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
  assert_int_equal(frame.format, PLACIDO_RGB8);
  assert_memory_equal(frame.data, "\xff\x80\x01", 3);
  placido_frame_free(&frame);
  free(path);
}

static void colour_of_16_bit_becomes_8(void **state) {
  static const unsigned char colour[] = "P6\n1 1\n65535\n\xff\xff\x80\x80\x00\x40";
  placido_frame frame = {0};
  char *path = scratch_write(state, "a.ppm", colour, sizeof colour - 1);
  assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
  assert_int_equal(frame.format, PLACIDO_RGB8);
  assert_memory_equal(frame.data, "\xff\x80\x00", 3);
  placido_frame_free(&frame);
  free(path);
}

/* One entry of a TIFF directory with a short value. */
static unsigned char *tiff_entry(unsigned char *p, unsigned tag, unsigned type, unsigned value) {
  const unsigned char entry[12] = {(unsigned char)tag,   (unsigned char)(tag >> 8),
                                   (unsigned char)type,  0, 1, 0, 0, 0,
                                   (unsigned char)value, (unsigned char)(value >> 8), 0, 0};
  memcpy(p, entry, sizeof entry);
  return p + sizeof entry;
}

/* A little-endian TIFF of 3 x 2 samples of 16 bit, 1 to 6 times 1000, with an orientation. */
static size_t make_tiff(unsigned char *bytes, unsigned orientation) {
  enum { SHORT = 3, LONG = 4, DATA = 8, DIRECTORY = 20 };
  memcpy(bytes, "II*\0", 4);
  const unsigned char directory_at[4] = {DIRECTORY, 0, 0, 0};
  memcpy(bytes + 4, directory_at, 4);
  for (unsigned i = 0; i < 6; i++) {
    unsigned value = (i + 1) * 1000;
    bytes[DATA + 2 * i] = (unsigned char)value;
    bytes[DATA + 2 * i + 1] = (unsigned char)(value >> 8);
  }
  unsigned char *p = bytes + DIRECTORY;
  *p++ = 10;
  *p++ = 0;
  p = tiff_entry(p, 256, SHORT, 3);            /* width */
  p = tiff_entry(p, 257, SHORT, 2);            /* height */
  p = tiff_entry(p, 258, SHORT, 16);           /* bits per sample */
  p = tiff_entry(p, 259, SHORT, 1);            /* not compressed */
  p = tiff_entry(p, 262, SHORT, 1);            /* 0 is black */
  p = tiff_entry(p, 273, LONG, DATA);          /* where the strip stands */
  p = tiff_entry(p, 274, SHORT, orientation);
  p = tiff_entry(p, 277, SHORT, 1);            /* samples per pixel */
  p = tiff_entry(p, 278, SHORT, 2);            /* rows per strip */
  p = tiff_entry(p, 279, LONG, 12);            /* bytes of the strip */
  memset(p, 0, 4);
  return (size_t)(p + 4 - bytes);
}

static void a_tiff_of_16_bit_is_read_upright(void **state) {
  unsigned char bytes[256];
  placido_frame frame = {0};
  uint16_t samples[6];
  char *path = scratch_write(state, "a.tif", bytes, make_tiff(bytes, 1));
  assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
  assert_int_equal(frame.format, PLACIDO_MONO16);
  assert_int_equal(frame.width_px, 3);
  memcpy(samples, frame.data, sizeof samples);
  for (int i = 0; i < 6; i++) {
    assert_int_equal(samples[i], (i + 1) * 1000);
  }
  free(path);
  path = scratch_write(state, "b.tif", bytes, make_tiff(bytes, 3)); /* turned by 180 degrees */
  assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
  memcpy(samples, frame.data, sizeof samples);
  for (int i = 0; i < 6; i++) {
    assert_int_equal(samples[i], (6 - i) * 1000);
  }
  placido_frame_free(&frame);
  free(path);
}

/* The test's JPEG, grey, 16 x 8, white in the quarter at the top left, with an EXIF orientation
 * behind its first two bytes. */
static char *write_turned_jpeg(void **state, unsigned char orientation) {
  const unsigned char exif[] = {0xff, 0xe1, 0, 34, 'E', 'x', 'i', 'f', 0, 0, 'I', 'I', '*', 0,
                                8, 0, 0, 0, 1, 0, 0x12, 0x01, 3, 0, 1, 0, 0, 0,
                                orientation, 0, 0, 0, 0, 0, 0, 0};
  char *jpeg;
  size_t size;
  assert_int_equal(placido_file_read(&jpeg, &size, PLACIDO_TEST_DATA "/corner.jpg", 0, NULL),
                   PLACIDO_OK);
  unsigned char bytes[4096];
  assert_true(size + sizeof exif <= sizeof bytes);
  memcpy(bytes, jpeg, 2);
  memcpy(bytes + 2, exif, sizeof exif);
  memcpy(bytes + 2 + sizeof exif, jpeg + 2, size - 2);
  placido_memory_free(jpeg);
  return scratch_write(state, "turned.jpg", bytes, size + sizeof exif);
}

static void exif_orientation_is_applied(void **state) {
  /* Where the white quarter comes to stand (EXIF 2.32, 4.6.4 A), and whether sides are swapped. */
  static const struct {
    bool right, low, swapped;
  } expected[] = {[1] = {0, 0, 0}, [2] = {1, 0, 0}, [3] = {1, 1, 0}, [4] = {0, 1, 0},
                  [5] = {0, 0, 1}, [6] = {1, 0, 1}, [7] = {1, 1, 1}, [8] = {0, 1, 1}};
  placido_frame frame = {0};
  for (unsigned char o = 1; o <= 8; o++) {
    char *path = write_turned_jpeg(state, o);
    assert_int_equal(placido_frame_load(&frame, path, NULL), PLACIDO_OK);
    assert_int_equal(frame.format, PLACIDO_MONO8); /* a grey JPEG stays grey */
    assert_int_equal(frame.width_px, expected[o].swapped ? 8 : 16);
    assert_int_equal(frame.height_px, expected[o].swapped ? 16 : 8);
    for (int corner = 0; corner < 4; corner++) {
      bool right = corner & 1, low = corner & 2;
      size_t x = right ? (size_t)frame.width_px - 2 : 1;
      size_t y = low ? (size_t)frame.height_px - 2 : 1;
      bool white = frame.data[y * frame.stride_bytes + x] > 128;
      assert_int_equal(white, right == expected[o].right && low == expected[o].low);
    }
    free(path);
  }
  placido_frame_free(&frame);
}

/* What the process printed to stderr while `path` was refused. */
static size_t printed_while_refusing(void **state, const char *path) {
  char *log = scratch_path(state, "stderr");
  fflush(stderr);
  int kept = dup(STDERR_FILENO);
  assert_non_null(freopen(log, "wb", stderr));
  placido_image image;
  placido_frame frame = {0};
  placido_error err = {0};
  int first = placido_image_load(&image, path, &err);
  int second = placido_frame_load(&frame, path, &err);
  fflush(stderr);
  dup2(kept, STDERR_FILENO);
  close(kept);
  assert_int_equal(first, PLACIDO_INPUT);
  assert_int_equal(second, PLACIDO_INPUT);
  assert_null(image.data);
  assert_null(frame.data);
  assert_true(strlen(err.text) > 10);
  char *text;
  size_t size;
  assert_int_equal(placido_file_read(&text, &size, log, 0, NULL), PLACIDO_OK);
  placido_memory_free(text);
  free(log);
  return size;
}

static void broken_files_are_refused_in_silence(void **state) {
  static const struct {
    const char *bytes;
    size_t size;
  } files[] = {
      {"", 0},
      {"words", 5},
      {"\x89PNG\r\n\x1a\n", 8},
      {"\xff\xd8\xff\xe0", 4},
      {"\xff\xd8\xff\xe0\xff\xd9", 6},
      {"II*\0\x08\0\0\0", 8},
      {"II*\0\x08\0\0\0\xff\xff", 10},
      {"II+\0\x08\0\0\0", 8},
      {"MM\0*\0\0\0\x08\0\1", 10},
      {"P5\n4 4\n255\nabc", 14},
      {"P5\n70000 4\n255\nabc", 18},
      {"P5\n4 4\n0\nabc", 12},
      {"P5\n", 3},
      {"P2\n2 2\n255\n1 2 x", 16},
      {"P6\n99999999999999999999 1\n255\n", 30},
      {"BM\0\0\0\0", 6},
  };
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    char *path = scratch_write(state, "broken", files[i].bytes, files[i].size);
    assert_int_equal(printed_while_refusing(state, path), 0);
    free(path);
  }
}

static void cut_files_are_refused_in_silence(void **state) {
  char *path = scratch_path(state, "whole.png");
  placido_frame frame = pattern(16, 16, PLACIDO_MONO8);
  assert_int_equal(placido_frame_save_png(&frame, path, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  const char *const sources[] = {path, PLACIDO_TEST_DATA "/corner.jpg"};
  for (size_t i = 0; i < 2; i++) {
    char *bytes;
    size_t size;
    assert_int_equal(placido_file_read(&bytes, &size, sources[i], 0, NULL), PLACIDO_OK);
    for (size_t cut = 1; cut < size; cut += 1 + size / 40) {
      char *torn = scratch_write(state, "torn", bytes, size - cut);
      assert_int_equal(printed_while_refusing(state, torn), 0);
      free(torn);
    }
    placido_memory_free(bytes);
  }
  free(path);
}

static void a_damaged_png_is_refused(void **state) {
  char *path = scratch_path(state, "whole.png"), *bytes;
  size_t size;
  placido_frame frame = pattern(16, 16, PLACIDO_MONO8);
  assert_int_equal(placido_frame_save_png(&frame, path, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  assert_int_equal(placido_file_read(&bytes, &size, path, 0, NULL), PLACIDO_OK);
  bytes[size / 2] ^= 1;
  free(path);
  path = scratch_write(state, "damaged.png", bytes, size);
  assert_int_equal(printed_while_refusing(state, path), 0);
  placido_memory_free(bytes);
  free(path);
}

/* PNG files whose chunks and checksums are right, and whose contents are not. */
static void lying_files_are_refused_in_silence(void **state) {
  static const struct {
    const char *bytes;
    size_t size;
  } files[] = {
      /* fewer rows than its head says */
      {"\211\120\116\107\015\012\032\012\000\000\000\015\111\110\104\122\000\000\000\004\000\000"
       "\000\004\010\000\000\000\000\214\232\301\242\000\000\000\013\111\104\101\124\170\234\143"
       "\140\000\001\000\000\006\000\001\376\214\147\310\000\000\000\000\111\105\116\104\256\102"
       "\140\202",
       68},
      /* no palette */
      {"\211\120\116\107\015\012\032\012\000\000\000\015\111\110\104\122\000\000\000\001\000\000"
       "\000\001\010\003\000\000\000\050\313\064\273\000\000\000\012\111\104\101\124\170\234\143"
       "\140\000\000\000\002\000\001\110\257\244\161\000\000\000\000\111\105\116\104\256\102\140"
       "\202",
       67},
      /* no width */
      {"\211\120\116\107\015\012\032\012\000\000\000\015\111\110\104\122\000\000\000\000\000\000"
       "\000\004\010\000\000\000\000\205\161\141\330\000\000\000\011\111\104\101\124\170\234\143"
       "\000\000\000\001\000\001\136\377\175\371\000\000\000\000\111\105\116\104\256\102\140\202",
       66},
      /* 3600 megapixels */
      {"\211\120\116\107\015\012\032\012\000\000\000\015\111\110\104\122\000\000\352\140\000\000"
       "\352\140\010\000\000\000\000\245\271\052\236\000\000\000\011\111\104\101\124\170\234\143"
       "\000\000\000\001\000\001\136\377\175\371\000\000\000\000\111\105\116\104\256\102\140\202",
       66},
  };
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    char *path = scratch_write(state, "lying.png", files[i].bytes, files[i].size);
    assert_int_equal(printed_while_refusing(state, path), 0);
    free(path);
  }
}

/* libjpeg would fill the lost half with grey: nothing that could be measured. */
static void a_jpeg_with_a_gap_is_refused_in_silence(void **state) {
  char *bytes;
  size_t size;
  const char *source = PLACIDO_TEST_DATA "/corner.jpg";
  assert_int_equal(placido_file_read(&bytes, &size, source, 0, NULL), PLACIDO_OK);
  memcpy(bytes + size - 10, "\xff\xd9", 2);
  char *path = scratch_write(state, "gap.jpg", bytes, size - 8);
  assert_int_equal(printed_while_refusing(state, path), 0);
  placido_memory_free(bytes);
  free(path);
}

static void a_missing_file_and_a_place_that_cannot_be_written_are_named(void **state) {
  char *path = scratch_path(state, "no/such.png");
  placido_image image;
  placido_frame frame = pattern(4, 4, PLACIDO_MONO8);
  placido_error err;
  assert_int_equal(placido_image_load(&image, path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "no/such.png"));
  assert_int_equal(placido_frame_save_png(&frame, path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "no/such.png"));
  placido_frame_free(&frame);
  free(path);
}

static void an_image_may_be_16384_wide(void **state) {
  char *path = scratch_path(state, "wide.png");
  placido_frame frame = {0}, read = {0};
  assert_int_equal(placido_frame_resize(&frame, 16384, 8, PLACIDO_RGB8, NULL), PLACIDO_OK);
  memset(frame.data, 7, frame.stride_bytes * 8);
  assert_int_equal(placido_frame_save_png(&frame, path, NULL), PLACIDO_OK);
  assert_int_equal(placido_frame_load(&read, path, NULL), PLACIDO_OK);
  assert_same_samples(&frame, &read);
  placido_frame_free(&frame);
  placido_frame_free(&read);
  free(path);
}

static void every_allocation_may_fail(void **state) {
  char *path = scratch_path(state, "a.png");
  placido_image image, read;
  assert_int_equal(placido_image_new(&image, 8, 8, 3, NULL), PLACIDO_OK);
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_memory_fail_at(n);
    status = placido_image_save_png(&image, path, NULL);
  }
  assert_int_equal(status, PLACIDO_OK);
  status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_memory_fail_at(n);
    status = placido_image_load(&read, path, NULL);
    assert_true((read.data != NULL) == (status == PLACIDO_OK));
  }
  placido_memory_fail_at(0);
  assert_int_equal(status, PLACIDO_OK);
  placido_image_free(&read);
  placido_image_free(&image);
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(frames_survive_a_png_bit_for_bit),
      TEST(an_image_survives_a_png_with_its_planes_in_order),
      TEST(portable_maps_are_read_to_their_own_white),
      TEST(colour_of_16_bit_becomes_8),
      TEST(a_tiff_of_16_bit_is_read_upright),
      TEST(exif_orientation_is_applied),
      TEST(broken_files_are_refused_in_silence),
      TEST(cut_files_are_refused_in_silence),
      TEST(a_damaged_png_is_refused),
      TEST(lying_files_are_refused_in_silence),
      TEST(a_jpeg_with_a_gap_is_refused_in_silence),
      TEST(a_missing_file_and_a_place_that_cannot_be_written_are_named),
      TEST(an_image_may_be_16384_wide),
      TEST(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
