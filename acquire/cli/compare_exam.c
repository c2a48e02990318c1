/* Reads what a comparison needs of an exam's directory, and sets its indices side by side. */
#include "acquire/cli/compare.h"

#include "base/json.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The file that makes a directory an exam, and its format. */
static const struct {
  const char *marker, *format;
} kinds[] = {
    {"exam.json", "placido-exam/1"},
    {"reconstruction.json", "placido-reconstruction/1"},
    {"import.json", "placido-import/1"},
};
#define KINDS (sizeof kinds / sizeof kinds[0])

/* A text that may be missing or null. */
static void read_text(char *text, size_t size, const placido_json *json, const char *path) {
  const json_t *value = placido_json_find(json, path);
  snprintf(text, size, "%s", json_is_string(value) ? json_string_value(value) : "");
}

static int read_marker(struct compared_exam *exam, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  for (size_t k = 0; k < KINDS; k++) {
    int status = placido_path_join(path, exam->path, kinds[k].marker, err);
    if (status != PLACIDO_OK) {
      return status;
    }
    if (access(path, F_OK) != 0) {
      continue;
    }
    placido_json *json;
    status = placido_json_load(&json, path, kinds[k].format, err);
    if (status == PLACIDO_OK) {
      read_text(exam->eye, sizeof exam->eye, json, "input.eye");
      read_text(exam->created, sizeof exam->created, json, "created");
      placido_json_free(json);
    }
    return status;
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "%s is no exam: a directory with exam.json, reconstruction.json or "
                           "import.json was expected",
                           placido_text_tail(exam->path));
}

/* A number, or null for one that is not known. */
static int read_number(double *value, const placido_json *json, size_t index, const char *key,
                       placido_error *err) {
  char path[64];
  snprintf(path, sizeof path, "indices[%zu].%s", index, key);
  *value = NAN;
  return json_is_null(placido_json_find(json, path)) ? PLACIDO_OK
                                                     : placido_json_number(json, path, value, err);
}

static int read_index(struct compared_index *index, const placido_json *json, size_t k,
                      placido_error *err) {
  char path[64];
  snprintf(path, sizeof path, "indices[%zu].name", k);
  int status = placido_json_string(json, path, index->name, sizeof index->name, err);
  snprintf(path, sizeof path, "indices[%zu].unit", k);
  if (status == PLACIDO_OK) {
    status = placido_json_string(json, path, index->unit, sizeof index->unit, err);
  }
  if (status == PLACIDO_OK) {
    status = read_number(&index->value, json, k, "value", err);
  }
  return status == PLACIDO_OK ? read_number(&index->sigma, json, k, "sigma", err) : status;
}

static int read_indices(struct compared_exam *exam, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  size_t count = 0;
  placido_json *json = NULL;
  int status = placido_path_join(path, exam->path, "indices.json", err);
  if (status == PLACIDO_OK) {
    status = placido_json_load(&json, path, "placido-indices/1", err);
  }
  if (status == PLACIDO_OK) {
    status = placido_json_count(json, "indices", &count, err);
  }
  if (status == PLACIDO_OK && count > COMPARE_INDICES_MAX) {
    status = placido_json_refuse(json, "indices", err, "%zu of them, at most %d are expected",
                                 count, COMPARE_INDICES_MAX);
  }
  for (size_t k = 0; k < count && status == PLACIDO_OK; k++) {
    status = read_index(&exam->indices[exam->index_count++], json, k, err);
  }
  placido_json_free(json);
  return status;
}

static bool is_axis(const struct compared_index *index) {
  return strcmp(index->unit, "deg") == 0 && strstr(index->name, "axis") != NULL;
}

static bool ends_with(const char *text, const char *end) {
  size_t length = strlen(text), tail = strlen(end);
  return length >= tail && strcmp(text + length - tail, end) == 0;
}

/* The index of the eye seen in a mirror. */
static void mirror(struct compared_index *index) {
  if (is_axis(index)) {
    index->value = fmod(180 - index->value, 180);
  } else if (ends_with(index->name, "_x_mm")) {
    index->value = -index->value;
  }
}

int compared_exam_load(struct compared_exam *exam, const char *path, bool mirrored,
                       placido_notes *notes, placido_error *err) {
  exam->path = path;
  int status = read_marker(exam, err);
  if (status == PLACIDO_OK) {
    status = placido_measured_load(&exam->measured, path, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = read_indices(exam, err);
  }
  exam->measured.mirrored = mirrored;
  for (size_t k = 0; k < exam->index_count && mirrored; k++) {
    mirror(&exam->indices[k]);
  }
  return status;
}

static const struct compared_index *find_index(const struct compared_exam *exam,
                                               const struct compared_index *wanted) {
  for (size_t k = 0; k < exam->index_count; k++) {
    const struct compared_index *index = &exam->indices[k];
    if (strcmp(index->name, wanted->name) == 0 && strcmp(index->unit, wanted->unit) == 0) {
      return index;
    }
  }
  return NULL;
}

/* An axis of 179 and one of 1 degree are 2 degrees apart. */
static double difference_of(const struct compared_index *first,
                            const struct compared_index *second) {
  double difference = second->value - first->value;
  return is_axis(first) ? remainder(difference, 180) : difference;
}

void compared_indices_find(struct comparison *comparison) {
  const struct compared_exam *first = &comparison->exams[0], *second = &comparison->exams[1];
  for (size_t k = 0; k < first->index_count; k++) {
    const struct compared_index *a = &first->indices[k], *b = find_index(second, a);
    if (b) {
      comparison->changes[comparison->change_count++] = (struct compared_change){
          a->name, a->unit, a->value, b->value, difference_of(a, b), hypot(a->sigma, b->sigma)};
    }
  }
}
