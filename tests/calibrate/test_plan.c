/* A calibration's plan: paths are relative to it, and what makes no sense is refused at its
 * field. */
#include <placido/calibrate.h>

#include "tests/base/scratch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PICTURE "{\"file\": \"a.png\", \"radius_mm\": 6.5, \"z_mm\": -1, \"z_sigma_mm\": 0.005"

static int load(void **state, const char *pictures, placido_calibration_plan *plan, char **path,
                placido_error *err) {
  char text[2048];
  snprintf(text, sizeof text,
           "{\"format\": \"placido-calibration/1\", \"instrument\": \"/far/nominal.json\",\n"
           "\"pictures\": [%s]}\n",
           pictures);
  *path = scratch_write_text(state, "plan.json", text);
  return placido_calibration_plan_load(plan, *path, NULL, err);
}

static void paths_are_relative_to_the_plan(void **state) {
  placido_calibration_plan plan;
  char *path, expected[PLACIDO_BALL_PATH_MAX];
  assert_int_equal(load(state, PICTURE "}, " PICTURE ", \"held_out\": true}", &plan, &path, NULL),
                   PLACIDO_OK);
  snprintf(expected, sizeof expected, "%.*sa.png", (int)(strlen(path) - strlen("plan.json")),
           path);
  assert_string_equal(plan.views[0].path, expected);
  assert_string_equal(plan.instrument_path, "/far/nominal.json");
  assert_int_equal(plan.view_count, 2);
  assert_true(plan.views[0].radius_sigma_mm == 0.001); /* the default */
  assert_true(plan.views[1].held_out && !plan.views[0].held_out);
  placido_calibration_plan_free(&plan);
  free(path);
}

static void nonsense_is_refused_at_its_field(void **state) {
  static const struct {
    const char *pictures, *says;
  } cases[] = {
      {"", "pictures"},
      {"{\"radius_mm\": 6.5}", "pictures[0].file"},
      {"{\"file\": \"\", \"radius_mm\": 6.5, \"z_mm\": 0, \"z_sigma_mm\": 1}", "pictures[0].file"},
      {"{\"file\": \"a\", \"radius_mm\": 3, \"z_mm\": 0, \"z_sigma_mm\": 1}", "4.5 to 20"},
      {"{\"file\": \"a\", \"radius_mm\": 8, \"z_mm\": 0}", "pictures[0].z_sigma_mm"},
      {"{\"file\": \"a\", \"radius_mm\": 8, \"z_mm\": 0, \"z_sigma_mm\": -1}", "z_sigma_mm"},
      {PICTURE ", \"held_out\": 1}", "held_out"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    placido_calibration_plan plan;
    placido_error err = {0};
    char *path;
    assert_int_equal(load(state, cases[i].pictures, &plan, &path, &err), PLACIDO_INPUT);
    assert_non_null(strstr(err.text, cases[i].says));
    assert_null(plan.views);
    free(path);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(paths_are_relative_to_the_plan, scratch_setup,
                                      scratch_teardown),
      cmocka_unit_test_setup_teardown(nonsense_is_refused_at_its_field, scratch_setup,
                                      scratch_teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
