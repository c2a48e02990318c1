/* Plans of calibrations: which ball stands where in which picture. */
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <placido/calibrate.h>

#include <string.h>

static void check(const placido_calibration_plan *plan) {
  FUZZ_REQUIRE(plan->view_count >= 1 && plan->view_count <= PLACIDO_BALL_VIEWS_MAX);
  FUZZ_REQUIRE(memchr(plan->instrument_path, '\0', sizeof plan->instrument_path) != NULL);
  for (size_t i = 0; i < plan->view_count; i++) {
    const placido_ball_view *view = &plan->views[i];
    FUZZ_REQUIRE(view->path[0] != '\0' && memchr(view->path, '\0', sizeof view->path) != NULL);
    FUZZ_REQUIRE(view->radius_mm > 0 && view->radius_mm <= 20);
    FUZZ_REQUIRE(view->radius_sigma_mm >= 0 && view->z_sigma_mm >= 0);
    FUZZ_REQUIRE(view->frame.data == NULL);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  placido_calibration_plan plan;
  placido_notes notes = {0};
  placido_error err = {0};
  const char *path = fuzz_file("calibration.json", data, size);
  if (fuzz_check(placido_calibration_plan_load(&plan, path, &notes, &err), &err)) {
    check(&plan);
  } else {
    FUZZ_REQUIRE(plan.view_count == 0 && plan.views == NULL);
  }
  placido_calibration_plan_free(&plan);
  placido_notes_clear(&notes);
  return 0;
}
