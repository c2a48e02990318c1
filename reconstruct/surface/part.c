/* What all kinds of part have in common: fields that are one number, checked, read and written. */
#include "reconstruct/surface/part.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define KEYS_MAX 16
#define PATH_MAX_BYTES 128

static const double *field_of(const placido_part *part, size_t offset) {
  return (const double *)((const char *)part + offset);
}

bool placido_part_complain(placido_complaint *complaint, const char *field, const char *format,
                           ...) {
  va_list arguments;
  va_start(arguments, format);
  snprintf(complaint->field, sizeof complaint->field, "%s", field);
  vsnprintf(complaint->reason, sizeof complaint->reason, format, arguments);
  va_end(arguments);
  return false;
}

static bool check_field(const placido_part_field *field, double value,
                        placido_complaint *complaint) {
  if (!isfinite(value)) {
    return placido_part_complain(complaint, field->name, "is %g, a finite number is expected",
                                 value);
  }
  if (field->range == PLACIDO_FIELD_NONZERO && value == 0) {
    return placido_part_complain(complaint, field->name, "is 0, which makes no surface");
  }
  if (field->range == PLACIDO_FIELD_POSITIVE && value <= 0) {
    return placido_part_complain(complaint, field->name,
                                 "is %.9g, a number greater than 0 is expected", value);
  }
  return true;
}

bool placido_part_check(const placido_part *part, placido_complaint *complaint) {
  if ((int)part->kind < 0 || part->kind >= PLACIDO_PART_KINDS) {
    return placido_part_complain(complaint, "kind", "is %d, 0 to %d are known", (int)part->kind,
                                 PLACIDO_PART_KINDS - 1);
  }
  const placido_part_row *row = placido_part_rows[part->kind];
  for (size_t i = 0; i < row->field_count; i++) {
    if (!check_field(&row->fields[i], *field_of(part, row->fields[i].offset), complaint)) {
      return false;
    }
  }
  return !row->check || row->check(part, complaint);
}

static void list_kinds(char *text, size_t size) {
  size_t used = 0;
  for (int kind = 0; kind < PLACIDO_PART_KINDS && used < size; kind++) {
    used += (size_t)snprintf(text + used, size - used, "%s%s", kind ? ", " : "",
                             placido_part_rows[kind]->name);
  }
}

static int read_kind(placido_part *part, const placido_json *json, const char *path,
                     placido_error *err) {
  char field[PATH_MAX_BYTES], name[64], known[128];
  snprintf(field, sizeof field, "%s.kind", path);
  int status = placido_json_string(json, field, name, sizeof name, err);
  if (status) {
    return status;
  }
  for (int kind = 0; kind < PLACIDO_PART_KINDS; kind++) {
    if (strcmp(name, placido_part_rows[kind]->name) == 0) {
      part->kind = (enum placido_part_kind)kind;
      return PLACIDO_OK;
    }
  }
  list_kinds(known, sizeof known);
  return placido_json_refuse(json, field, err, "unknown kind \"%s\" (known: %s)", name, known);
}

static int read_field(placido_part *part, const placido_part_field *field, const placido_json *json,
                      const char *path, placido_error *err) {
  char place[PATH_MAX_BYTES];
  double *value = (double *)((char *)part + field->offset);
  snprintf(place, sizeof place, "%s.%s", path, field->name);
  if (field->optional && !placido_json_find(json, place)) {
    *value = field->fallback_offset ? *field_of(part, field->fallback_offset) : field->fallback;
    return PLACIDO_OK;
  }
  return placido_json_number(json, place, value, err);
}

static void warn_unknown(const placido_part_row *row, const placido_json *json, const char *path,
                         placido_notes *notes) {
  const char *keys[KEYS_MAX] = {"kind"};
  size_t count = 1;
  for (size_t i = 0; i < row->field_count; i++) {
    keys[count++] = row->fields[i].name;
  }
  for (const char *const *key = row->other_keys; key && *key; key++) {
    keys[count++] = *key;
  }
  placido_json_warn_unknown(json, path, keys, notes);
}

int placido_part_read(placido_part *part, void **storage, const placido_json *json,
                      const char *path, placido_notes *notes, placido_error *err) {
  *part = (placido_part){0};
  *storage = NULL;
  int status = read_kind(part, json, path, err);
  if (status) {
    return status;
  }
  const placido_part_row *row = placido_part_rows[part->kind];
  for (size_t i = 0; i < row->field_count && !status; i++) {
    status = read_field(part, &row->fields[i], json, path, err);
  }
  if (!status && row->read) {
    status = row->read(part, storage, json, path, err);
  }
  if (status) {
    return status;
  }
  placido_complaint complaint;
  if (!placido_part_check(part, &complaint)) {
    char place[PATH_MAX_BYTES];
    snprintf(place, sizeof place, "%s.%s", path, complaint.field);
    return placido_json_refuse(json, place, err, "%s", complaint.reason);
  }
  warn_unknown(row, json, path, notes);
  return PLACIDO_OK;
}

json_t *placido_part_write(const placido_part *part) {
  const placido_part_row *row = placido_part_rows[part->kind];
  json_t *object = json_object();
  int failed = json_object_set_new(object, "kind", json_string(row->name));
  for (size_t i = 0; i < row->field_count; i++) {
    failed |= json_object_set_new(object, row->fields[i].name,
                                  placido_json_real(*field_of(part, row->fields[i].offset)));
  }
  if (failed || (row->write && row->write(object, part))) {
    json_decref(object);
    return NULL;
  }
  return object;
}

json_t *placido_part_numbers(const double *values, size_t count) {
  json_t *array = json_array();
  for (size_t i = 0; i < count; i++) {
    if (json_array_append_new(array, placido_json_real(values[i]))) {
      json_decref(array);
      return NULL;
    }
  }
  return array;
}
