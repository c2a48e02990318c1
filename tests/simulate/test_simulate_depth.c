/* Depth maps: whatever the file, a distance is a distance; what makes no sense is refused with its
 * pixel. Files are written here byte by byte, or (compressed ones) by OpenEXR's own library. */
#include "simulate/depth/map.h"
#include "tests/support/near.h"

#include <placido/scene.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WIDTH = 4, HEIGHT = 3, PIXELS = WIDTH * HEIGHT };

static char folder[] = "/tmp/placido-depth-XXXXXX", map_path[64], scene_path[64], picture_path[64];

/* What can be written exactly in every format, top row first. */
static const float distances_m[PIXELS] = {0.25f, 0.5f,  1, 2,     4, 8,
                                          16,    0.75f, 3, 0.125f, 6, INFINITY};

static int make_folder(void **state) {
  (void)state;
  if (mkdtemp(folder) == NULL) {
    return -1;
  }
  snprintf(map_path, sizeof map_path, "%s/map", folder);
  snprintf(scene_path, sizeof scene_path, "%s/scene.json", folder);
  snprintf(picture_path, sizeof picture_path, "%s/picture.png", folder);
  return 0;
}

static int remove_folder(void **state) {
  (void)state;
  remove(map_path);
  remove(scene_path);
  remove(picture_path);
  return rmdir(folder);
}

static placido_scene scene_of(int width, int height, int bleed) {
  placido_scene scene = {.bleed_px = bleed};
  scene.conditions.distance_m = 1;
  assert_int_equal(placido_image_new(&scene.image, width + 2 * bleed, height + 2 * bleed, 1, NULL),
                   PLACIDO_OK);
  return scene;
}

static void write_file(const char *path, const void *bytes, size_t size) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
}

static void put(unsigned char **at, unsigned long value, int bytes, bool little) {
  for (int i = 0; i < bytes; i++) {
    *(*at)++ = (unsigned char)(value >> 8 * (little ? i : bytes - 1 - i));
  }
}

static void put_sample(unsigned char **at, float sample, bool little) {
  uint32_t bits;
  memcpy(&bits, &sample, sizeof bits);
  put(at, bits, 4, little);
}

/* The scale, whose number says nothing, has the byte order as its sign. */
static void write_pfm(const float *metres, bool little) {
  unsigned char bytes[256], *at = bytes;
  at += sprintf((char *)at, "Pf\n%d %d\n%s\n", WIDTH, HEIGHT, little ? "-1.0" : "17");
  for (int y = HEIGHT - 1; y >= 0; y--) {
    for (int x = 0; x < WIDTH; x++) {
      put_sample(&at, metres[y * WIDTH + x], little);
    }
  }
  write_file(map_path, bytes, (size_t)(at - bytes));
}

static void put_text(unsigned char **at, const char *text) {
  memcpy(*at, text, strlen(text) + 1);
  *at += strlen(text) + 1;
}

static void put_attribute(unsigned char **at, const char *name, const char *type, int bytes) {
  put_text(at, name);
  put_text(at, type);
  put(at, (unsigned long)bytes, 4, true);
}

/* An uncompressed EXR of one float channel, by the letter of "OpenEXR File Layout"; its size. */
static long write_exr(const float *metres, const char *channel) {
  unsigned char bytes[1024], *at = bytes;
  put(&at, 20000630, 4, true);
  put(&at, 2, 4, true);
  put_attribute(&at, "channels", "chlist", (int)strlen(channel) + 1 + 16 + 1);
  put_text(&at, channel);
  put(&at, 2, 4, true); /* float */
  put(&at, 0, 4, true);
  put(&at, 1, 4, true);
  put(&at, 1, 4, true);
  put(&at, 0, 1, true);
  put_attribute(&at, "compression", "compression", 1);
  put(&at, 0, 1, true);
  const char *windows[2] = {"dataWindow", "displayWindow"};
  for (int i = 0; i < 2; i++) {
    put_attribute(&at, windows[i], "box2i", 16);
    put(&at, 0, 8, true);
    put(&at, WIDTH - 1, 4, true);
    put(&at, HEIGHT - 1, 4, true);
  }
  put_attribute(&at, "lineOrder", "lineOrder", 1);
  put(&at, 0, 1, true);
  put_attribute(&at, "pixelAspectRatio", "float", 4);
  put_sample(&at, 1, true);
  put_attribute(&at, "screenWindowCenter", "v2f", 8);
  put(&at, 0, 8, true);
  put_attribute(&at, "screenWindowWidth", "float", 4);
  put_sample(&at, 1, true);
  put(&at, 0, 1, true);
  unsigned long first = (unsigned long)(at - bytes) + 8 * HEIGHT, line = 8 + 4 * WIDTH;
  for (unsigned long y = 0; y < HEIGHT; y++) {
    put(&at, first + y * line, 8, true);
  }
  for (int y = 0; y < HEIGHT; y++) {
    put(&at, (unsigned long)y, 4, true);
    put(&at, 4 * WIDTH, 4, true);
    for (int x = 0; x < WIDTH; x++) {
      put_sample(&at, metres[y * WIDTH + x], true);
    }
  }
  write_file(map_path, bytes, (size_t)(at - bytes));
  return at - bytes;
}

