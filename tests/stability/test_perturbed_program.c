/* The condition numbers that the program writes hold: an examination is done again with what goes
 * in moved, and results move by what its own `condition` said. */
#include "tests/base/scratch.h"
#include "tests/stability/table.h"

#include <float.h>
#include <jansson.h>
#include <math.h>
#include <placido/image.h>
#include <placido/phantom.h>
#include <placido/uncertainty.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

#define OUTPUTS_MAX 32
#define DISTANCE_SIGMA_MM 0.05
#define CORNEA_MM 7.8
#define ROUNDINGS 71 /* of a residual: test_arithmetic_rays.c */

/* One result with its conditions; NaN where the file has null. */
struct output {
  char name[48];
  const char *unit; /* um or D */
  double value, edges_per_sigma, edges_per_px, edges_relative;
  double distance_per_mm, distance_relative, geometry_per_sigma;
};

/* What the program says of one examination. */
struct record {
  size_t count;
  struct output outputs[OUTPUTS_MAX];
  double scale_px, scale_mm, points_used;
};

static void **scratch;
static struct record usual;

static double number_of(const json_t *json) {
  return json_is_number(json) ? json_number_value(json) : (double)NAN;
}

static double inside(const json_t *json, const char *key, const char *within) {
  return number_of(json_object_get(json_object_get(json, key), within));
}

static struct output output_of(const json_t *json) {
  double pupil_mm = number_of(json_object_get(json, "pupil_mm"));
  struct output o = {.value = number_of(json_object_get(json, "value")),
                     .edges_per_sigma = inside(json, "edges", "per_sigma"),
                     .edges_per_px = inside(json, "edges", "per_px"),
                     .edges_relative = inside(json, "edges", "relative"),
                     .distance_per_mm = inside(json, "distance", "per_mm"),
                     .distance_relative = inside(json, "distance", "relative"),
                     .geometry_per_sigma = inside(json, "geometry", "per_sigma")};
  const char *name = json_string_value(json_object_get(json, "name"));
  bool is_power = strcmp(json_string_value(json_object_get(json, "unit")), "D") == 0;
  o.unit = is_power ? "D" : "um";
  if (isnan(pupil_mm)) {
    snprintf(o.name, sizeof o.name, "%.30s", name);
  } else {
    snprintf(o.name, sizeof o.name, "%.30s, %g mm", name, pupil_mm);
  }
  return o;
}

static void read_record(struct record *record, const char *path) {
  json_error_t error;
  json_t *root = json_load_file(path, 0, &error);
  if (!root) {
    fail_msg("%s: %s", path, error.text);
  }
  const json_t *condition = json_object_get(root, "condition");
  const json_t *inputs = json_object_get(condition, "inputs"), *one;
  size_t at;
  *record = (struct record){.scale_px = inside(inputs, "edges", "scale_px"),
                            .scale_mm = inside(inputs, "distance", "scale_mm"),
                            .points_used = inside(root, "fit", "points_used")};
  json_array_foreach(json_object_get(condition, "outputs"), at, one) {
    assert_true(record->count < OUTPUTS_MAX);
    record->outputs[record->count++] = output_of(one);
  }
  assert_true(record->count >= 10);
  json_decref(root);
}

