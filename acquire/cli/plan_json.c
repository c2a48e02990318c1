/* Plans within the JSON of a command. */
#include "acquire/cli/plan_json.h"

#include "simulate/plan/file.h"

#include <math.h>

int plan_json_append(json_t *list, const placido_plan *plan, placido_error *err) {
  if (json_array_append_new(list, placido_plan_json(plan)) != 0) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory while writing a plan");
  }
  return PLACIDO_OK;
}

double plan_json_promised(const placido_plan *plan) {
  json_t *root = placido_plan_json(plan);
  const json_t *promised = json_object_get(root, "promised");
  const double value = json_is_number(promised) ? json_number_value(promised) : (double)NAN;
  json_decref(root);
  return value;
}

json_t *plan_json_forced(const struct plan_settings *settings) {
  static const char *const words[] = {
      [PLACIDO_FORCE_NONE] = "", [PLACIDO_FORCE_ON] = "on", [PLACIDO_FORCE_OFF] = "off"};
  const char *name, *summary;
  json_t *object = json_object();
  bool whole = object != NULL;
  for (size_t i = 0; whole && placido_effect_at(i, &name, &summary); i++) {
    const enum placido_force force = settings->force[i];
    whole = force == PLACIDO_FORCE_NONE ||
            json_object_set_new(object, name, json_string(words[force])) == 0;
  }
  if (whole) {
    return object;
  }
  json_decref(object);
  return NULL;
}
