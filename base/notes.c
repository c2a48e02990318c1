/* Warnings that go with a result: a list of lines without repetitions. */
#include <placido/notes.h>

#include "base/memory.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static bool holds(const placido_notes *notes, const char *line) {
  for (size_t i = 0; i < notes->count; i++) {
    if (strcmp(notes->lines[i], line) == 0) {
      return true;
    }
  }
  return false;
}

void placido_notes_add(placido_notes *notes, const char *format, ...) {
  if (!notes) {
    return;
  }
  char line[1024] = "";
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  placido_text_line(line);
  if (holds(notes, line)) {
    return;
  }
  char **lines = placido_memory_grow(notes->lines, notes->count + 1, sizeof *lines, NULL);
  if (!lines) {
    return;
  }
  notes->lines = lines;
  char *copy = placido_memory_string(line, NULL);
  if (copy) {
    notes->lines[notes->count++] = copy;
  }
}

void placido_notes_clear(placido_notes *notes) {
  if (!notes) {
    return;
  }
  for (size_t i = 0; i < notes->count; i++) {
    placido_memory_free(notes->lines[i]);
  }
  placido_memory_free(notes->lines);
  *notes = (placido_notes){0};
}
