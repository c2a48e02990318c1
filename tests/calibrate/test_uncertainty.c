/* An instrument's uncertainty survives the way to a file and back; nonsense is refused at its
 * line. */
#include <placido/uncertainty.h>

#include "tests/base/scratch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const placido_instrument two_edges = {.name = "test",
                                             .width_px = 640,
                                             .height_px = 480,
                                             .focal_px = {5000, 5001},
                                             .principal_px = {319.5, 239.5},
                                             .position_mm = {0, 0, 120},
                                             .edge_count = 2,
                                             .edges = {{6.5, 71.25}, {7.5, 70}}};

static int load_text(void **state, const char *keys, placido_uncertainty *u, placido_error *err) {
  char text[2048];
  snprintf(text, sizeof text,
           "{\"format\": \"placido-instrument/1\", \"camera\": {\"focal_px\": 1},\n"
           "\"mires\": {\"edges\": [{}, {}]}\n%s}\n",
           keys);
  char *path = scratch_write_text(state, "u.json", text);
  int status = placido_uncertainty_load(u, path, err);
  free(path);
  return status;
}

static void a_file_gives_back_what_it_got(void **state) {
  placido_uncertainty u, back;
  placido_instrument instrument = two_edges;
  assert_int_equal(placido_uncertainty_new(&u, 2, 3, NULL), PLACIDO_OK);
  assert_int_equal(u.parameter_count, 16);
  for (int i = 0; i < 16; i++) {
    u.sigma[i] = 0.1 * (i + 1) / 3;
    for (int m = 0; m < 3; m++) {
      u.factor[16 * m + i] = (i - 5.5 * m) / 7;
    }
  }
  char *path = scratch_write_text(state, "i.json", "");
  assert_int_equal(placido_uncertainty_save(&u, &instrument, path, NULL), PLACIDO_OK);
  assert_int_equal(placido_uncertainty_load(&back, path, NULL), PLACIDO_OK);
  assert_int_equal(back.mode_count, 3);
  assert_memory_equal(back.sigma, u.sigma, 16 * sizeof *u.sigma);
  assert_memory_equal(back.factor, u.factor, 48 * sizeof *u.factor);
  placido_notes notes = {0};
  assert_int_equal(placido_instrument_load(&instrument, path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 0); /* its keys are known */
  placido_uncertainty_free(&u);
  placido_uncertainty_free(&back);
  free(path);
}

static void an_instrument_without_the_keys_has_no_modes(void **state) {
  placido_uncertainty u;
  assert_int_equal(load_text(state, "", &u, NULL), PLACIDO_OK);
  assert_int_equal(u.mode_count, 0);
  assert_null(u.sigma);
}

static void standard_deviations_alone_are_independent_modes(void **state) {
  placido_uncertainty u;
  assert_int_equal(load_text(state,
                             ",\"sigma\": {\"camera\": {\"focal_px\": [5, 0]},"
                             "\"mires\": {\"radius_mm\": 0.05, \"z_mm\": 0.1}}",
                             &u, NULL),
                   PLACIDO_OK);
  assert_int_equal(u.mode_count, 5); /* focal u, two radii, two heights */
  assert_true(u.factor[0] == 5);
  placido_instrument moved;
  placido_uncertainty_apply(&moved, &two_edges, &u, 4, -2);
  assert_true(moved.edges[1].z_mm == 70 - 2 * 0.1);
  assert_true(moved.edges[0].z_mm == 71.25 && moved.focal_px[0] == 5000);
  placido_uncertainty_free(&u);
}

static void every_parameter_has_its_place(void **state) {
  (void)state;
  placido_instrument i = two_edges;
  const double *const places[16] = {
      &i.focal_px[0],       &i.focal_px[1],       &i.principal_px[0], &i.principal_px[1],
      &i.distortion[0],     &i.distortion[1],     &i.distortion[2],   &i.distortion[3],
      &i.distortion[4],     &i.position_mm[0],    &i.position_mm[1],  &i.position_mm[2],
      &i.edges[0].radius_mm, &i.edges[1].radius_mm, &i.edges[0].z_mm,  &i.edges[1].z_mm};
  for (int k = 0; k < 16; k++) {
    assert_ptr_equal(placido_instrument_parameter(&i, k), places[k]);
  }
}

static void nonsense_is_refused_at_its_field(void **state) {
  static const struct {
    const char *keys, *field;
  } cases[] = {
      {",\"sigma\": {\"camera\": {\"focal_px\": [5, -1]}}", "sigma.camera.focal_px"},
      {",\"sigma\": {\"mires\": {\"edges\": [{\"radius_mm\": 1, \"z_mm\": 1}]}}", "2 edges"},
      {",\"sigma\": {\"mires\": {\"radius_mm\": 1}}", "sigma.mires.z_mm"},
      {",\"covariance\": {\"modes\": [[1, 2, 3]]}", "covariance.modes[0]"},
      {",\"covariance\": {\"modes\": 3}", "covariance.modes"},
      {",\"covariance\": {}", "covariance.modes"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    placido_uncertainty u;
    placido_error err = {0};
    assert_int_equal(load_text(state, cases[i].keys, &u, &err), PLACIDO_INPUT);
    assert_non_null(strstr(err.text, cases[i].field));
    assert_null(u.factor);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_file_gives_back_what_it_got, scratch_setup,
                                      scratch_teardown),
      cmocka_unit_test_setup_teardown(an_instrument_without_the_keys_has_no_modes, scratch_setup,
                                      scratch_teardown),
      cmocka_unit_test_setup_teardown(standard_deviations_alone_are_independent_modes,
                                      scratch_setup, scratch_teardown),
      cmocka_unit_test(every_parameter_has_its_place),
      cmocka_unit_test_setup_teardown(nonsense_is_refused_at_its_field, scratch_setup,
                                      scratch_teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
