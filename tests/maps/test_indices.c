/* Indices: exact figures of shapes that have them, NaN (null in the file) where data are missing.
 */
#include "base/json.h"
#include "base/memory.h"
#include "tests/maps/eyes.h"
#include "tests/support/near.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct indices {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count;
};

static struct indices indices_of(const placido_surface *surface) {
  struct indices found;
  assert_int_equal(placido_indices_find(found.values, &found.count, surface, NULL, NULL),
                   PLACIDO_OK);
  return found;
}

static double value_of(const struct indices *indices, const char *name) {
  for (size_t i = 0; i < indices->count; i++) {
    if (strcmp(indices->values[i].name, name) == 0) {
      return indices->values[i].value;
    }
  }
  fail_msg("no index %s", name);
  return NAN;
}

static void a_sphere_has_one_keratometry(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  struct indices found = indices_of(surface);
  assert_near(value_of(&found, "simk_flat_D"), 337.5 / 7.8, 1e-10);
  assert_near(value_of(&found, "simk_steep_D"), 337.5 / 7.8, 1e-10);
  assert_near(value_of(&found, "simk_mean_D"), 337.5 / 7.8, 1e-10);
  assert_near(value_of(&found, "simk_cylinder_D"), 0, 1e-10);
  assert_true(isnan(value_of(&found, "simk_flat_axis_deg"))); /* a sphere has no axis */
  assert_near(value_of(&found, "asphericity_q"), 0, 1e-8);
  assert_near(value_of(&found, "apical_radius_mm"), 7.8, 1e-8);
  assert_near(value_of(&found, "best_fit_sphere_radius_mm"), 7.8, 1e-10);
  assert_near(value_of(&found, "max_tangential_D"), 337.5 / 7.8, 1e-10);
  for (size_t i = 0; i < found.count; i++) {
    assert_true(isnan(found.values[i].sigma)); /* no fit, no error bars */
  }
  placido_surface_free(surface);
}

/* The principal meridians of a toric surface with Q = 0 are circles: axial power along them is
 * constant. */
static void a_toric_surface_has_its_two_powers_and_axes(void **state) {
  (void)state;
  const double axes[] = {0, 30, 77.3, 135, 179.6};
  for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
    placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {8, 0, 7.5, 0, axes[i], 0, 0}};
    placido_surface *surface = eye_of(&part, 1);
    struct indices found = indices_of(surface);
    assert_near(value_of(&found, "simk_flat_D"), 337.5 / 8, 1e-7);
    assert_near(value_of(&found, "simk_steep_D"), 45, 1e-7);
    assert_near(value_of(&found, "simk_cylinder_D"), 45 - 337.5 / 8, 1e-7);
    /* the parabola stands for a cosine within a degree: 0.001 degrees is far below any measurement
     */
    assert_near(
        cos((value_of(&found, "simk_flat_axis_deg") - axes[i]) * 2 * 3.14159265358979 / 180), 1,
        1e-9);
    assert_near(
        fabs(value_of(&found, "simk_flat_axis_deg") - value_of(&found, "simk_steep_axis_deg")), 90,
        1e-9);
    placido_surface_free(surface);
  }
}

static void a_conicoid_has_its_asphericity(void **state) {
  (void)state;
  const double eyes[][4] = {{7.8, -0.26, 0, 0}, {7.7, 0.3, 0, 0}, {8.2, -0.7, 0.3, -0.2}};
  for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
    placido_surface *surface = conicoid_eye(eyes[i][0], eyes[i][1], eyes[i][2], eyes[i][3]);
    struct indices found = indices_of(surface);
    assert_near(value_of(&found, "asphericity_q"), eyes[i][1], 1e-7);
    assert_near(value_of(&found, "apical_radius_mm"), eyes[i][0], 1e-7);
    placido_surface_free(surface);
  }
}

static void a_cone_is_steepest_near_its_tip(void **state) {
  (void)state;
  placido_part parts[] = {{.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}},
                          {.kind = PLACIDO_PART_BUMP, .as.bump = {0.04, 0.8, 0.8, 1.2, -1.6, 0}}};
  placido_surface *surface = eye_of(parts, 2);
  struct indices found = indices_of(surface);
  assert_near(value_of(&found, "max_tangential_x_mm"), 1.2, 0.25);
  assert_near(value_of(&found, "max_tangential_y_mm"), -1.6, 0.25);
  /* 337.5 h/s² on top of the sphere, less what the cone's inclination takes */
  assert_near(value_of(&found, "max_tangential_D"), 337.5 * (1 / 7.8 + 0.04 / 0.64), 4);
  placido_surface_free(surface);
}

static void missing_data_give_no_figure(void **state) {
  (void)state;
  const unsigned char left[19] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  placido_surface *surface = partly_covered_eye(7.8, left);
  struct indices found = indices_of(surface);
  assert_true(isnan(value_of(&found, "simk_flat_D")));
  assert_true(isnan(value_of(&found, "simk_cylinder_D")));
  assert_true(isnan(value_of(&found, "asphericity_q")));
  assert_true(isnan(value_of(&found, "best_fit_sphere_radius_mm")));
  assert_near(value_of(&found, "max_tangential_D"), 337.5 / 7.8, 1e-10);
  placido_surface_free(surface);
}

static void the_file_holds_what_was_found(void **state) {
  (void)state;
  char path[] = "/tmp/placido-indices-XXXXXX";
  int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  placido_index_value values[] = {{"alpha_D", "D", "First.", 1.0 / 3, 0.25},
                                  {"beta", "", "Second.", NAN, NAN}};
  assert_int_equal(placido_indices_save(values, 2, path, NULL), PLACIDO_OK);
  placido_json *json;
  double number;
  char text[16];
  assert_int_equal(placido_json_load(&json, path, "placido-indices/1", NULL), PLACIDO_OK);
  assert_int_equal(placido_json_number(json, "indices[0].value", &number, NULL), PLACIDO_OK);
  assert_true(number == 1.0 / 3);
  assert_int_equal(placido_json_number(json, "indices[0].sigma", &number, NULL), PLACIDO_OK);
  assert_true(number == 0.25);
  assert_int_equal(placido_json_string(json, "indices[0].unit", text, sizeof text, NULL),
                   PLACIDO_OK);
  assert_string_equal(text, "D");
  assert_int_equal(placido_json_string(json, "indices[1].name", text, sizeof text, NULL),
                   PLACIDO_OK);
  assert_string_equal(text, "beta");
  assert_true(json_is_null(placido_json_find(json, "indices[1].value")));
  assert_true(json_is_null(placido_json_find(json, "indices[1].sigma")));
  placido_json_free(json);
  unlink(path);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  struct indices found;
  int status = PLACIDO_MEMORY;
  unsigned long n;
  for (n = 1; status == PLACIDO_MEMORY && n < 20; n++) {
    placido_memory_fail_at(n);
    status = placido_indices_find(found.values, &found.count, surface, NULL, NULL);
    placido_memory_fail_at(0);
    assert_true((found.count == 0) == (status != PLACIDO_OK));
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 2);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_sphere_has_one_keratometry),
      cmocka_unit_test(a_toric_surface_has_its_two_powers_and_axes),
      cmocka_unit_test(a_conicoid_has_its_asphericity),
      cmocka_unit_test(a_cone_is_steepest_near_its_tip),
      cmocka_unit_test(missing_data_give_no_figure),
      cmocka_unit_test(the_file_holds_what_was_found),
      cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
