/* The script of faults, line by line: when, what, how many or how long. */
#include "drivers/replay/faults.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILE_MAX 65536
#define LINE_MAX_CHARACTERS 120
#define WORDS_MAX 5 /* at frame 12 drop 3 */
#define SECONDS_MAX 1e6
#define FRAMES_MAX 1000000000
#define BLANKS " \t\r"

enum argument { FRAMES, TIME, TIME_OR_FOR_EVER };

static const struct {
  const char *name;
  enum argument argument;
} kinds[PLACIDO_FAULT_KINDS] = {
    [PLACIDO_FAULT_DROP] = {"drop", FRAMES},
    [PLACIDO_FAULT_TRUNCATE] = {"truncate", FRAMES},
    [PLACIDO_FAULT_CORRUPT] = {"corrupt", FRAMES},
    [PLACIDO_FAULT_DAMAGE] = {"damage", FRAMES},
    [PLACIDO_FAULT_DELAY] = {"delay", TIME},
    [PLACIDO_FAULT_DISCONNECT] = {"disconnect", TIME_OR_FOR_EVER},
    [PLACIDO_FAULT_ERROR] = {"error", FRAMES},
};

/* One line cut into words. */
struct line {
  const char *name; /* of the script */
  int number;
  char text[LINE_MAX_CHARACTERS + 1];
  char *words[WORDS_MAX + 1];
  size_t count;
};

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static int refuse(const struct line *line, placido_error *err, const char *format, ...);

static int refuse(const struct line *line, placido_error *err, const char *format, ...) {
  char what[256];
  va_list values;
  va_start(values, format);
  vsnprintf(what, sizeof what, format, values);
  va_end(values);
  return placido_error_set(err, PLACIDO_INPUT, "%s:%d: %s", placido_text_tail(line->name),
                           line->number, what);
}

static int cut_line(struct line *line, const char *text, size_t size, placido_error *err) {
  const char *comment = memchr(text, '#', size);
  const size_t length = comment ? (size_t)(comment - text) : size;
  if (length > LINE_MAX_CHARACTERS) {
    return refuse(line, err, "a line of more than %d characters", LINE_MAX_CHARACTERS);
  }
  if (memchr(text, '\0', length)) {
    return refuse(line, err, "a zero byte is no text");
  }
  memcpy(line->text, text, length);
  line->text[length] = '\0';
  line->count = 0;
  char *rest = NULL;
  for (char *word = strtok_r(line->text, BLANKS, &rest); word;
       word = strtok_r(NULL, BLANKS, &rest)) {
    if (line->count == WORDS_MAX) {
      return refuse(line, err, "\"%s\" is one word too many", word);
    }
    line->words[line->count++] = word;
  }
  return PLACIDO_OK;
}

/* A whole number within a range. */
static bool read_count(int64_t *count, const char *word, int64_t least, int64_t most) {
  const size_t digits = strspn(word, "0123456789");
  if (digits < 1 || digits > 12 || word[digits] != '\0') {
    return false;
  }
  *count = strtoll(word, NULL, 10);
  return *count >= least && *count <= most;
}

/* A time with its unit, as 2.5s or 200ms. */
static bool read_time(int64_t *time_ns, const char *word) {
  const size_t length = strspn(word, "0123456789.");
  const bool is_ms = strcmp(word + length, "ms") == 0;
  char *end;
  const double value = strtod(word, &end);
  if (length < 1 || length > 20 || end != word + length ||
      (!is_ms && strcmp(word + length, "s") != 0)) {
    return false;
  }
  const double seconds = is_ms ? value / 1e3 : value;
  if (!(seconds <= SECONDS_MAX)) {
    return false;
  }
  *time_ns = (int64_t)(seconds * 1e9 + 0.5);
  return true;
}

