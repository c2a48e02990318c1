/* Pictures whose samples or files are not as they should be: floats that are no light, files cut
 * short anywhere, and sizes from one pixel to 16,384. */
#include "simulate/depth/map.h"
#include "simulate/scene_file.h"
#include "tests/base/scratch.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"
#include "tests/support/near.h"

#include <placido/scene.h>

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A little-endian TIFF of one plane in two strips, of 32-bit floats or of bytes. */
enum { WIDTH = 3, HEIGHT = 4, ENTRIES = 11, HEAD = 8, TIFF_MAX = 512 };
enum { DIRECTORY = 2 + 12 * ENTRIES + 4, ARRAYS = 16 };

static void put(unsigned char **at, unsigned long value, int bytes) {
  for (int i = 0; i < bytes; i++) {
    *(*at)++ = (unsigned char)(value >> (8 * i));
  }
}

/* Where the directory is: before the samples, behind them, or behind them without lists of strips,
 * as OpenCV writes small pictures in one strip. */
enum layout { BEFORE, BEHIND, LAST, LAYOUTS };

static const char *const layout_names[LAYOUTS] = {"before", "behind", "last"};

static size_t make_tiff(unsigned char bytes[TIFF_MAX], const void *samples, int bits,
                        enum layout layout) {
  const unsigned long pixels = (unsigned long)(WIDTH * HEIGHT * bits / 8);
  const unsigned long data = layout == BEFORE ? HEAD + DIRECTORY + ARRAYS : HEAD;
  const unsigned long directory = layout == BEFORE ? HEAD : HEAD + pixels;
  const unsigned long arrays = directory + DIRECTORY, strips = layout == LAST ? 1 : 2;
  const unsigned long offsets = layout == LAST ? data : arrays;
  const unsigned long lengths = layout == LAST ? pixels : arrays + 8;
  const unsigned long entries[ENTRIES][4] = {{256, 3, 1, WIDTH},
                                             {257, 3, 1, HEIGHT},
                                             {258, 3, 1, (unsigned long)bits},
                                             {259, 3, 1, 1},
                                             {262, 3, 1, 1},
                                             {273, 4, strips, offsets},
                                             {277, 3, 1, 1},
                                             {278, 3, 1, HEIGHT / strips},
                                             {279, 4, strips, lengths},
                                             {284, 3, 1, 1},
                                             {339, 3, 1, bits == 32 ? 3 : 1}};
  unsigned char *at = bytes;
  memset(bytes, 0, TIFF_MAX);
  memcpy(at, "II*\0", 4);
  at += 4;
  put(&at, directory, 4);
  at = bytes + directory;
  put(&at, ENTRIES, 2);
  for (int i = 0; i < ENTRIES; i++) {
    put(&at, entries[i][0], 2);
    put(&at, entries[i][1], 2);
    put(&at, entries[i][2], 4);
    put(&at, entries[i][3], 4);
  }
  if (layout != LAST) {
    at = bytes + arrays;
    put(&at, data, 4);
    put(&at, data + pixels / 2, 4);
    put(&at, pixels / 2, 4);
    put(&at, pixels / 2, 4);
  }
  memcpy(bytes + data, samples, pixels);
  return HEAD + DIRECTORY + (layout == LAST ? 0 : ARRAYS) + pixels;
}

static int load(placido_image *image, void **state, const void *bytes, size_t size,
                placido_notes *notes, placido_error *err) {
  char *path = scratch_write(state, "picture", bytes, size);
  int bits;
  int status = placido_photograph_load(image, &bits, path, notes, err);
  free(path);
  return status;
}

/* Light that is a number comes as it is, denormal or bright; below 0 it is dark and told. */
static void floats_come_as_they_are(void **state) {
  const float samples[WIDTH * HEIGHT] = {0,     FLT_TRUE_MIN, FLT_MIN, 0.5f, 1, 4e6f, -0.0f, -1,
                                         1e12f, FLT_MIN / 2,  0.25f,   1};
  for (int k = 0; k < LAYOUTS; k++) {
    unsigned char bytes[TIFF_MAX];
    placido_image image;
    placido_notes notes = {0};
    placido_error err = {0};
    size_t size = make_tiff(bytes, samples, 32, (enum layout)k);
    if (load(&image, state, bytes, size, &notes, &err) != PLACIDO_OK) {
      fail_msg("%s", err.text);
    }
    double worst = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
      worst = fmax(worst, fabs((double)image.data[i] - fmax((double)samples[i], 0)));
    }
    assert_int_equal(notes.count, 1);
    /* Nothing is computed: not a bit may differ. */
    case_bounded(&(struct bounded){NAN, NAN, NULL, worst, NULL, 0}, "float TIFF, directory %s",
                 layout_names[k]);
    placido_notes_clear(&notes);
    placido_image_free(&image);
  }
}

