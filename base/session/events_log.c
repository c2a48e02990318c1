/* events.jsonl: what happened beside the frames, a JSON object a line. */
#include "base/session/events_log.h"

#include "base/file.h"
#include "base/memory.h"

#include <stdbool.h>
#include <string.h>
#include <unistd.h>

static bool is_event(const json_t *line) {
  return json_is_integer(json_object_get(line, "t_ns")) &&
         json_is_string(json_object_get(line, "event"));
}

/* Adds the line's object (taken; NULL: it is no JSON). False: memory is out. */
static bool add_line(placido_events_log *log, json_t *line, size_t number) {
  if (is_event(line)) {
    return json_array_append_new(log->lines, line) == 0;
  }
  json_decref(line);
  log->first_bad = log->bad++ == 0 ? number : log->first_bad;
  return true;
}

static bool read_lines(placido_events_log *log, const char *text, size_t size) {
  bool added = true;
  size_t number = 0;
  for (const char *line = text, *end = text + size; added && line < end;) {
    const char *newline = memchr(line, '\n', (size_t)(end - line));
    const size_t length = (size_t)((newline ? newline : end) - line);
    added = add_line(log, json_loadb(line, length, JSON_REJECT_DUPLICATES, NULL), ++number);
    line += length + 1;
  }
  return added;
}

int placido_events_log_load(placido_events_log *log, const char *folder, placido_error *err) {
  *log = (placido_events_log){.lines = json_array()};
  char path[PLACIDO_PATH_MAX], *text = NULL;
  size_t size = 0;
  int status = placido_path_join(path, folder, "events.jsonl", err);
  if (!status && access(path, F_OK) == 0) {
    status = placido_file_read(&text, &size, path, 0, err);
  }
  if (!status && (!log->lines || !read_lines(log, text, size))) {
    status = placido_error_set(err, PLACIDO_MEMORY, "not enough memory for events.jsonl");
  }
  placido_memory_free(text);
  if (status) {
    placido_events_log_free(log);
  }
  return status;
}

void placido_events_log_free(placido_events_log *log) {
  json_decref(log->lines);
  *log = (placido_events_log){0};
}
