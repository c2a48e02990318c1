/* Scene files: calibrations worked out by hand, photographs in linear light, refusals. */
#include "eyes.h"
#include "tests/support/near.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/placido-scene-XXXXXX";

static int make_folder(void **state) {
  (void)state;
  placido_image image;
  char path[64];
  if (mkdtemp(folder) == NULL || placido_image_new(&image, 40, 20, 3, NULL) != PLACIDO_OK) {
    return -1;
  }
  for (int i = 0; i < 40 * 20 * 3; i++) {
    image.data[i] = 188 / 255.0f;
  }
  snprintf(path, sizeof path, "%s/photo.png", folder);
  int status = placido_image_save_png(&image, path, NULL);
  placido_image_free(&image);
  return status;
}

static int remove_folder(void **state) {
  (void)state;
  char path[64];
  snprintf(path, sizeof path, "%s/photo.png", folder);
  remove(path);
  snprintf(path, sizeof path, "%s/scene.json", folder);
  remove(path);
  return rmdir(folder);
}

/* Loads a scene whose fields behind the format are `body`. */
static int load(placido_scene *scene, const char *body, placido_notes *notes, placido_error *err) {
  char path[64];
  snprintf(path, sizeof path, "%s/scene.json", folder);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fprintf(file, "{\n \"format\": \"placido-scene/1\",\n%s\n}\n", body);
  fclose(file);
  return placido_scene_load(scene, path, 0, notes, err);
}