static void no_numbers_are_refused(void **state) {
  const float bad[] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 3; i++) {
    unsigned char bytes[TIFF_MAX];
    float samples[WIDTH * HEIGHT] = {[5] = bad[i]};
    placido_image image;
    placido_error err = {0};
    size_t size = make_tiff(bytes, samples, 32, BEHIND);
    int status = load(&image, state, bytes, size, NULL, &err);
    case_refused(status, PLACIDO_INPUT, &err, "1 samples are not numbers", "%g in a float TIFF",
                 (double)bad[i]);
    assert_null(image.data);
  }
}

/* Cut anywhere, also by one byte, a file is no picture: what is missing shall not be seen as dark.
 * OpenCV does not mind the last bytes of a directory. */
static void cut_files_are_refused(void **state) {
  static const float floats[WIDTH * HEIGHT] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  for (int k = 0; k < 2 * LAYOUTS; k++) {
    const int bits = k / LAYOUTS ? 8 : 32;
    unsigned char bytes[TIFF_MAX];
    size_t size = make_tiff(bytes, floats, bits, (enum layout)(k % LAYOUTS));
    placido_error err = {0};
    for (size_t left = size; left-- > 1;) {
      placido_image image;
      placido_error why = {0};
      int status = load(&image, state, bytes, left, NULL, &why);
      if (status != PLACIDO_INPUT) {
        fail_msg("%d bits, %zu of %zu bytes: status %d", bits, left, size, status);
      }
      err = left == size - 2 ? why : err;
    }
    case_refused(err.status, PLACIDO_INPUT, &err, "cut off",
                 "TIFF of %d bits, 2 bytes short, directory %s", bits,
                 layout_names[k % LAYOUTS]);
  }
}

/* Numbers in a directory that lead anywhere: any 4 bytes of it set to the largest number. */
static void wild_directories_do_no_harm(void **state) {
  const float samples[WIDTH * HEIGHT] = {0};
  unsigned char bytes[TIFF_MAX];
  size_t size = make_tiff(bytes, samples, 32, BEFORE), refused = 0;
  for (size_t at = 4; at + 4 <= HEAD + DIRECTORY + ARRAYS; at += 2) {
    unsigned char wild[TIFF_MAX];
    placido_image image;
    placido_error err = {0};
    memcpy(wild, bytes, sizeof wild);
    memset(wild + at, 0xff, 4);
    int status = load(&image, state, wild, size, NULL, &err);
    assert_true(status == PLACIDO_OK || (status == PLACIDO_INPUT && strlen(err.text) > 20));
    refused += status != PLACIDO_OK;
    placido_image_free(&image);
  }
  assert_true(refused > 10); /* width, height, format, places ... */
}

