/* The report of a calibration as JSON. */
#include <placido/calibrate.h>

#include "base/json.h"

#include <jansson.h>
#include <math.h>

#define FORMAT "placido-calibration-report/1"

/* Puts a new value into an array that may be NULL already; NULL once anything is missing. */
static json_t *extend(json_t *array, json_t *element) {
  if (json_array_append_new(array, element) != 0) {
    json_decref(array);
    array = NULL;
  }
  return array;
}

static json_t *triple(const double values[3]) {
  return json_pack("[o, o, o]", placido_json_real(values[0]), placido_json_real(values[1]),
                   placido_json_real(values[2]));
}

static json_t *check_object(const placido_ball_check *check) {
  return json_pack("{s:o, s:o, s:o, s:o, s:o}", "radius_mm", placido_json_real(check->radius_mm),
                   "rms_6_um", placido_json_real(check->rms_6_um), "rms_8_um",
                   placido_json_real(check->rms_8_um), "power_error_D",
                   triple(check->power_error_D), "worst_power_D",
                   placido_json_real(check->worst_power_D));
}

static json_t *view_object(const placido_ball_view *view, const placido_view_result *result) {
  json_t *name = json_string(view->path); /* NULL where it is not UTF-8 */
  json_t *object = json_pack("{s:o, s:o, s:b, s:b, s:I}", "file", name ? name : json_null(),
                             "radius_mm", placido_json_real(view->radius_mm), "held_out",
                             (int)view->held_out, "solved", (int)result->solved, "points",
                             (json_int_t)result->points);
  if (!object) {
    return NULL;
  }
  bool measured = result->solved || result->checked;
  int failed = 0;
  if (measured) {
    failed |= json_object_set_new(object, "vertex_mm", triple(result->vertex_mm));
    failed |= json_object_set_new(object, "rms_px", placido_json_real(result->rms_px));
  }
  if (result->solved) {
    failed |= json_object_set_new(object, "z_less_plan_mm",
                                  placido_json_real(result->z_less_plan_mm));
  }
  if (result->checked) {
    failed |= json_object_set_new(object, "check", check_object(&result->check));
  }
  if (failed) {
    json_decref(object);
    return NULL;
  }
  return object;
}

static json_t *views_array(const placido_calibration *c, const placido_ball_view *views) {
  json_t *array = json_array();
  for (size_t v = 0; v < c->view_count; v++) {
    array = extend(array, view_object(&views[v], &c->views[v]));
  }
  return array;
}

static json_t *balls_array(const placido_calibration *c) {
  json_t *array = json_array();
  for (size_t b = 0; b < c->ball_count; b++) {
    const placido_ball_result *ball = &c->balls[b];
    array = extend(array, json_pack("{s:o, s:o, s:o, s:o}", "plan_mm",
                                    placido_json_real(ball->start_mm), "plan_sigma_mm",
                                    placido_json_real(ball->start_sigma_mm), "radius_mm",
                                    placido_json_real(ball->radius_mm), "sigma_mm",
                                    placido_json_real(ball->sigma_mm)));
  }
  return array;
}

static json_t *edges_array(const placido_calibration *c) {
  json_t *array = json_array();
  for (int k = 0; k < c->instrument.edge_count; k++) {
    array = extend(array, json_pack("{s:I, s:o, s:o}", "points", (json_int_t)c->edge_points[k],
                                    "rms_px", placido_json_real(c->edge_rms_px[k]), "mean_px",
                                    placido_json_real(c->edge_mean_px[k])));
  }
  return array;
}

static json_t *undetermined_array(const placido_calibration *c) {
  json_t *array = json_array();
  for (int i = 0; i < c->undetermined_count; i++) {
    array = extend(array, json_pack("{s:o, s:s}", "share_of_prior",
                                    placido_json_real(c->undetermined[i].share), "direction",
                                    c->undetermined[i].text));
  }
  return array;
}

int placido_calibration_save(const placido_calibration *calibration,
                             const placido_ball_view *views, const char *path,
                             placido_error *err) {
  const placido_calibration *c = calibration;
  json_t *root = json_pack(
      "{s:s, s:s, s:{s:o, s:o, s:o, s:I, s:i, s:i, s:o}, s:o, s:o, s:o, s:o}", "format", FORMAT,
      "instrument", c->instrument.name, "solution", "rms_px", placido_json_real(c->rms_px),
      "sigma_px", placido_json_real(c->sigma_px), "inflation", placido_json_real(c->inflation),
      "points", (json_int_t)c->points, "steps", c->steps, "rounds", c->rounds, "condition",
      placido_json_real(c->condition), "balls", balls_array(c), "pictures",
      views_array(c, views), "edges", edges_array(c), "undetermined", undetermined_array(c));
  if (!root) {
    return placido_error_set(err, PLACIDO_MEMORY, "cannot put the calibration into JSON");
  }
  int status = placido_json_save(root, path, err);
  json_decref(root);
  return status;
}
