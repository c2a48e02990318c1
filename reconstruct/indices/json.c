/* indices.json: `placido-indices/1`, one object per index; what is not known is null. */
#include "base/json.h"

#include <placido/map.h>

#define FORMAT "placido-indices/1"

static json_t *write_index(const placido_index_value *value) {
  json_t *object = json_object();
  if (json_object_set_new(object, "name", json_string(value->name)) ||
      json_object_set_new(object, "unit", json_string(value->unit)) ||
      json_object_set_new(object, "value", placido_json_real(value->value)) ||
      json_object_set_new(object, "sigma", placido_json_real(value->sigma)) ||
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