static void expect_scale(const char *calibration, double arcmin) {
  placido_scene scene;
  placido_error err = {0};
  char body[256];
  snprintf(body, sizeof body, "\"image\": \"photo.png\", \"calibration\": %s", calibration);
  if (load(&scene, body, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  assert_near(scene.arcmin_per_px, arcmin, 1e-6 * arcmin);
  assert_string_equal(scene.name, "photo");
  placido_scene_free(&scene);
}

static void test_calibrations_are_what_geometry_says(void **state) {
  (void)state;
  const double arcmin = acos(-1) / 10800;
  expect_scale("{\"kind\": \"arcmin_per_px\", \"value\": 0.5}", 0.5);
  /* A pixel of 25.4 mm / 72 seen from 2.4257 m: the seed's half a minute. */
  expect_scale("{\"kind\": \"monitor\", \"dpi\": 72, \"distance_m\": 2.4257}", 0.4999632);
  /* 1.8 m over 300 px at 20 m: 6 mm at 20 m. */
  expect_scale("{\"kind\": \"object\", \"size_m\": 1.8, \"distance_m\": 20, \"size_px\": 300}",
               2 * atan(0.00015) / arcmin);
  /* 40 px over 12 degrees: a plane at distance 1 that is 2 tan 6 wide. */
  expect_scale("{\"kind\": \"camera\", \"horizontal_fov_deg\": 12}",
               2 * atan(tan(6 * 60 * arcmin) / 40) / arcmin);
}

/* Small angles would be wrong by far: 40 pixels share 140 degrees, of which the two in the middle
 * have 7.85 each, not 3.5; a screen pixel of 25.4 mm at 10 mm is 103.6 degrees, not 145.5. */
static void test_calibrations_hold_at_large_angles(void **state) {
  (void)state;
  expect_scale("{\"kind\": \"camera\", \"horizontal_fov_deg\": 140}", 7.8585998 * 60);
  expect_scale("{\"kind\": \"monitor\", \"dpi\": 1, \"distance_m\": 0.01}", 103.5660977 * 60);
  expect_scale("{\"kind\": \"object\", \"size_m\": 80, \"distance_m\": 1, \"size_px\": 40}",
               90 * 60);
  expect_scale("{\"kind\": \"arcmin_per_px\", \"value\": 600}", 600);
}

/* sRGB 188/255 is 0.5029 of white in linear light (IEC 61966-2-1). */
static void test_photographs_become_linear_light(void **state) {
  (void)state;
  placido_scene scene;
  assert_int_equal(load(&scene,
                        "\"name\": \"a wall/white\", \"image\": \"photo.png\", \"calibration\": "
                        "{\"kind\": \"arcmin_per_px\", \"value\": 0.25}",
                        NULL, NULL),
                   PLACIDO_OK);
  assert_int_equal(scene.image.planes, 3);
  assert_int_equal(scene.bleed_px, 0);
  assert_near(scene.image.data[0], 0.5028865, 1e-5);
  assert_string_equal(scene.name, "a wall-white"); /* the stem of a file */
  placido_scene_free(&scene);
}

/* 40 px of a quarter minute are 20 buckets of half a minute; grey stays grey under a delta. */
static void test_finer_scenes_are_brought_to_the_bucket(void **state) {
  (void)state;
  double values[9] = {0, 0, 0, 0, 1, 0, 0, 0, 0};
  placido_psf psf = {.n = 3, .bucket_arcmin = 0.5, .values = values};
  placido_scene scene;
  placido_image seen;
  assert_int_equal(load(&scene,
                        "\"image\": \"photo.png\", \"calibration\": "
                        "{\"kind\": \"arcmin_per_px\", \"value\": 0.25}",
                        NULL, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
  assert_int_equal(seen.width_px, 20);
  assert_int_equal(seen.height_px, 10);
  assert_near(seen.data[5 * 20 + 10], 0.5028865, 1e-5);
  placido_image_free(&seen);
  placido_scene_free(&scene);
}

/* A chart drawn at 0.3' is seen at the bucket's 0.5' as large as one drawn at 0.5', and as white
 * at its edge. */
static void test_finer_charts_keep_their_size_and_lose_their_bleed(void **state) {
  (void)state;
  double values[9] = {0, 0, 0, 0, 1, 0, 0, 0, 0};
  placido_psf psf = {.n = 3, .bucket_arcmin = 0.5, .values = values};
  placido_scene scene;
  placido_image seen;
  assert_int_equal(load(&scene,
                        "\"image\": \"tumbling-e\", \"calibration\": "
                        "{\"kind\": \"arcmin_per_px\", \"value\": 0.3}",
                        NULL, NULL),
                   PLACIDO_OK);
  assert_int_equal(scene.bleed_px, 214); /* 64' / 0.3' rounded up */
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
  assert_int_equal(seen.width_px, 560);
  assert_int_equal(seen.height_px, 420);
  assert_near(seen.data[0], 1, 1e-5);
  placido_image_free(&seen);
  placido_scene_free(&scene);
}

static void test_coarser_scenes_are_refused_with_the_numbers(void **state) {
  (void)state;
  double values[9] = {0, 0, 0, 0, 1, 0, 0, 0, 0};
  placido_psf psf = {.n = 3, .bucket_arcmin = 0.5, .values = values};
  placido_scene scene;
  placido_image seen;
  placido_error err = {0};
  assert_int_equal(load(&scene,
                        "\"image\": \"photo.png\", \"calibration\": "
                        "{\"kind\": \"arcmin_per_px\", \"value\": 2}",
                        NULL, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "a pixel is 2', the PSF's bucket 0.5'"));
  assert_null(seen.data);
  assert_non_null(strstr(err.text, "--allow-coarse"));
  assert_true(placido_scene_coarse(&scene, &psf));
  /* Asked for, a pixel becomes four buckets a side. */
  scene.allow_coarse = true;
  scene.image.data[41] = 1; /* the second of the second row */
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, &err), PLACIDO_OK);
  assert_int_equal(seen.width_px, 160);
  assert_int_equal(seen.height_px, 80);
  for (int i = 0; i < 160 * 80; i++) {
    bool bright = i % 160 / 4 == 1 && i / 160 / 4 == 1;
    assert_near(seen.data[i], bright ? 1 : 0.5028865, 1e-5);
  }
  placido_image_free(&seen);
  placido_scene_free(&scene);
}

static void test_charts_take_the_scene_s_calibration(void **state) {
  (void)state;
  placido_scene half, quarter;
  assert_int_equal(placido_scene_load(&half, "tumbling-e", 0, NULL, NULL), PLACIDO_OK);
  assert_true(half.arcmin_per_px == 0.5);
  assert_int_equal(load(&quarter,
                        "\"image\": \"tumbling-e\", \"calibration\": "
                        "{\"kind\": \"arcmin_per_px\", \"value\": 0.25}",
                        NULL, NULL),
                   PLACIDO_OK);
  assert_int_equal(quarter.image.width_px, 2 * half.image.width_px);
  assert_int_equal(quarter.bleed_px, 2 * half.bleed_px);
  assert_string_equal(quarter.name, "tumbling-e");
  placido_scene_free(&half);
  placido_scene_free(&quarter);
}

static void test_errors_name_file_line_and_field(void **state) {
  (void)state;
  static const struct {
    const char *body, *words[2];
    int status;
  } rows[] = {
    {"\"name\": \"x\"", {"scene.json:", "image"}, PLACIDO_INPUT},
    {"\"image\": \"photo.png\"", {"scene.json:", "calibration.kind"}, PLACIDO_INPUT},
    {"\"image\": 7", {"scene.json:3", "image"}, PLACIDO_INPUT},
    {"\"image\": \"photo.png\",\n\"calibration\": {\n\"kind\": \"feet\"}",
     {"scene.json:5", "arcmin_per_px, camera, object or monitor"}, PLACIDO_INPUT},
    {"\"image\": \"photo.png\",\n\"calibration\": {\"kind\": \"monitor\", \"dpi\": -1,\n"
     "\"distance_m\": 1}", {"scene.json:4", "calibration.dpi"}, PLACIDO_INPUT},
    {"\"image\": \"photo.png\",\n\"calibration\": {\"kind\": \"object\", \"size_m\": 1,\n"
     "\"distance_m\": \"far\", \"size_px\": 3}", {"scene.json:5", "distance_m"}, PLACIDO_INPUT},
    {"\"image\": \"fan\", \"calibration\": {\"kind\": \"camera\", \"horizontal_fov_deg\": 12}",
     {"scene.json:3", "photographs"}, PLACIDO_INPUT},
    {"\"image\": \"photo.png\", \"tolerance\": 0,\n\"calibration\": {\"kind\": \"camera\"}",
     {"scene.json:3", "tolerance"}, PLACIDO_INPUT},
    {"\"image\": \"photo.png\", \"tolerance\": 2,\n\"calibration\": {\"kind\": \"camera\"}",
     {"scene.json:3", "expected 1e-06 to 1"}, PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"luminance_cd_m2\": -3", {"scene.json:4", "luminance"},
     PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"distance_m\": \"far\"", {"scene.json:4", "\"infinity\""},
     PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"distance_m\": 0", {"scene.json:4", "distance_m"}, PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"spectrum\": \"neon\"", {"scene.json:4", "wavelength"},
     PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"spectrum\": 1200", {"scene.json:4", "380 to 780"}, PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"spectrum\": [1]", {"scene.json:4", "daylight"}, PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"depth\": \"none.tif\"", {"none.tif", "cannot read"}, PLACIDO_SYSTEM},
    {"\"image\": \"sloan\",\n\"resampling\": \"best\"", {"scene.json:4", "area or bicubic"},
     PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"allow_coarse\": 1", {"scene.json:4", "allow_coarse"}, PLACIDO_INPUT},
    {"\"image\": \"sloan\",\n\"chart\": {\"first_logmar\": 0, \"last_logmar\": 1}",
     {"scene.json:4", "from 2 down to -1"}, PLACIDO_INPUT},
    {"\"image\": \"fan\",\n\"chart\": {\"first_logmar\": 0}", {"fan", "its own"}, PLACIDO_INPUT},
    {"\"image\": \"photo.png\",\n\"chart\": {\"first_logmar\": 0}",
     {"scene.json:4", "photograph"}, PLACIDO_INPUT},
    {"\"image\": \"missing.png\", \"calibration\": {\"kind\": \"arcmin_per_px\", \"value\": 1}",
     {"missing.png", ""}, PLACIDO_SYSTEM},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    placido_scene scene;
    placido_error err = {0};
    int status = load(&scene, rows[i].body, NULL, &err);
    if (status != rows[i].status || strstr(err.text, rows[i].words[0]) == NULL ||
        strstr(err.text, rows[i].words[1]) == NULL) {
      fail_msg("%s gives %d \"%s\"", rows[i].body, status, err.text);
    }
    assert_null(scene.image.data);
  }
}

static void test_conditions_are_kept(void **state) {
  (void)state;
  placido_scene scene;
  assert_int_equal(load(&scene,
                        "\"image\": \"e-lines\", \"luminance_cd_m2\": 3, \"distance_m\": 0.33, "
                        "\"spectrum\": 589.3, \"tolerance\": 0.003, "
                        "\"resampling\": \"bicubic\", \"allow_coarse\": true, "
                        "\"chart\": {\"last_logmar\": 0.3}",
                        NULL, NULL),
                   PLACIDO_OK);
  const placido_conditions *conditions = &scene.conditions;
  assert_true(conditions->luminance_cd_m2 == 3);
  assert_true(conditions->distance_m == 0.33);
  assert_true(conditions->spectrum == PLACIDO_SPECTRUM_LINE);
  assert_true(conditions->wavelength_nm == 589.3);
  assert_true(conditions->tolerance == 0.003);
  assert_int_equal(scene.resampling, PLACIDO_RESAMPLING_BICUBIC);
  assert_true(scene.allow_coarse);
  assert_true(scene.arcmin_per_px == 0.5); /* a chart needs no calibration */
  /* One line of 20/40: 9 letters of 10' (9.98') and 56' to a side, 14' above and below. */
  assert_int_equal(scene.image.width_px - 2 * scene.bleed_px, 404);
  assert_int_equal(scene.image.height_px - 2 * scene.bleed_px, 76);
  placido_scene_free(&scene);
  assert_int_equal(load(&scene, "\"image\": \"fan\", \"distance_m\": \"infinity\"", NULL, NULL),
                   PLACIDO_OK);
  assert_true(scene.conditions.luminance_cd_m2 == 160); /* its own */
  assert_true(isinf(scene.conditions.distance_m));
  assert_true(scene.conditions.spectrum == PLACIDO_SPECTRUM_DAYLIGHT);
  assert_string_equal(scene.conditions.depth_path, "");
  assert_true(scene.conditions.tolerance == 0.01);
  placido_scene_free(&scene);
}

static void test_unknown_fields_are_told(void **state) {
  (void)state;
  placido_notes notes = {0};
  placido_scene scene;
  assert_int_equal(load(&scene,
                        "\"image\": \"fan\", \"colour\": 1, \"luminance_cd_m2\": 3,\n"
                        "\"distance_m\": \"infinity\", \"calibration\": "
                        "{\"kind\": \"arcmin_per_px\", \"value\": 0.5}",
                        &notes, NULL),
                   PLACIDO_OK);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "colour"));
  placido_notes_clear(&notes);
  placido_scene_free(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_calibrations_are_what_geometry_says),
    cmocka_unit_test(test_calibrations_hold_at_large_angles),
    cmocka_unit_test(test_photographs_become_linear_light),
    cmocka_unit_test(test_finer_scenes_are_brought_to_the_bucket),
    cmocka_unit_test(test_finer_charts_keep_their_size_and_lose_their_bleed),
    cmocka_unit_test(test_coarser_scenes_are_refused_with_the_numbers),
    cmocka_unit_test(test_charts_take_the_scene_s_calibration),
    cmocka_unit_test(test_errors_name_file_line_and_field),
    cmocka_unit_test(test_conditions_are_kept),
    cmocka_unit_test(test_unknown_fields_are_told),
  };
  return cmocka_run_group_tests_name("simulate_scene", tests, make_folder, remove_folder);
}