/* A scene that a program has put together goes the same way. */
static placido_scene scene_of(int width, int height, float light) {
  placido_scene scene = {.name = "made",
                         .arcmin_per_px = 0.5,
                         .conditions = {.luminance_cd_m2 = NAN,
                                        .distance_m = INFINITY,
                                        .wavelength_nm = NAN,
                                        .tolerance = 0.01}};
  assert_int_equal(placido_image_new(&scene.image, width, height, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < width * height; i++) {
    scene.image.data[i] = light;
  }
  return scene;
}

static void scenes_of_no_light_are_refused(void **state) {
  (void)state;
  const float bad[] = {NAN, INFINITY, 3e38f, -3e38f};
  double values[9] = {0, 0.1, 0, 0.1, 0.6, 0.1, 0, 0.1, 0};
  const placido_psf psf = {.n = 3, .bucket_arcmin = 0.5, .values = values};
  for (int i = 0; i < 4; i++) {
    placido_scene scene = scene_of(16, 8, 0.5f);
    placido_image seen;
    placido_error err = {0};
    scene.image.data[3 * 16 + 7] = bad[i];
    int status = placido_scene_see(&seen, &scene, &psf, 1, &err);
    case_refused(status, PLACIDO_INPUT, &err, "sample (7, 3) of plane 0", "%g in a scene",
                 (double)bad[i]);
    assert_null(seen.data);
    placido_scene_free(&scene);
  }
}

/* Distances that are none, in a map of floats. */
static void depths_that_are_no_distance_are_refused(void **state) {
  const float bad[] = {NAN, -INFINITY, -1, 0, FLT_TRUE_MIN};
  for (int i = 0; i < 5; i++) {
    const float metres[2] = {bad[i], 1};
    unsigned char bytes[32] = "Pf\n2 1\n-1\n";
    placido_scene scene = scene_of(2, 1, 1);
    placido_error err = {0};
    memcpy(bytes + 10, metres, sizeof metres);
    char *path = scratch_write(state, "depth.pfm", bytes, 10 + sizeof metres);
    int status = placido_depth_load(&scene, path, &err);
    case_refused(status, PLACIDO_INPUT, &err, "pixel (0, 0)", "depth of %g m", (double)bad[i]);
    free(path);
    for (size_t left = 1; left < 10 + sizeof metres; left++) {
      path = scratch_write(state, "cut.pfm", bytes, left);
      assert_int_equal(placido_depth_load(&scene, path, NULL), PLACIDO_INPUT);
      free(path);
    }
    placido_scene_free(&scene);
  }
}

/* Even light through a PSF of 5 by 5 even buckets is the share of these that meet the picture.
 * What is beside that is rounding: each of three transforms of N samples leaves at most epsilon
 * log2 N of its data's root mean square (Higham, Accuracy and Stability of Numerical Algorithms,
 * theorem 24.2), and here that is 0.5. */
static void any_size_is_seen(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1},   {2, 1},     {1, 2},   {1, 509}, {509, 1}, {7, 13},
                                 {97, 89}, {16384, 1}, {1, 16384}, {16384, 3}};
  double values[25] = {0};
  placido_psf psf = {.n = 5, .bucket_arcmin = 0.5, .values = values};
  for (int i = 0; i < 25; i++) {
    values[i] = 0.04;
  }
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    const int width = sizes[k][0], height = sizes[k][1];
    placido_scene scene = scene_of(width, height, 0.5f);
    placido_image seen;
    placido_error err = {0};
    if (placido_scene_see(&seen, &scene, &psf, 1, &err) != PLACIDO_OK) {
      fail_msg("%d by %d: %s", width, height, err.text);
    }
    double squares = 0;
    for (int y = 0; y < height; y++) {
      for (int x = 0; x < width; x++) {
        int across = (x < 2 ? x : 2) + 1 + (width - 1 - x < 2 ? width - 1 - x : 2);
        int down = (y < 2 ? y : 2) + 1 + (height - 1 - y < 2 ? height - 1 - y : 2);
        double off = seen.data[y * width + x] - 0.5 * 0.04 * across * down;
        squares += off * off;
      }
    }
    double samples = 4.0 * (width + 5) * (height + 5);
    case_bounded(&(struct bounded){1, FLT_EPSILON, NULL, sqrt(squares / width / height), NULL,
                                   3 * FLT_EPSILON * log2(samples) * 0.5},
                 "even light, %d by %d pixels", width, height);
    placido_image_free(&seen);
    placido_scene_free(&scene);
  }
  placido_scene wide = scene_of(16385, 1, 0.5f);
  placido_image seen;
  placido_error err = {0};
  int status = placido_scene_see(&seen, &wide, &psf, 1, &err);
  case_refused(status, PLACIDO_INPUT, &err, "16385", "even light, 16,385 pixels wide");
  placido_scene_free(&wide);
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Images: samples, files and sizes"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(floats_come_as_they_are, scratch_setup, scratch_teardown),
    cmocka_unit_test_setup_teardown(no_numbers_are_refused, scratch_setup, scratch_teardown),
    cmocka_unit_test_setup_teardown(cut_files_are_refused, scratch_setup, scratch_teardown),
    cmocka_unit_test_setup_teardown(wild_directories_do_no_harm, scratch_setup, scratch_teardown),
    cmocka_unit_test(scenes_of_no_light_are_refused),
    cmocka_unit_test_setup_teardown(depths_that_are_no_distance_are_refused, scratch_setup,
                                    scratch_teardown),
    cmocka_unit_test(any_size_is_seen),
    cmocka_unit_test(the_table_is_good)};
  return cmocka_run_group_tests_name("stability_images_samples", tests, NULL, NULL);
}