/* A picture of the eye with its own noise. */
static void render(const char *name, uint64_t seed, const placido_instrument *instrument) {
  placido_frame frame = {0};
  placido_surface *eye;
  const placido_disturbance disturbance = {.seed = seed, .blur_px = 0.8, .noise = 1.2};
  char *path = scratch_path(scratch, name);
  assert_int_equal(placido_phantom_eye(&eye, "keratoconus", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_render(&frame, eye, instrument, &disturbance, 0, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_frame_save_png(&frame, path, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  placido_surface_free(eye);
  free(path);
}

static void examine(struct record *record, const char *picture, const char *instrument,
                    double axis_z_mm) {
  char *from = scratch_path(scratch, picture), *by = scratch_path(scratch, instrument);
  char *to = scratch_path(scratch, "result"),
       *file = scratch_path(scratch, "result/reconstruction.json");
  char command[4096];
  snprintf(command, sizeof command,
           "'%s' reconstruct '%s' --instrument '%s' --axis-z %.17g,%g --knots 0.5 --meridians 180 "
           "--quiet -o '%s'",
           PLACIDO_PROGRAM, from, by, axis_z_mm, DISTANCE_SIGMA_MM, to);
  assert_int_equal(system(command), 0);
  read_record(record, file);
  free(from);
  free(by);
  free(to);
  free(file);
}

static void add_row(const char *what, const struct output *output, double perturbation,
                    const char *in_unit, double condition, double change, double bound) {
  char name[96];
  snprintf(name, sizeof name, "%s: %s", what, output->name);
  const struct stability_row row = {.name = name,
                                    .condition = condition,
                                    .perturbation = perturbation,
                                    .in_unit = in_unit,
                                    .change = change,
                                    .out_unit = output->unit,
                                    .bound = bound,
                                    .extended = NAN};
  stability_add(&row);
}

enum { ELEVATION, AXIAL };

/* Whether what the file says is a bound only. Root mean squares over the zone have one for a
 * derivative, without a sign. A wavefront's defocus is that against the sphere of the fitted
 * surface; another examination has its own sphere, against which there is none. */
static bool is_bound(const struct record *record, size_t output) {
  return output == ELEVATION || output == AXIAL ||
         strncmp(record->outputs[output].name, "z_2_0", 5) == 0;
}

/* What the second order may add: the step's relative size times what it does to the surface as a
 * whole, in the result's unit; twice that, as results are curved, too. */
static double second_order(const struct output *output, const double whole[2], double relative) {
  return 2 * relative * whole[strcmp(output->unit, "D") == 0 ? AXIAL : ELEVATION];
}

static void the_distance_by_its_sigma(void **state) {
  (void)state;
  struct record moved;
  double whole[2];
  examine(&moved, "eye.png", "usual.json", DISTANCE_SIGMA_MM);
  for (int k = 0; k < 2; k++) {
    whole[k] = usual.outputs[k].distance_per_mm * DISTANCE_SIGMA_MM;
  }
  for (size_t k = 0; k < usual.count; k++) {
    const struct output *o = &usual.outputs[k];
    double step = o->distance_per_mm * DISTANCE_SIGMA_MM,
           change = moved.outputs[k].value - o->value;
    bool bound = is_bound(&usual, k);
    double more = second_order(o, whole, DISTANCE_SIGMA_MM / CORNEA_MM);
    add_row(bound ? "distance" : "distance beyond per_mm", o, DISTANCE_SIGMA_MM, "mm",
            o->distance_per_mm, bound ? fabs(change) : fabs(change - step),
            (bound ? fabs(step) : 0) + more);
  }
}

/* Pictures with other noise differ by the noise of both: √2 of the standard deviation, five times
 * that once in two million. */
static void other_noise(void **state) {
  (void)state;
  struct record other;
  examine(&other, "other.png", "usual.json", 0);
  for (size_t k = 0; k < usual.count; k++) {
    const struct output *o = &usual.outputs[k];
    add_row("other noise", o, 1, "sigma", o->edges_per_sigma,
            fabs(other.outputs[k].value - o->value), 5 * sqrt(2) * o->edges_per_sigma);
  }
}

/* One mode is a part of the root of the sum of squares. 5 px of 10800 and 0.1 mm of 120. */
static void the_geometry_by_its_sigma(void **state) {
  (void)state;
  static const char *const files[] = {"focal.json", "camera.json"};
  static const char *const names[] = {"focal length by its sigma", "camera's z by its sigma"};
  static const double relative[] = {5 / 10800.0, 0.1 / 120};
  for (int mode = 0; mode < 2; mode++) {
    struct record moved;
    const double whole[2] = {usual.outputs[ELEVATION].geometry_per_sigma,
                             usual.outputs[AXIAL].geometry_per_sigma};
    examine(&moved, "eye.png", files[mode], 0);
    for (size_t k = 0; k < usual.count; k++) {
      const struct output *o = &usual.outputs[k];
      /* where the draws of the noise stand for it the mode's own step is exact */
      add_row(names[mode], o, 1, "sigma", o->geometry_per_sigma,
              fabs(moved.outputs[k].value - o->value),
              o->geometry_per_sigma + second_order(o, whole, relative[mode]));
    }
  }
}

/* A number of the instrument by one ulp: its own step, which is nothing beside what rounding leaves
 * of every residual, 71 operations on places of up to 1024 px before and after; per_px √N of that.
 */
static void the_geometry_by_an_ulp(void **state) {
  (void)state;
  struct record moved;
  double ulp = 10800 * DBL_EPSILON, rounding_px = 2 * ROUNDINGS * 1024 * DBL_EPSILON / 2;
  examine(&moved, "eye.png", "ulp.json", 0);
  for (size_t k = 0; k < usual.count; k++) {
    const struct output *o = &usual.outputs[k];
    add_row("focal length by an ulp", o, ulp, "px", o->geometry_per_sigma,
            fabs(moved.outputs[k].value - o->value),
            o->geometry_per_sigma * ulp / 5 +
                o->edges_per_px * sqrt(usual.points_used) * rounding_px +
                8 * DBL_EPSILON * fabs(o->value));
  }
}

/* Relative condition numbers are the others in other units: two products and a quotient. */
static void relative_numbers(void **state) {
  (void)state;
  double worst = 0;
  for (size_t k = 0; k < usual.count; k++) {
    const struct output *o = &usual.outputs[k];
    double edges = o->edges_per_px * usual.scale_px / fabs(o->value);
    double distance = o->distance_per_mm * usual.scale_mm / fabs(o->value);
    worst = fmax(worst, fabs(o->edges_relative / edges - 1));
    worst = fmax(worst, fabs(o->distance_relative / distance - 1));
  }
  const struct stability_row row = {.name = "relative condition numbers",
                                    .condition = 1,
                                    .perturbation = NAN,
                                    .change = worst / DBL_EPSILON,
                                    .out_unit = "ulp",
                                    .bound = 4,
                                    .extended = worst / DBL_EPSILON};
  stability_add(&row);
}

static void in_proportion(void **state) {
  (void)state;
  assert_int_equal(stability_print("perturbed: the program's own condition numbers"), 0);
}

/* Writes the instrument with what is known of it, moved by some standard deviations along a mode.
 */
static void write_instrument(const char *name, const placido_instrument *instrument,
                             const placido_uncertainty *geometry, int mode, double amount) {
  placido_instrument moved;
  char *path = scratch_path(scratch, name);
  placido_uncertainty_apply(&moved, instrument, geometry, mode, amount);
  assert_int_equal(placido_uncertainty_save(geometry, &moved, path, NULL), PLACIDO_OK);
  free(path);
}

static int set_up(void **state) {
  placido_instrument instrument;
  placido_uncertainty geometry;
  scratch_setup(state);
  scratch = state;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_uncertainty_new(&geometry, instrument.edge_count, 2, NULL), PLACIDO_OK);
  geometry.factor[0] = geometry.factor[1] = 5;
  geometry.factor[geometry.parameter_count + 11] = 0.1;
  write_instrument("usual.json", &instrument, &geometry, 0, 0);
  write_instrument("focal.json", &instrument, &geometry, 0, 1);
  write_instrument("camera.json", &instrument, &geometry, 1, 1);
  write_instrument("ulp.json", &instrument, &geometry, 0, 10800 * DBL_EPSILON / 5);
  render("eye.png", 1, &instrument);
  render("other.png", 2, &instrument);
  placido_uncertainty_free(&geometry);
  examine(&usual, "eye.png", "usual.json", 0);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_distance_by_its_sigma), cmocka_unit_test(other_noise),
      cmocka_unit_test(the_geometry_by_its_sigma), cmocka_unit_test(the_geometry_by_an_ulp),
      cmocka_unit_test(relative_numbers),          cmocka_unit_test(in_proportion),
  };
  return cmocka_run_group_tests(tests, set_up, scratch_teardown);
}
