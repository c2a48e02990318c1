/* Photographs: depth of bits and alpha survive, holes leave no dark fringes, floats are light. */
#include "base/memory.h"
#include "simulate/scene_file.h"
#include "tests/support/near.h"

#include <placido/scene.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/placido-photograph-XXXXXX", path[64];

static int make_folder(void **state) {
  (void)state;
  if (mkdtemp(folder) == NULL) {
    return -1;
  }
  snprintf(path, sizeof path, "%s/picture", folder);
  return 0;
}

static int remove_folder(void **state) {
  (void)state;
  remove(path);
  return rmdir(folder);
}

static placido_image even(int width_px, int height_px, int planes, const float *values) {
  placido_image image;
  assert_int_equal(placido_image_new(&image, width_px, height_px, planes, NULL), PLACIDO_OK);
  for (int plane = 0; plane < planes; plane++) {
    for (int i = 0; i < width_px * height_px; i++) {
      placido_image_plane(&image, plane)[i] = values[plane];
    }
  }
  return image;
}

static void put(unsigned char **at, unsigned long value, int bytes) {
  for (int i = 0; i < bytes; i++) {
    *(*at)++ = (unsigned char)(value >> (8 * i));
  }
}

/* An uncompressed little-endian TIFF of one strip. `extra` is the tag ExtraSamples, 0: none. */
static void write_tiff(const void *samples, int width, int height, int channels, int bits,
                       int extra) {
  const unsigned long sample_format = bits == 32 ? 3 : 1;
  unsigned long bytes = (unsigned long)(width * height * channels * bits / 8);
  unsigned char head[256], *at = head;
  const unsigned long data = 192;
  const unsigned long rows[][4] = {
    {256, 4, 1, (unsigned long)width},
    {257, 4, 1, (unsigned long)height},
    {258, 3, (unsigned long)channels, channels > 2 ? 160 : (unsigned long)bits},
    {259, 3, 1, 1},
    {262, 3, 1, channels > 1 ? 2 : 1},
    {273, 4, 1, data},
    {277, 3, 1, (unsigned long)channels},
    {278, 4, 1, (unsigned long)height},
    {279, 4, 1, bytes},
    {284, 3, 1, 1},
    {338, 3, 1, (unsigned long)extra},
    {339, 3, (unsigned long)channels, channels > 2 ? 168 : sample_format}};
  memset(head, 0, sizeof head);
  memcpy(at, "II*\0", 4);
  at += 4;
  put(&at, 8, 4);
  put(&at, extra > 0 ? 12 : 11, 2);
  for (int i = 0; i < 12; i++) {
    if (rows[i][0] != 338 || extra > 0) {
      put(&at, rows[i][0], 2);
      put(&at, rows[i][1], 2);
      put(&at, rows[i][2], 4);
      put(&at, rows[i][3], 4);
    }
  }
  at = head + 160;
  for (int i = 0; i < channels; i++) {
    put(&at, (unsigned long)bits, 2);
  }
  at = head + 168;
  for (int i = 0; i < channels; i++) {
    put(&at, sample_format, 2);
  }
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(head, 1, data, file), data);
  assert_int_equal(fwrite(samples, 1, bytes, file), bytes);
  assert_int_equal(fclose(file), 0);
}

/* Every value of 8 and of 16 bits comes back as itself from sRGB to light to sRGB to a file. */
static void test_every_value_survives_the_round_trip(void **state) {
  (void)state;
  static const struct {
    int bits, width, height;
  } rows[] = {{8, 16, 16}, {16, 256, 256}};
  for (int k = 0; k < 2; k++) {
    const int count = rows[k].width * rows[k].height;
    placido_image image, back;
    int bits = 0;
    assert_int_equal(placido_image_new(&image, rows[k].width, rows[k].height, 4, NULL),
                     PLACIDO_OK);
    for (int i = 0; i < 4 * count; i++) {
      image.data[i] = (float)((i + i / count * 7) % count) / (float)(count - 1);
    }
    assert_int_equal(placido_image_save_png_bits(&image, rows[k].bits, path, NULL), PLACIDO_OK);
    assert_int_equal(placido_photograph_load(&back, &bits, path, NULL, NULL), PLACIDO_OK);
    assert_int_equal(bits, rows[k].bits);
    assert_int_equal(back.planes, 4);
    placido_image_to_srgb(&back);
    for (int i = 0; i < 4 * count; i++) {
      assert_int_equal(lrintf(back.data[i] * (float)(count - 1)),
                       lrintf(image.data[i] * (float)(count - 1)));
    }
    placido_image_free(&image);
    placido_image_free(&back);
  }
}

