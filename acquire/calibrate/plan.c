/* The plan of a calibration: which picture shows which ball where. */
#include <placido/calibrate.h>

#include "base/json.h"
#include "base/memory.h"

#include <stdio.h>
#include <string.h>

#define FORMAT "placido-calibration/1"
#define RADIUS_SIGMA_MM 0.001 /* of a ball of the better grades, ISO 3290-1 */
#define RADIUS_LEAST_MM 4.5   /* smaller ones do not reach the 8 mm that are judged */
#define RADIUS_MOST_MM 20.0
#define Z_MOST_MM 50.0
#define SIGMA_MOST_MM 10.0

/* A path of the plan, which is relative to the plan's own folder. */
static int read_path(char out[PLACIDO_BALL_PATH_MAX], const placido_json *json, const char *field,
                     const char *plan_path, placido_error *err) {
  char name[PLACIDO_BALL_PATH_MAX];
  int status = placido_json_string(json, field, name, sizeof name, err);
  if (status) {
    return status;
  }
  const char *slash = strrchr(plan_path, '/');
  bool has_place = name[0] == '/' || !slash;
  int folder = has_place ? 0 : (int)(slash - plan_path) + 1;
  int length = snprintf(out, PLACIDO_BALL_PATH_MAX, "%.*s%s", folder, plan_path, name);
  if (name[0] == '\0' || length >= PLACIDO_BALL_PATH_MAX) {
    return placido_json_refuse(json, field, err, "a path of 1 to %d bytes is expected",
                               PLACIDO_BALL_PATH_MAX - 1);
  }
  return PLACIDO_OK;
}

/* A number of a picture within its range; `value` stays where an optional one is missing. */
static int read_number(double *value, const placido_json *json, size_t index, const char *name,
                       double least, double most, bool optional, placido_error *err) {
  char field[64];
  snprintf(field, sizeof field, "pictures[%zu].%s", index, name);
  if (optional && !placido_json_find(json, field)) {
    return PLACIDO_OK;
  }
  int status = placido_json_number(json, field, value, err);
  if (!status && !(*value >= least && *value <= most)) {
    status = placido_json_refuse(json, field, err, "%g mm, %g to %g is expected", *value, least,
                                 most);
  }
  return status;
}

static int read_view(placido_ball_view *view, const placido_json *json, size_t index,
                     const char *plan_path, placido_notes *notes, placido_error *err) {
  static const char *const known[] = {"file",     "radius_mm",  "radius_sigma_mm", "z_mm",
                                      "z_sigma_mm", "held_out", NULL};
  char field[64];
  snprintf(field, sizeof field, "pictures[%zu].file", index);
  int status = read_path(view->path, json, field, plan_path, err);
  view->radius_sigma_mm = RADIUS_SIGMA_MM;
  if (status ||
      (status = read_number(&view->radius_mm, json, index, "radius_mm", RADIUS_LEAST_MM,
                            RADIUS_MOST_MM, false, err)) ||
      (status = read_number(&view->radius_sigma_mm, json, index, "radius_sigma_mm", 0,
                            SIGMA_MOST_MM, true, err)) ||
      (status = read_number(&view->z_mm, json, index, "z_mm", -Z_MOST_MM, Z_MOST_MM, false,
                            err)) ||
      (status = read_number(&view->z_sigma_mm, json, index, "z_sigma_mm", 0, SIGMA_MOST_MM, false,
                            err))) {
    return status;
  }
  snprintf(field, sizeof field, "pictures[%zu].held_out", index);
  if (placido_json_find(json, field)) {
    status = placido_json_boolean(json, field, &view->held_out, err);
  }
  snprintf(field, sizeof field, "pictures[%zu]", index);
  placido_json_warn_unknown(json, field, known, notes);
  return status;
}

static int read_plan(placido_calibration_plan *plan, const placido_json *json, const char *path,
                     placido_notes *notes, placido_error *err) {
  size_t count;
  int status = read_path(plan->instrument_path, json, "instrument", path, err);
  if (!status) {
    status = placido_json_count(json, "pictures", &count, err);
  }
  if (!status && (count < 1 || count > PLACIDO_BALL_VIEWS_MAX)) {
    status = placido_json_refuse(json, "pictures", err, "has %zu elements, 1 to %d are expected",
                                 count, PLACIDO_BALL_VIEWS_MAX);
  }
  if (!status) {
    plan->views = placido_memory_new(count, sizeof *plan->views, err);
    status = plan->views ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  for (size_t i = 0; !status && i < count; i++) {
    status = read_view(&plan->views[i], json, i, path, notes, err);
    plan->view_count++;
  }
  return status;
}

int placido_calibration_plan_load(placido_calibration_plan *plan, const char *path,
                                  placido_notes *notes, placido_error *err) {
  static const char *const known[] = {"format", "instrument", "pictures", NULL};
  *plan = (placido_calibration_plan){.view_count = 0};
  placido_json *json;
  int status = placido_json_load(&json, path, FORMAT, err);
  if (status) {
    return status;
  }
  status = read_plan(plan, json, path, notes, err);
  if (status) {
    placido_calibration_plan_free(plan);
  } else {
    placido_json_warn_unknown(json, "", known, notes);
  }
  placido_json_free(json);
  return status;
}

void placido_calibration_plan_free(placido_calibration_plan *plan) {
  for (size_t i = 0; i < plan->view_count; i++) {
    placido_frame_free(&plan->views[i].frame);
  }
  placido_memory_free(plan->views);
  *plan = (placido_calibration_plan){.view_count = 0};
}
