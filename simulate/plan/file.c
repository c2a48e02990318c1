/* A plan on disk: `placido-plan/1` (docs/formats.md). */
#include "simulate/plan/file.h"

#include "base/json.h"
#include "simulate/plan/plan.h"

/* Takes both references; false where memory is out. */
static bool put(json_t *object, const char *key, json_t *value) {
  return json_object_set_new(object, key, value) == 0;
}

static bool put_real(json_t *object, const char *key, double value) {
  return put(object, key, placido_json_real(value));
}

/* `object`, or NULL where it is not whole. */
static json_t *checked(json_t *object, bool whole) {
  if (whole) {
    return object;
  }
  json_decref(object);
  return NULL;
}

static json_t *scene_json(const placido_plan *plan) {
  const placido_conditions *conditions = &plan->scene->conditions;
  json_t *object = json_object();
  bool whole = put(object, "name", json_string(plan->scene->name)) &&
               put_real(object, "width_deg", plan->facts.width_deg) &&
               put_real(object, "height_deg", plan->facts.height_deg) &&
               put_real(object, "luminance_cd_m2", conditions->luminance_cd_m2) &&
               put_real(object, "nearest_D", plan->facts.nearest_D) &&
               put_real(object, "farthest_D", plan->facts.farthest_D);
  return checked(object, whole);
}

static json_t *eye_json(const placido_eye *eye) {
  static const char *const irises[] = {"brown", "dark", "green", "blue"};
  double sphere_D, cylinder_D, axis_deg;
  json_t *object = json_object();
  placido_correction_clinical(&eye->correction, &sphere_D, &cylinder_D, &axis_deg);
  bool whole = put_real(object, "pupil_mm", eye->pupil_mm) &&
               put_real(object, "pupil_x_mm", eye->pupil_x_mm) &&
               put_real(object, "pupil_y_mm", eye->pupil_y_mm) &&
               put_real(object, "retina_mm", eye->retina_mm) &&
               put_real(object, "sphere_D", sphere_D) &&
               put_real(object, "cylinder_D", cylinder_D) &&
               put_real(object, "axis_deg", axis_deg) &&
               put_real(object, "age_years", eye->age_years) &&
               put(object, "iris", json_string(irises[eye->iris]));
  return checked(object, whole);
}

static json_t *verdict_json(const placido_verdict *verdict) {
  static const char *const forces[] = {"none", "on", "off"};
  json_t *object = json_object();
  bool whole = put(object, "name", json_string(verdict->name)) &&
               put(object, "summary", json_string(verdict->summary)) &&
               put(object, "runs", json_boolean(verdict->runs)) &&
               put(object, "applies", json_boolean(verdict->applies)) &&
               put(object, "force", json_string(forces[verdict->force])) &&
               put_real(object, "bound", verdict->bound) &&
               put_real(object, "cost_ms", verdict->cost_ms) &&
               put(object, "reason", json_string(verdict->reason));
  return checked(object, whole);
}

static json_t *effects_json(const placido_plan *plan) {
  json_t *list = json_array();
  bool whole = list != NULL;
  for (size_t i = 0; i < plan->effects.count; i++) {
    whole = json_array_append_new(list, verdict_json(&plan->verdicts[i])) == 0 && whole;
  }
  return checked(list, whole);
}

static json_t *settings_json(const placido_plan_settings *settings) {
  json_t *object = json_object();
  bool whole = put(object, "pupil_samples", json_integer(settings->pupil_samples)) &&
               put(object, "wavelengths", json_integer(settings->wavelengths)) &&
               put(object, "layers", json_integer(settings->layers)) &&
               put(object, "nodes", json_integer(settings->nodes)) &&
               put(object, "buckets", json_integer(settings->buckets)) &&
               put_real(object, "bucket_arcmin", settings->bucket_arcmin) &&
               put(object, "doubles", json_boolean(settings->doubles)) &&
               put_real(object, "bound", settings->bound) &&
               put_real(object, "cost_ms", settings->cost_ms);
  return checked(object, whole);
}

json_t *placido_plan_json(const placido_plan *plan) {
  double asking, settling;
  json_t *root = json_object();
  placido_plan_seconds(plan, &asking, &settling);
  bool whole = put(root, "format", json_string("placido-plan/1")) &&
               put(root, "scene", scene_json(plan)) && put(root, "eye", eye_json(&plan->eye)) &&
               put_real(root, "tolerance", plan->wish.tolerance) &&
               put(root, "finest", json_boolean(plan->wish.finest)) &&
               put(root, "effects", effects_json(plan)) &&
               put_real(root, "left_out", plan->left_out) &&
               put(root, "settings", settings_json(&plan->settings)) &&
               put_real(root, "promised", plan->left_out + plan->settings.bound) &&
               put_real(root, "seconds_asking", asking) &&
               put_real(root, "seconds_settling", settling);
  return checked(root, whole);
}

int placido_plan_save(const placido_plan *plan, const char *path, placido_error *err) {
  json_t *root = placido_plan_json(plan);
  if (root == NULL) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory while writing %s", path);
  }
  int status = placido_json_save(root, path, err);
  json_decref(root);
  return status;
}
