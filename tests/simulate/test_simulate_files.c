/* psf.csv and psf.json as other programs read them; allocations that fail. */
#include "base/json.h"
#include "base/memory.h"
#include "eyes.h"
#include "tests/support/near.h"

#include <placido/plan.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/placido-psf-XXXXXX";

static int make_file(void **state) {
  (void)state;
  int descriptor = mkstemp(path);
  return descriptor < 0 ? -1 : close(descriptor);
}

static int remove_file(void **state) {
  (void)state;
  return remove(path);
}

static placido_psf cone_psf(bool correct) {
  placido_surface *surface = keratoconus(0);
  placido_eye eye = {.pupil_mm = 4, .correct = correct};
  placido_psf psf = psf_of(surface, &eye, &(placido_optics){.samples = 60});
  placido_surface_free(surface);
  return psf;
}

static void test_csv_reads_back_bit_for_bit(void **state) {
  (void)state;
  placido_psf psf = cone_psf(true);
  static char line[257 * 32];
  int row = 0;
  assert_int_equal(placido_psf_save_csv(&psf, path, NULL), PLACIDO_OK);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  for (; fgets(line, sizeof line, file) != NULL; row++) {
    char *at = line;
    for (int column = 0; column < 257; column++) {
      assert_true(strtod(at, &at) == psf.values[row * 257 + column]);
      assert_int_equal(*at++, column < 256 ? ',' : '\n');
    }
    assert_int_equal(*at, '\0');
  }
  assert_int_equal(row, 257);
  fclose(file);
  placido_psf_free(&psf);
}

static double number(const placido_json *json, const char *field) {
  double value;
  placido_error err = {0};
  if (placido_json_number(json, field, &value, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return value;
}

static void test_json_has_what_the_format_says(void **state) {
  (void)state;
  placido_psf psf = cone_psf(true);
  placido_json *json;
  double sphere_D, cylinder_D, axis_deg;
  placido_correction_clinical(&psf.correction, &sphere_D, &cylinder_D, &axis_deg);
  assert_int_equal(placido_psf_save_json(&psf, NULL, 0.25, path, NULL), PLACIDO_OK);
  assert_int_equal(placido_json_load(&json, path, "placido-psf/1", NULL), PLACIDO_OK);
  assert_true(number(json, "pupil_mm") == 4);
  assert_true(number(json, "rays") == 60 * 60 + 59 * 59);
  assert_true(number(json, "rays_entered") == psf.rays_entered);
  assert_true(number(json, "rays_landed") == psf.rays_landed);
  assert_true(number(json, "rays_missed") == 0);
  assert_true(number(json, "rays_grazed") == 0 && number(json, "rays_reflected") == 0);
  assert_true(number(json, "outside") == 1 - number(json, "rays_landed") / number(json, "rays_entered"));
  assert_true(number(json, "strehl_g") == psf.strehl_g);
  assert_true(number(json, "bucket_arcmin") == 0.5);
  assert_true(number(json, "bucket_um") == psf.bucket_um);
  assert_true(number(json, "correction.sphere_D") == sphere_D);
  assert_true(number(json, "correction.cylinder_D") == cylinder_D);
  assert_true(number(json, "correction.axis_deg") == axis_deg);
  assert_true(number(json, "retina_mm") == psf.retina_mm);
  assert_true(number(json, "refractive_index") == 1.3375);
  assert_true(number(json, "seconds") == 0.25);
  /* Without a plan every effect of the build is left out, and what that costs is not known. */
  size_t effects = 0;
  const char *name, *summary;
  while (placido_effect_at(effects, &name, &summary)) {
    effects++;
  }
  assert_int_equal(json_array_size(placido_json_find(json, "effects.left_out")), effects);
  assert_true(effects == 0 ||
              json_is_null(placido_json_find(json, "effects.left_out[0].estimate")));
  placido_json_free(json);
  placido_psf_free(&psf);
}

static void test_axis_of_no_cylinder_is_null(void **state) {
  (void)state;
  placido_psf psf = cone_psf(false);
  placido_json *json;
  assert_int_equal(placido_psf_save_json(&psf, NULL, 0, path, NULL), PLACIDO_OK);
  assert_int_equal(placido_json_load(&json, path, "placido-psf/1", NULL), PLACIDO_OK);
  assert_true(json_is_null(placido_json_find(json, "correction.axis_deg")));
  placido_json_free(json);
  placido_psf_free(&psf);
}

static void test_places_that_cannot_be_written_are_refused(void **state) {
  (void)state;
  placido_psf psf = cone_psf(false);
  placido_error err = {0};
  assert_int_equal(placido_psf_save_csv(&psf, "/no/such/folder/psf.csv", &err), PLACIDO_SYSTEM);
  assert_int_equal(placido_psf_save_json(&psf, NULL, 0, "/no/such/folder/psf.json", &err),
                   PLACIDO_SYSTEM);
  placido_psf_free(&psf);
}

/* Every allocation in turn fails: an error comes back and nothing is lost (the leak check of the
 * sanitizer build sees to the latter). */
static void test_every_failed_allocation_of_a_psf_is_reported(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  placido_eye eye = {.pupil_mm = 4};
  placido_optics optics = {.samples = 20};
  int status = PLACIDO_MEMORY, n = 0;
  while (status != PLACIDO_OK) {
    placido_psf psf;
    placido_error err = {0};
    placido_memory_fail_at((unsigned long)++n);
    status = placido_psf_new(&psf, NULL, surface, &eye, &optics, NULL, &err);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK || (status == PLACIDO_MEMORY && psf.values == NULL));
    assert_true(status == PLACIDO_OK || err.text[0] != '\0');
    placido_psf_free(&psf);
  }
  assert_true(n > 4);
  placido_surface_free(surface);
}

static void test_every_failed_allocation_of_a_view_is_reported(void **state) {
  (void)state;
  placido_psf psf = cone_psf(false);
  placido_scene scene;
  assert_int_equal(placido_scene_load(&scene, "fan", 0, NULL, NULL), PLACIDO_OK);
  scene.arcmin_per_px = 0.3; /* as if finer: it has to be resampled */
  int status = PLACIDO_MEMORY, n = 0;
  while (status != PLACIDO_OK) {
    placido_image seen;
    placido_memory_fail_at((unsigned long)++n);
    status = placido_scene_see(&seen, &scene, &psf, 1, NULL);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK || (status == PLACIDO_MEMORY && seen.data == NULL));
    placido_image_free(&seen);
  }
  assert_true(n > 3);
  placido_scene_free(&scene);
  placido_psf_free(&psf);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_csv_reads_back_bit_for_bit),
    cmocka_unit_test(test_json_has_what_the_format_says),
    cmocka_unit_test(test_axis_of_no_cylinder_is_null),
    cmocka_unit_test(test_places_that_cannot_be_written_are_refused),
    cmocka_unit_test(test_every_failed_allocation_of_a_psf_is_reported),
    cmocka_unit_test(test_every_failed_allocation_of_a_view_is_reported),
  };
  return cmocka_run_group_tests_name("simulate_files", tests, make_file, remove_file);
}