/* One strip, no compression: baseline TIFF 6.0 with SampleFormat 3. */
static void write_tiff(const float *metres) {
  const unsigned long rows[][3] = {{256, 4, WIDTH}, {257, 4, HEIGHT}, {258, 3, 32}, {259, 3, 1},
                                   {262, 3, 1}, {273, 4, 160}, {277, 3, 1}, {278, 4, HEIGHT},
                                   {279, 4, 4 * PIXELS}, {339, 3, 3}};
  unsigned char bytes[512] = "II*", *at = bytes + 4;
  put(&at, 8, 4, true);
  put(&at, 10, 2, true);
  for (int i = 0; i < 10; i++) {
    put(&at, rows[i][0], 2, true);
    put(&at, rows[i][1], 2, true);
    put(&at, 1, 4, true);
    put(&at, rows[i][2], 4, true);
  }
  at = bytes + 160;
  for (int i = 0; i < PIXELS; i++) {
    put_sample(&at, metres[i], true);
  }
  write_file(map_path, bytes, (size_t)(at - bytes));
}

/* Millimetres; what is infinitely far is 0. */
static void write_png(const float *metres, int bits) {
  placido_image image;
  assert_int_equal(placido_image_new(&image, WIDTH, HEIGHT, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < PIXELS; i++) {
    image.data[i] = isinf(metres[i]) ? 0 : metres[i] * 1000 / 65535;
  }
  assert_int_equal(placido_image_save_png_bits(&image, bits, map_path, NULL), PLACIDO_OK);
  placido_image_free(&image);
}

/* False where this build reads no EXR, which it then has to say. */
static bool load(placido_scene *scene) {
  placido_error err = {0};
  int status = placido_depth_load(scene, map_path, &err);
  if (status == PLACIDO_INPUT && strstr(err.text, "this build reads no EXR") != NULL) {
    return false;
  }
  if (status != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return true;
}

static void test_every_format_gives_the_same_vergences(void **state) {
  (void)state;
  for (int format = 0; format < 6; format++) {
    placido_scene scene = scene_of(WIDTH, HEIGHT, 0);
    if (format < 2) {
      write_pfm(distances_m, format == 0);
    } else if (format < 4) {
      write_exr(distances_m, format == 2 ? "Z" : "whatever");
    } else if (format == 4) {
      write_tiff(distances_m);
    } else {
      write_png(distances_m, 16);
    }
    if (load(&scene)) {
      for (int i = 0; i < PIXELS; i++) {
        assert_near(scene.depth_D[i], 1 / (double)distances_m[i], 1e-7);
      }
    }
    placido_scene_free(&scene);
  }
}

/* Written by OpenEXR's library: half floats in two ZIP blocks, a window that begins at (3, -5), and
 * the layer's channel Depth.Z beside another one. */
static void test_compressed_layers_are_read(void **state) {
  (void)state;
  placido_scene scene = scene_of(20, 21, 0);
  placido_error err = {0};
  int status = placido_depth_load(&scene, PLACIDO_TEST_DATA "/depth/zip-half.exr", &err);
  if (status == PLACIDO_OK) {
    for (int y = 0; y < 21; y++) {
      for (int x = 0; x < 20; x++) {
        double metres = x == 4 && y == 2 ? INFINITY : 0.25 * (1 + x) + 8 * y;
        /* a half has 11 bits */
        assert_near(scene.depth_D[y * 20 + x] * (isinf(metres) ? 1 : metres), !isinf(metres), 5e-4);
      }
    }
  } else {
    assert_non_null(strstr(err.text, "this build reads no EXR"));
  }
  placido_scene_free(&scene);
}

static void test_the_rim_goes_on_over_the_bleed(void **state) {
  (void)state;
  const int bleed = 2, width = WIDTH + 4;
  placido_scene scene = scene_of(WIDTH, HEIGHT, bleed);
  write_pfm(distances_m, true);
  assert_true(load(&scene));
  for (int y = 0; y < HEIGHT + 4; y++) {
    for (int x = 0; x < width; x++) {
      int column = x < bleed ? 0 : x < bleed + WIDTH ? x - bleed : WIDTH - 1;
      int row = y < bleed ? 0 : y < bleed + HEIGHT ? y - bleed : HEIGHT - 1;
      double expected = 1 / (double)distances_m[row * WIDTH + column];
      assert_near(scene.depth_D[y * width + x], expected, 1e-7);
    }
  }
  assert_near(scene.conditions.distance_m, 1, 0);
  placido_scene_free(&scene);
}

static void expect_refusal(placido_scene *scene, const char *path, const char *words) {
  placido_error err = {0};
  assert_int_equal(placido_depth_load(scene, path, &err), PLACIDO_INPUT);
  if (strstr(err.text, words) == NULL && strstr(err.text, "this build reads no EXR") == NULL) {
    fail_msg("\"%s\" is expected in: %s", words, err.text);
  }
}

static void test_bad_distances_are_refused_with_their_pixel(void **state) {
  (void)state;
  const float bad[] = {NAN, 0, -1, 0.009f, -INFINITY};
  placido_scene scene = scene_of(WIDTH, HEIGHT, 0);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    float metres[PIXELS];
    memcpy(metres, distances_m, sizeof metres);
    metres[6] = bad[i];
    write_pfm(metres, true);
    expect_refusal(&scene, map_path, "pixel (2, 1)");
    write_exr(metres, "Z");
    expect_refusal(&scene, map_path, "pixel (2, 1)");
  }
  placido_scene_free(&scene);
}

static void test_what_is_no_depth_map_is_refused(void **state) {
  (void)state;
  placido_scene scene = scene_of(WIDTH, HEIGHT, 0), wide = scene_of(WIDTH + 1, HEIGHT, 0);
  write_pfm(distances_m, true);
  expect_refusal(&wide, map_path, "4 by 3 pixels, expected the picture's 5 by 3");
  assert_int_equal(truncate(map_path, 59), 0);
  expect_refusal(&scene, map_path, "ends before its last row");
  write_file(map_path, "Pf\n4 3\n", 7);
  expect_refusal(&scene, map_path, "its head makes no sense");
  long exr_bytes = write_exr(distances_m, "Z");
  expect_refusal(&wide, map_path, "4 by 3 pixels, expected the picture's 5 by 3");
  assert_int_equal(truncate(map_path, exr_bytes - 10), 0);
  expect_refusal(&scene, map_path, "the EXR file cannot be read");
  assert_int_equal(truncate(map_path, 90), 0);
  expect_refusal(&scene, map_path, "the EXR file cannot be read");
  write_png(distances_m, 16);
  expect_refusal(&wide, map_path, "4 by 3 pixels, expected the picture's 5 by 3");
  write_png(distances_m, 8);
  expect_refusal(&scene, map_path, "8 bits");
  write_file(map_path, "GIF89a", 6);
  expect_refusal(&scene, map_path, "no depth map");
  expect_refusal(&scene, PLACIDO_TEST_DATA "/depth/tiled.exr", "expected scan lines");
  assert_null(scene.depth_D);
  placido_scene_free(&scene);
  placido_scene_free(&wide);
}

static void test_holes_have_no_distance(void **state) {
  (void)state;
  placido_scene scene = {0};
  assert_int_equal(placido_image_new(&scene.image, WIDTH, HEIGHT, 4, NULL), PLACIDO_OK);
  write_pfm(distances_m, true);
  expect_refusal(&scene, map_path, "transparent");
  for (int i = 0; i < PIXELS; i++) {
    placido_image_plane(&scene.image, 3)[i] = 1;
  }
  assert_true(load(&scene));
  placido_scene_free(&scene);
}

static void write_scene(const char *more) {
  char text[256];
  int length = snprintf(text, sizeof text,
                        "{\"format\": \"placido-scene/1\", \"image\": \"picture.png\",\n"
                        "\"calibration\": {\"kind\": \"arcmin_per_px\", \"value\": 0.5}%s}", more);
  write_file(scene_path, text, (size_t)length);
}

/* The eye looks at the middle (2, 1), unless the scene says where. */
static void test_scene_files_bring_their_depth(void **state) {
  (void)state;
  placido_scene scene;
  placido_image picture;
  placido_error err = {0};
  assert_int_equal(placido_image_new(&picture, WIDTH, HEIGHT, 3, NULL), PLACIDO_OK);
  assert_int_equal(placido_image_save_png(&picture, picture_path, NULL), PLACIDO_OK);
  placido_image_free(&picture);
  write_pfm(distances_m, true);
  write_scene(", \"depth\": \"map\"");
  assert_int_equal(placido_scene_load(&scene, scene_path, 0, NULL, &err), PLACIDO_OK);
  assert_near(scene.conditions.distance_m, (double)distances_m[WIDTH + 2], 1e-5);
  assert_near(scene.depth_D[0], 4, 1e-6);
  placido_scene_free(&scene);
  write_scene(", \"depth\": \"map\", \"distance_m\": \"infinity\"");
  assert_int_equal(placido_scene_load(&scene, scene_path, 0, NULL, &err), PLACIDO_OK);
  assert_true(isinf(scene.conditions.distance_m));
  assert_non_null(scene.depth_D);
  placido_scene_free(&scene);
  write_scene(", \"distance_m\": 2");
  assert_int_equal(placido_scene_load(&scene, scene_path, 0, NULL, &err), PLACIDO_OK);
  assert_near(scene.conditions.distance_m, 2, 0);
  assert_null(scene.depth_D);
  placido_scene_free(&scene);
  write_scene(", \"depth\": \"nowhere.exr\"");
  assert_int_equal(placido_scene_load(&scene, scene_path, 0, NULL, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "nowhere.exr"));
}

/* A page at 33 cm that leans, a wall at 3 m, and what is outside of the window. */
static void test_the_page_stands_before_the_window(void **state) {
  (void)state;
  placido_scene scene;
  assert_int_equal(placido_scene_load(&scene, "page", 1, NULL, NULL), PLACIDO_OK);
  int width = scene.image.width_px, bleed = scene.bleed_px;
  const float *shown = scene.depth_D + (size_t)bleed * (size_t)width + bleed;
  assert_near(scene.conditions.distance_m, 0.33, 0);
  assert_near(shown[263 * width + 240], 1 / 0.33, 0.01); /* the page's middle */
  assert_near(shown[359 * width + 240] - shown[170 * width + 240], 0.2, 0.01);
  assert_near(shown[10 * width + 10], 1 / 3.0, 1e-6);    /* the wall */
  assert_near(shown[140 * width + 100], 0, 0);           /* a house */
  assert_near(scene.depth_D[0], 1 / 3.0, 1e-6);          /* the bleed */
  placido_scene_free(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_every_format_gives_the_same_vergences),
    cmocka_unit_test(test_compressed_layers_are_read),
    cmocka_unit_test(test_the_rim_goes_on_over_the_bleed),
    cmocka_unit_test(test_bad_distances_are_refused_with_their_pixel),
    cmocka_unit_test(test_what_is_no_depth_map_is_refused),
    cmocka_unit_test(test_holes_have_no_distance),
    cmocka_unit_test(test_scene_files_bring_their_depth),
    cmocka_unit_test(test_the_page_stands_before_the_window),
  };
  return cmocka_run_group_tests_name("simulate_depth", tests, make_folder, remove_folder);
}