/* A fifth of the light in each neighbour and in the middle. */
static double cross[9] = {0, 0.2, 0, 0.2, 0.2, 0.2, 0, 0.2, 0};
static const placido_psf cross_psf = {.n = 3, .bucket_arcmin = 0.5, .values = cross};

static placido_scene scene_of(placido_image image, double arcmin_per_px) {
  return (placido_scene){.name = "x", .image = image, .arcmin_per_px = arcmin_per_px, .bits = 8};
}

/* A bright disc on nothing: its colour stays the same right across the soft rim, where alpha falls.
 * Nothing is black here, so that a fringe would show. Resampled or not. */
static void test_holes_leave_no_dark_fringes(void **state) {
  (void)state;
  const float nothing[4] = {0, 0, 0, 0}, colour[3] = {0.9f, 0.5f, 0.2f};
  for (int k = 0; k < 2; k++) {
    placido_image image = even(40, 40, 4, nothing), seen;
    for (int i = 0; i < 1600; i++) {
      if (hypot(i % 40 - 20, i / 40 - 20) < 11) {
        for (int plane = 0; plane < 3; plane++) {
          placido_image_plane(&image, plane)[i] = colour[plane];
        }
        placido_image_plane(&image, 3)[i] = 1;
      }
    }
    placido_scene scene = scene_of(image, k == 0 ? 0.5 : 0.3);
    assert_int_equal(placido_scene_see(&seen, &scene, &cross_psf, 1, NULL), PLACIDO_OK);
    int soft = 0;
    const float *alpha = placido_image_plane(&seen, 3);
    for (int i = 0; i < seen.width_px * seen.height_px; i++) {
      soft += alpha[i] > 0.1f && alpha[i] < 0.9f;
      for (int plane = 0; plane < 3 && alpha[i] > 0.01f; plane++) {
        assert_near(placido_image_plane(&seen, plane)[i], colour[plane], 1e-4);
      }
    }
    assert_true(soft > 20);
    placido_image_free(&seen);
    placido_image_free(&image);
  }
}

/* Whole pictures are seen as without alpha, and stay whole. */
static void test_opaque_alpha_changes_nothing(void **state) {
  (void)state;
  const float light[4] = {0.2f, 0.4f, 0.6f, 1};
  placido_image with = even(20, 10, 4, light), without = even(20, 10, 3, light), seen, expected;
  placido_scene one = scene_of(with, 0.5), other = scene_of(without, 0.5);
  assert_int_equal(placido_scene_see(&seen, &one, &cross_psf, 1, NULL), PLACIDO_OK);
  assert_int_equal(placido_scene_see(&expected, &other, &cross_psf, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < 3 * 200; i++) {
    assert_near(seen.data[i], expected.data[i], 1e-6);
  }
  for (int i = 0; i < 200; i++) {
    assert_true(placido_image_plane(&seen, 3)[i] == 1);
  }
  placido_image_free(&with);
  placido_image_free(&without);
  placido_image_free(&seen);
  placido_image_free(&expected);
}

/* One pixel, one row, one column, prime sides: a scale of 0.37' that fits no whole bucket. */
static void test_odd_sizes_are_seen(void **state) {
  (void)state;
  const int sizes[][2] = {{1, 1}, {97, 1}, {1, 89}, {31, 17}};
  const float grey[1] = {0.5f};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    placido_image image = even(sizes[i][0], sizes[i][1], 1, grey), seen;
    placido_scene scene = scene_of(image, 0.37);
    assert_int_equal(placido_scene_see(&seen, &scene, &cross_psf, 2, NULL), PLACIDO_OK);
    assert_int_equal(seen.width_px, (int)fmax(round(sizes[i][0] * 0.74), 1));
    assert_int_equal(seen.height_px, (int)fmax(round(sizes[i][1] * 0.74), 1));
    int middle = seen.height_px / 2 * seen.width_px + seen.width_px / 2;
    /* Dark beyond the rim: a row loses the two neighbours that it has not. */
    double lost = (sizes[i][0] == 1 ? 0.4 : 0) + (sizes[i][1] == 1 ? 0.4 : 0);
    assert_near(seen.data[middle], 0.5 * (1 - lost), 1e-5);
    placido_image_free(&seen);
    placido_image_free(&image);
  }
}