/* "at frame N" or "at TIME"; `*used` words of it. */
static int read_when(placido_fault *fault, size_t *used, const struct line *line,
                     placido_error *err) {
  if (strcmp(line->words[0], "at") != 0 || line->count < 2) {
    return refuse(line, err, "\"%s\": a line is \"at frame N FAULT\" or \"at TIME FAULT\"",
                  line->words[0]);
  }
  fault->is_by_time = strcmp(line->words[1], "frame") != 0;
  *used = fault->is_by_time ? 2 : 3;
  if (fault->is_by_time) {
    return read_time(&fault->at, line->words[1])
               ? PLACIDO_OK
               : refuse(line, err, "\"%s\" is neither \"frame\" nor a time such as 2.5s or 200ms",
                        line->words[1]);
  }
  if (line->count < 3 || !read_count(&fault->at, line->words[2], 0, FRAMES_MAX)) {
    return refuse(line, err, "\"%s\" is no frame's number, 0 to %d",
                  line->count < 3 ? "" : line->words[2], FRAMES_MAX);
  }
  return PLACIDO_OK;
}

static int read_kind(placido_fault *fault, const struct line *line, size_t at,
                     placido_error *err) {
  if (at >= line->count) {
    return refuse(line, err, "what goes wrong is missing: drop, truncate, corrupt, damage, delay, "
                             "disconnect or error");
  }
  for (int kind = 0; kind < PLACIDO_FAULT_KINDS; kind++) {
    if (strcmp(line->words[at], kinds[kind].name) == 0) {
      fault->kind = (enum placido_fault_kind)kind;
      return PLACIDO_OK;
    }
  }
  return refuse(line, err, "\"%s\" is not drop, truncate, corrupt, damage, delay, disconnect or "
                           "error",
                line->words[at]);
}

/* How many or how long, where that stands there. */
static int read_argument(placido_fault *fault, const struct line *line, size_t at,
                         placido_error *err) {
  const enum argument argument = kinds[fault->kind].argument;
  const char *name = kinds[fault->kind].name, *word = at < line->count ? line->words[at] : NULL;
  fault->frames = 1;
  fault->duration_ns = argument == TIME_OR_FOR_EVER ? INT64_MAX : 0;
  if (argument == FRAMES && word && !read_count(&fault->frames, word, 1, FRAMES_MAX)) {
    return refuse(line, err, "%s \"%s\": a number of frames was expected, 1 to %d", name, word,
                  FRAMES_MAX);
  }
  if ((argument == TIME && !word) ||
      (argument != FRAMES && word && !read_time(&fault->duration_ns, word))) {
    return refuse(line, err, "%s \"%s\": a time was expected, such as 2.5s or 200ms", name,
                  word ? word : "");
  }
  if (at + 1 < line->count) {
    return refuse(line, err, "\"%s\" is one word too many", line->words[at + 1]);
  }
  return PLACIDO_OK;
}

static int read_line(placido_faults *faults, const struct line *line, placido_error *err) {
  placido_fault fault = {0};
  size_t used = 0;
  int status = read_when(&fault, &used, line, err);
  if (!status) {
    status = read_kind(&fault, line, used, err);
  }
  if (!status) {
    status = read_argument(&fault, line, used + 1, err);
  }
  if (!status && faults->count == PLACIDO_FAULTS_MAX) {
    status = refuse(line, err, "more than %d faults", PLACIDO_FAULTS_MAX);
  }
  if (!status) {
    faults->list[faults->count++] = fault;
  }
  return status;
}

int placido_faults_parse(placido_faults *faults, const char *text, size_t size, const char *name,
                         placido_error *err) {
  faults->count = 0;
  struct line line = {.name = name};
  for (size_t at = 0; at < size;) {
    const char *newline = memchr(text + at, '\n', size - at);
    const size_t length = newline ? (size_t)(newline - text) - at : size - at;
    line.number++;
    int status = cut_line(&line, text + at, length, err);
    if (!status && line.count > 0) {
      status = read_line(faults, &line, err);
    }
    if (status) {
      faults->count = 0;
      return status;
    }
    at += length + 1;
  }
  return PLACIDO_OK;
}

int placido_faults_load(placido_faults *faults, const char *path, placido_error *err) {
  faults->count = 0;
  char *text;
  size_t size;
  int status = placido_file_read(&text, &size, path, FILE_MAX, err);
  if (!status) {
    status = placido_faults_parse(faults, text, size, path, err);
    placido_memory_free(text);
  }
  return status;
}
