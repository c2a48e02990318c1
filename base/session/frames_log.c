/* frames.jsonl: what the device said of each frame, a JSON object a line. */
#include "base/session/frames_log.h"

#include "base/file.h"
#include "base/json.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of times, indices and counters: sums and differences of some stay far from overflow. 146 years. */
#define NUMBER_MAX (INT64_MAX / 2)
/* So many bad lines are reported one by one; the rest of a ruined file as a number. */
#define REPORTED_MAX 10

json_t *placido_frames_log_line(const placido_frame_info *frame) {
  return json_pack("{s:I, s:I, s:I, s:o, s:o, s:I, s:o*}",
                   "index", (json_int_t)frame->index,
                   "timestamp_ns", (json_int_t)frame->t_ns,
                   "sequence", (json_int_t)frame->seq,
                   "exposure_us", placido_json_real(frame->exposure_us),
                   "gain_db", placido_json_real(frame->gain_db),
                   "flags", (json_int_t)frame->flags,
                   "crc32", frame->has_crc32 ? json_integer(frame->crc32) : NULL);
}

/* An integer of an object within 0..max; `missing` where it has no such key. False: of another
 * type or out of range. */
static bool read_integer(const json_t *object, const char *key, json_int_t missing, json_int_t max,
                         json_int_t *value) {
  const json_t *found = json_object_get(object, key);
  *value = missing;
  if (found) {
    *value = json_is_integer(found) ? json_integer_value(found) : -1;
  }
  return *value >= 0 && *value <= max;
}

static double read_real(const json_t *object, const char *key) {
  const json_t *found = json_object_get(object, key);
  return json_is_number(found) ? json_number_value(found) : NAN;
}

/* NULL, or what is wrong with the line. */
static const char *parse_line(placido_frame_info *frame, const char *line, size_t length) {
  json_error_t cause;
  json_t *object = json_loadb(line, length, JSON_REJECT_DUPLICATES, &cause);
  json_int_t index, t_ns, seq, flags, crc32;
  const char *fault = NULL;
  if (!json_is_object(object)) {
    fault = "is not a JSON object";
  } else if (!read_integer(object, "index", -1, NUMBER_MAX, &index)) {
    fault = "has no valid index";
  } else if (!read_integer(object, "timestamp_ns", -1, NUMBER_MAX, &t_ns)) {
    fault = "has no valid timestamp_ns";
  } else if (!read_integer(object, "sequence", index, NUMBER_MAX, &seq)) {
    fault = "has no valid sequence";
  } else if (!read_integer(object, "flags", 0, UINT32_MAX, &flags)) {
    fault = "has no valid flags";
  } else if (!read_integer(object, "crc32", 0, UINT32_MAX, &crc32)) {
    fault = "has no valid crc32";
  } else {
    *frame = (placido_frame_info){.index = index,
                                  .t_ns = t_ns,
                                  .seq = (uint64_t)seq,
                                  .exposure_us = read_real(object, "exposure_us"),
                                  .gain_db = read_real(object, "gain_db"),
                                  .flags = (uint32_t)flags,
                                  .has_crc32 = json_object_get(object, "crc32") != NULL,
                                  .crc32 = (uint32_t)crc32};
  }
  json_decref(object);
  return fault;
}

static int by_index(const void *a, const void *b) {
  const placido_frame_info *first = a, *second = b;
  return (first->index > second->index) - (first->index < second->index);
}

static size_t count_lines(const char *text, size_t size) {
  size_t lines = 1;
  for (size_t i = 0; i < size; i++) {
    lines += text[i] == '\n';
  }
  return lines;
}

/* Parses every line into log->frames, which has room for all of them. */
static void parse_lines(placido_frames_log *log, const char *text, size_t size, const char *path,
                        placido_notes *notes) {
  size_t bad = 0, number = 0;
  for (const char *line = text, *end = text + size; line < end;) {
    const char *newline = memchr(line, '\n', (size_t)(end - line));
    size_t length = (size_t)((newline ? newline : end) - line);
    const char *fault =
        length > 0 ? parse_line(&log->frames[log->count], line, length) : "is empty";
    number++;
    if (!fault) {
      log->count++;
    } else if (++bad <= REPORTED_MAX) {
      placido_notes_add(notes, "%s:%zu: ignored, the line %s", placido_text_tail(path), number,
                        fault);
    }
    line += length + 1;
  }
  log->bad = bad;
  if (bad > REPORTED_MAX) {
    placido_notes_add(notes, "%s: %zu more lines are ignored", placido_text_tail(path),
                      bad - REPORTED_MAX);
  }
}

/* Sorts by index and keeps one line of each. */
static void sort(placido_frames_log *log, const char *path, placido_notes *notes) {
  if (log->count == 0) {
    return;
  }
  qsort(log->frames, log->count, sizeof *log->frames, by_index);
  size_t kept = 1;
  for (size_t i = 1; i < log->count; i++) {
    if (log->frames[i].index != log->frames[kept - 1].index) {
      log->frames[kept++] = log->frames[i];
    }
  }
  if (kept < log->count) {
    placido_notes_add(notes, "%s: %zu lines are ignored, their index stands there twice",
                      placido_text_tail(path), log->count - kept);
  }
  log->bad += log->count - kept;
  log->count = kept;
}

int placido_frames_log_load(placido_frames_log *log, const char *path, placido_notes *notes,
                            placido_error *err) {
  *log = (placido_frames_log){0};
  if (access(path, F_OK) != 0) {
    return PLACIDO_OK;
  }
  char *text;
  size_t size;
  int status = placido_file_read(&text, &size, path, 0, err);
  if (status) {
    return status;
  }
  log->frames = placido_memory_new(count_lines(text, size), sizeof *log->frames, err);
  if (log->frames) {
    parse_lines(log, text, size, path, notes);
    sort(log, path, notes);
  } else {
    status = PLACIDO_MEMORY;
  }
  placido_memory_free(text);
  return status;
}

const placido_frame_info *placido_frames_log_find(const placido_frames_log *log, int64_t index) {
  const placido_frame_info key = {.index = index};
  return log->count > 0 ? bsearch(&key, log->frames, log->count, sizeof key, by_index) : NULL;
}

const placido_frame_info *placido_frames_log_find_checksum(const placido_frames_log *log,
                                                           int64_t index, uint32_t crc32) {
  for (size_t i = 0; i < log->count; i++) {
    const placido_frame_info *line = &log->frames[i];
    if (line->index >= index && line->has_crc32 && line->crc32 == crc32) {
      return line;
    }
  }
  return NULL;
}

void placido_frames_log_free(placido_frames_log *log) {
  placido_memory_free(log->frames);
  *log = (placido_frames_log){0};
}