/* Light above white stays: headlights. Below 0 counts as dark, and is told. */
static void test_floats_are_linear_light(void **state) {
  (void)state;
  const float samples[4] = {0.25f, 40, -0.001f, 1};
  placido_notes notes = {0};
  placido_image image;
  int bits = 0;
  write_tiff(samples, 2, 2, 1, 32, 0);
  assert_int_equal(placido_photograph_load(&image, &bits, path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(bits, 32);
  assert_true(image.data[0] == 0.25f && image.data[1] == 40 && image.data[2] == 0);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "1 samples are below 0"));
  placido_notes_clear(&notes);
  placido_image_free(&image);
}

static void test_samples_that_are_no_numbers_are_counted(void **state) {
  (void)state;
  const float samples[6] = {0.25f, NAN, INFINITY, 1, 0, 0.5f};
  placido_error err = {0};
  placido_image image;
  int bits;
  write_tiff(samples, 2, 1, 3, 32, 0);
  assert_int_equal(placido_photograph_load(&image, &bits, path, NULL, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "2 samples are not numbers"));
  assert_null(image.data);
  assert_int_equal(placido_image_load(&image, path, &err), PLACIDO_INPUT); /* 0..1 is promised */
  assert_non_null(strstr(err.text, "8 or 16 bit"));
}

/* Whichever allocation fails, seeing says so and leaves nothing behind. */
static void test_running_out_of_memory_is_an_error(void **state) {
  (void)state;
  const float half[4] = {0.5f, 0.5f, 0.5f, 0.5f};
  placido_image image = even(20, 10, 4, half), seen;
  placido_scene scene = scene_of(image, 0.3);
  unsigned long failed = 0;
  int status = PLACIDO_MEMORY;
  while (status == PLACIDO_MEMORY) {
    placido_memory_fail_at(++failed);
    status = placido_scene_see(&seen, &scene, &cross_psf, 1, NULL);
    assert_true(status == PLACIDO_OK || seen.data == NULL);
  }
  placido_memory_fail_at(0);
  assert_int_equal(status, PLACIDO_OK);
  assert_true(failed > 10);
  placido_image_free(&seen);
  placido_image_free(&image);
}

/* 8 bits: libtiff multiplies by alpha, which costs at most half a step over alpha. 16 bits: the tag
 * says whether the file did. */
static void test_tiff_colours_are_not_left_multiplied(void **state) {
  (void)state;
  const unsigned char bytes[4] = {200, 100, 50, 128};
  const unsigned short plain[4] = {51400, 25700, 12850, 32896};
  const unsigned short multiplied[4] = {25800, 12900, 6450, 32896};
  const struct {
    const void *samples;
    int bits, extra;
  } rows[] = {{bytes, 8, 2}, {plain, 16, 2}, {multiplied, 16, 1}};
  for (size_t i = 0; i < 3; i++) {
    placido_image image;
    int bits;
    write_tiff(rows[i].samples, 1, 1, 4, rows[i].bits, rows[i].extra);
    assert_int_equal(placido_image_load_bits(&image, &bits, path, NULL), PLACIDO_OK);
    assert_int_equal(bits, rows[i].bits);
    for (int plane = 0; plane < 4; plane++) {
      assert_near(image.data[plane] * 255, bytes[plane], rows[i].bits == 8 ? 1.01 : 0.01);
    }
    placido_image_free(&image);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_every_value_survives_the_round_trip),
    cmocka_unit_test(test_holes_leave_no_dark_fringes),
    cmocka_unit_test(test_opaque_alpha_changes_nothing),
    cmocka_unit_test(test_odd_sizes_are_seen),
    cmocka_unit_test(test_floats_are_linear_light),
    cmocka_unit_test(test_samples_that_are_no_numbers_are_counted),
    cmocka_unit_test(test_running_out_of_memory_is_an_error),
    cmocka_unit_test(test_tiff_colours_are_not_left_multiplied),
  };
  return cmocka_run_group_tests_name("simulate_photograph", tests, make_folder, remove_folder);
}
