/* session.json: what was recorded, of whom, with what. */
#include "base/session/describe.h"

#include "base/json.h"
#include "base/text.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define FORMAT "placido-session/1"
#define RATE_MAX_HZ 1e6
#define AXIS_Z_MAX_MM 100.0 /* as --axis-z has it */

/* The fields that are text: where they stand in the file and in the struct. */
typedef struct text_field {
  const char *object, *key; /* object NULL: the root */
  size_t offset, size;
} text_field;

/* A macro, because the key in the file and the name of the member are the same word. */
#define TEXT_FIELD(object, key)                                                                   \
  {object, #key, offsetof(placido_session_info, key), sizeof((placido_session_info *)0)->key}

static const text_field text_fields[] = {
    TEXT_FIELD(NULL, created),    TEXT_FIELD(NULL, eye),        TEXT_FIELD(NULL, subject),
    TEXT_FIELD(NULL, software),   TEXT_FIELD("device", driver), TEXT_FIELD("device", vendor),
    TEXT_FIELD("device", model),  TEXT_FIELD("device", serial), TEXT_FIELD("device", firmware),
};
static const size_t text_field_count = sizeof text_fields / sizeof *text_fields;

/* Whether a field has a value: null means "not recorded", too. */
static bool is_given(const placido_json *json, const char *path) {
  const json_t *value = placido_json_find(json, path);
  return value && !json_is_null(value);
}

static int read_texts(placido_session_info *info, const placido_json *json, placido_error *err) {
  int status = PLACIDO_OK;
  if (is_given(json, "device") && !json_is_object(placido_json_find(json, "device"))) {
    status = placido_json_refuse(json, "device", err, "an object is expected");
  }
  for (size_t i = 0; !status && i < text_field_count; i++) {
    const text_field *field = &text_fields[i];
    char path[64];
    snprintf(path, sizeof path, "%s%s%s", field->object ? field->object : "",
             field->object ? "." : "", field->key);
    if (is_given(json, path)) {
      status = placido_json_string(json, path, (char *)info + field->offset, field->size, err);
    }
  }
  if (!status && info->eye[0] && strcmp(info->eye, "OD") != 0 && strcmp(info->eye, "OS") != 0) {
    status = placido_json_refuse(json, "eye", err, "is \"%s\", \"OD\" or \"OS\" is expected",
                                 info->eye);
  }
  return status;
}

static int read_pixel_format(placido_session_info *info, const placido_json *json,
                             placido_error *err) {
  if (!is_given(json, "pixel_format")) {
    return PLACIDO_OK;
  }
  char name[32];
  int status = placido_json_string(json, "pixel_format", name, sizeof name, err);
  if (status) {
    return status;
  }
  bool wide = strcmp(name, "gray16le") == 0;
  if (!wide && strcmp(name, "gray8") != 0) {
    return placido_json_refuse(json, "pixel_format", err,
                               "is \"%s\", \"gray8\" or \"gray16le\" is expected", name);
  }
  info->format = wide ? PLACIDO_MONO16 : PLACIDO_MONO8;
  info->bits = wide ? 16 : 8;
  if (is_given(json, "bit_depth")) {
    status = placido_json_integer(json, "bit_depth", 8, info->bits, &info->bits, err);
  }
  return status;
}

/* A number that may be missing, and where it is given lies from `min` to `max`. */
static int read_number(double *value, const placido_json *json, const char *path, double min,
                       double max, placido_error *err) {
  *value = NAN;
  if (!is_given(json, path)) {
    return PLACIDO_OK;
  }
  int status = placido_json_number(json, path, value, err);
  if (!status && (*value < min || *value > max)) {
    status =
        placido_json_refuse(json, path, err, "is %g, %g to %g is expected", *value, min, max);
  }
  return status;
}

static int read_numbers(placido_session_info *info, const placido_json *json,
                        placido_error *err) {
  int status = read_number(&info->rate_hz, json, "frame_rate_hz", 0, RATE_MAX_HZ, err);
  if (!status) {
    status = read_number(&info->axis_z_mm, json, "axis_z_mm", -AXIS_Z_MAX_MM, AXIS_Z_MAX_MM, err);
  }
  if (!status) {
    status = read_number(&info->axis_z_sigma_mm, json, "axis_z_sigma_mm", 0, AXIS_Z_MAX_MM, err);
  }
  return status;
}

int placido_session_describe_load(placido_session_info *info, const char *path,
                                  placido_notes *notes, placido_error *err) {
  static const char *const root[] = {"format",        "created",   "eye",
                                     "subject",       "device",    "pixel_format",
                                     "bit_depth",     "axis_z_mm", "axis_z_sigma_mm",
                                     "frame_rate_hz", "software",  NULL};
  static const char *const device[] = {"driver", "vendor", "model", "serial", "firmware", NULL};
  *info = (placido_session_info){.rate_hz = NAN, .axis_z_mm = NAN, .axis_z_sigma_mm = NAN};
  placido_json *json;
  int status = placido_json_load(&json, path, FORMAT, err);
  if (status) {
    return status;
  }
  status = read_texts(info, json, err);
  if (!status) {
    status = read_pixel_format(info, json, err);
  }
  if (!status) {
    status = read_numbers(info, json, err);
  }
  if (!status) {
    placido_json_warn_unknown(json, "", root, notes);
    placido_json_warn_unknown(json, "device", device, notes);
  }
  placido_json_free(json);
  return status;
}

/* Adds `value` (taken; NULL where it could not be made); false where that fails. */
static bool add(json_t *object, const char *key, json_t *value) {
  return json_object_set_new(object, key, value) == 0;
}

static bool add_number(json_t *root, const char *key, double value) {
  return !isfinite(value) || add(root, key, json_real(value));
}

static bool add_texts(json_t *root, json_t *device, const placido_session_info *info) {
  bool added = true;
  for (size_t i = 0; added && i < text_field_count; i++) {
    const char *text = (const char *)info + text_fields[i].offset;
    added = !text[0] ||
            add(text_fields[i].object ? device : root, text_fields[i].key, json_string(text));
  }
  return added;
}

int placido_session_describe_save(const placido_session_info *info, const char *path,
                                  placido_error *err) {
  json_t *root = json_object(), *device = json_object();
  bool wide = info->format == PLACIDO_MONO16;
  bool made = root && device && add(root, "format", json_string(FORMAT)) &&
              add_texts(root, device, info) &&
              add(root, "pixel_format", json_string(wide ? "gray16le" : "gray8")) &&
              add(root, "bit_depth", json_integer(info->bits)) &&
              add_number(root, "frame_rate_hz", info->rate_hz) &&
              add_number(root, "axis_z_mm", info->axis_z_mm) &&
              add_number(root, "axis_z_sigma_mm", info->axis_z_sigma_mm) &&
              json_object_set(root, "device", device) == 0;
  int status = made ? placido_json_save(root, path, err)
                    : placido_error_set(err, PLACIDO_INPUT,
                                        "%s: the session's texts are not UTF-8",
                                        placido_text_tail(path));
  json_decref(device);
  json_decref(root);
  return status;
}
