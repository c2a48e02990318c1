/* JSON files whose errors name file, line and field: loading, asking and refusing. */
#include "base/json.h"

#include "base/file.h"
#include "base/json_place.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Far above any file of ours, far below what hurts. */
#define FILE_LIMIT_BYTES ((size_t)256 << 20)

struct placido_json {
  json_t *root;
  char *text;
  char path[PLACIDO_PATH_MAX];
};

static int refuse_syntax(const placido_json *json, size_t size, const json_error_t *cause,
                         placido_error *err) {
  const char *name = placido_text_tail(json->path);
  if (json_error_code(cause) == json_error_out_of_memory) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory reading %s", name);
  }
  if (size == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s:1:1: the file is empty, JSON is expected",
                             name);
  }
  int line = cause->line > 0 ? cause->line : 1, column = cause->column > 0 ? cause->column : 1;
  bool encoding = json_error_code(cause) == json_error_invalid_utf8;
  return placido_error_set(err, PLACIDO_INPUT, "%s:%d:%d: not valid JSON: %s%s", name, line, column,
                           cause->text, encoding ? " (UTF-8 is expected)" : "");
}

/* The words of the format's name, without its version. */
static size_t name_length(const char *format) {
  return strcspn(format, "/");
}

static int check_format(const placido_json *json, const char *expected, placido_error *err) {
  const char *name = placido_text_tail(json->path);
  if (!json_is_object(json->root)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s:%d: not a JSON object (expected format %s)",
                             name, placido_json_line(json->text, ""), expected);
  }
  int line = placido_json_line(json->text, "format");
  const char *found = json_string_value(json_object_get(json->root, "format"));
  if (!found) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s:%d: field format: missing or not a string (expected \"%s\")",
                             name, line, expected);
  }
  if (strcmp(found, expected) == 0) {
    return PLACIDO_OK;
  }
  bool same_name = name_length(found) == name_length(expected) &&
                   strncmp(found, expected, name_length(expected)) == 0;
  return placido_error_set(err, PLACIDO_INPUT,
                           "%s:%d: field format: unknown %s \"%.100s\" (expected \"%s\")", name,
                           line, same_name ? "version" : "format", found, expected);
}

/* Moves the text over a byte order mark, which RFC 8259 (section 8.1) lets a reader ignore and some
 * editors write; returns its length. */
static size_t skip_mark(char *text, size_t size) {
  const size_t mark = 3;
  if (size < mark || memcmp(text, "\xef\xbb\xbf", mark) != 0) {
    return 0;
  }
  memmove(text, text + mark, size - mark + 1);
  return mark;
}

int placido_json_load(placido_json **json, const char *path, const char *format,
                      placido_error *err) {
  *json = NULL;
  placido_json *loaded = placido_memory_new(1, sizeof *loaded, err);
  if (!loaded) {
    return PLACIDO_MEMORY;
  }
  size_t size;
  json_error_t cause;
  snprintf(loaded->path, sizeof loaded->path, "%s", path);
  int status = placido_file_read(&loaded->text, &size, path, FILE_LIMIT_BYTES, err);
  if (status) {
    goto fail;
  }
  size -= skip_mark(loaded->text, size);
  loaded->root = json_loadb(loaded->text, size, JSON_REJECT_DUPLICATES, &cause);
  status = loaded->root ? check_format(loaded, format, err)
                        : refuse_syntax(loaded, size, &cause, err);
  if (status) {
    goto fail;
  }
  *json = loaded;
  return PLACIDO_OK;
fail:
  placido_json_free(loaded);
  return status;
}

void placido_json_free(placido_json *json) {
  if (!json) {
    return;
  }
  json_decref(json->root);
  placido_memory_free(json->text);
  placido_memory_free(json);
}

json_t *placido_json_find(const placido_json *json, const char *path) {
  json_t *value = json->root;
  placido_json_step step;
  while (value && *path) {
    if (!placido_json_step_next(&step, &path)) {
      return NULL;
    }
    value = step.key ? json_object_getn(value, step.key, step.key_length)
                     : json_array_get(value, step.index);
  }
  return value;
}

int placido_json_refuse(const placido_json *json, const char *path, placido_error *err,
                        const char *format, ...) {
  char reason[256] = "";
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason, sizeof reason, format, arguments);
  va_end(arguments);
  return placido_error_set(err, PLACIDO_INPUT, "%s:%d: field %s: %s",
                           placido_text_tail(json->path), placido_json_line(json->text, path),
                           *path ? path : "(the whole)", reason);
}

