/* indices.json: `placido-indices/1`, one object per index; what is not known is null. */
#include "base/json.h"

#include <placido/index.h>

#define FORMAT "placido-indices/1"

/* Each source's share, null where nothing is known of it. */
static json_t *write_budget(const placido_index_value *value) {
  static const char *const names[PLACIDO_SIGMA_SOURCES] = {
      [PLACIDO_SIGMA_NOISE] = "noise",
      [PLACIDO_SIGMA_DISTANCE] = "distance",
      [PLACIDO_SIGMA_GEOMETRY] = "geometry",
  };
  json_t *object = json_object();
  for (int source = 0; source < PLACIDO_SIGMA_SOURCES; source++) {
    if (json_object_set_new(object, names[source], placido_json_real(value->budget[source]))) {
      json_decref(object);
      return NULL;
    }
  }
  return object;
}

static int write_zone(json_t *object, const placido_index_value *value) {
  return value->zone_mm > 0 &&
         (json_object_set_new(object, "zone_mm", placido_json_real(value->zone_mm)) ||
          json_object_set_new(object, "covered", placido_json_real(value->covered)));
}

static json_t *write_index(const placido_index_value *value) {
  json_t *object = json_object();
  if (json_object_set_new(object, "name", json_string(value->name)) ||
      json_object_set_new(object, "unit", json_string(value->unit)) ||
      json_object_set_new(object, "value", placido_json_real(value->value)) ||
      json_object_set_new(object, "sigma", placido_json_real(value->sigma)) ||
      json_object_set_new(object, "budget", write_budget(value)) || write_zone(object, value) ||
      (value->reason && json_object_set_new(object, "reason", json_string(value->reason))) ||
      json_object_set_new(object, "help", json_string(value->help))) {
    json_decref(object);
    return NULL;
  }
  return object;
}

int placido_indices_save(const placido_index_value *values, size_t count, const char *path,
                         placido_error *err) {
  json_t *root = json_object(), *list = json_array();
  int failed = json_object_set_new(root, "format", json_string(FORMAT));
  failed |= json_object_set_new(root, "indices", list);
  for (size_t i = 0; i < count && !failed; i++) {
    failed = json_array_append_new(list, write_index(&values[i]));
  }
  int status = failed ? placido_error_set(err, PLACIDO_MEMORY, "out of memory writing the indices")
                      : placido_json_save(root, path, err);
  json_decref(root);
  return status;
}