static int refuse_type(const placido_json *json, const char *path, const char *expected,
                       placido_error *err) {
  static const char *const types[] = {
      [JSON_OBJECT] = "an object", [JSON_ARRAY] = "an array", [JSON_STRING] = "a string",
      [JSON_INTEGER] = "a number", [JSON_REAL] = "a number",  [JSON_TRUE] = "true",
      [JSON_FALSE] = "false",      [JSON_NULL] = "null"};
  const json_t *value = placido_json_find(json, path);
  if (!value) {
    return placido_json_refuse(json, path, err, "missing (%s is expected)", expected);
  }
  return placido_json_refuse(json, path, err, "is %s, %s is expected", types[json_typeof(value)],
                             expected);
}

int placido_json_number(const placido_json *json, const char *path, double *value,
                        placido_error *err) {
  *value = 0;
  const json_t *found = placido_json_find(json, path);
  if (!json_is_number(found)) {
    return refuse_type(json, path, "a number", err);
  }
  *value = json_number_value(found);
  return isfinite(*value) ? PLACIDO_OK : placido_json_refuse(json, path, err, "is not finite");
}

int placido_json_integer(const placido_json *json, const char *path, int min, int max, int *value,
                         placido_error *err) {
  *value = 0;
  double number;
  int status = placido_json_number(json, path, &number, err);
  if (status) {
    return status;
  }
  if (number != floor(number) || number < min || number > max) {
    return placido_json_refuse(json, path, err, "is %.17g, an integer from %d to %d is expected",
                               number, min, max);
  }
  *value = (int)number;
  return PLACIDO_OK;
}

int placido_json_string(const placido_json *json, const char *path, char *value, size_t size,
                        placido_error *err) {
  value[0] = '\0';
  const json_t *found = placido_json_find(json, path);
  if (!json_is_string(found)) {
    return refuse_type(json, path, "a string", err);
  }
  size_t length = json_string_length(found);
  if (length >= size) {
    return placido_json_refuse(json, path, err, "has %zu bytes, at most %zu are expected", length,
                               size - 1);
  }
  memcpy(value, json_string_value(found), length + 1);
  return PLACIDO_OK;
}

int placido_json_boolean(const placido_json *json, const char *path, bool *value,
                         placido_error *err) {
  *value = false;
  const json_t *found = placido_json_find(json, path);
  if (!json_is_boolean(found)) {
    return refuse_type(json, path, "true or false", err);
  }
  *value = json_is_true(found);
  return PLACIDO_OK;
}

int placido_json_numbers(const placido_json *json, const char *path, double *values, size_t count,
                         placido_error *err) {
  for (size_t i = 0; i < count; i++) {
    values[i] = 0;
  }
  const json_t *array = placido_json_find(json, path);
  if (!json_is_array(array)) {
    return refuse_type(json, path, "an array of numbers", err);
  }
  if (json_array_size(array) != count) {
    return placido_json_refuse(json, path, err, "has %zu elements, %zu numbers are expected",
                               json_array_size(array), count);
  }
  for (size_t i = 0; i < count; i++) {
    const json_t *element = json_array_get(array, i);
    values[i] = json_number_value(element);
    if (!json_is_number(element) || !isfinite(values[i])) {
      return placido_json_refuse(json, path, err, "element %zu is not a finite number", i);
    }
  }
  return PLACIDO_OK;
}

int placido_json_count(const placido_json *json, const char *path, size_t *count,
                       placido_error *err) {
  *count = 0;
  const json_t *found = placido_json_find(json, path);
  if (!json_is_array(found) && !json_is_object(found)) {
    return refuse_type(json, path, "an array", err);
  }
  *count = json_is_array(found) ? json_array_size(found) : json_object_size(found);
  return PLACIDO_OK;
}

static bool is_known(const char *key, const char *const *known) {
  while (*known && strcmp(key, *known) != 0) {
    known++;
  }
  return *known != NULL;
}

void placido_json_warn_unknown(const placido_json *json, const char *path,
                               const char *const *known, placido_notes *notes) {
  char keys[256] = "";
  size_t used = 0;
  const char *key;
  json_t *value;
  json_object_foreach(placido_json_find(json, path), key, value) {
    if (!is_known(key, known) && used < sizeof keys) {
      used += (size_t)snprintf(keys + used, sizeof keys - used, "%s%s", used ? ", " : "", key);
    }
  }
  if (used > 0) {
    placido_text_line(keys);
    placido_notes_add(notes, "%s:%d: unknown fields are ignored: %s%s",
                      placido_text_tail(json->path), placido_json_line(json->text, path), keys,
                      used < sizeof keys ? "" : " ...");
  }
}

int placido_json_save(const json_t *root, const char *path, placido_error *err) {
  placido_file file;
  if (!root) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory writing %s",
                             placido_text_tail(path));
  }
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  if (json_dumpf(root, file.stream, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) != 0 &&
      !ferror(file.stream)) {
    placido_file_discard(&file);
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory writing %s",
                             placido_text_tail(path));
  }
  fputc('\n', file.stream);
  return placido_file_commit(&file, err);
}

json_t *placido_json_real(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}
