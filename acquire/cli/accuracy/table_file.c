/* `placido-accuracy/1`, docs/formats.md: an accuracy table as a CSV file with its facts in comment
 * lines at its head. */
#include "acquire/cli/accuracy/table.h"

#include "acquire/cli/accuracy/standard.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FORMAT "placido-accuracy/1"
#define SIZE_MAX_BYTES (16u << 20)
#define COLUMNS (3 + ACCURACY_ERRORS + 1)

static void write_number(FILE *stream, double value) {
  if (isfinite(value)) {
    fprintf(stream, ",%.17g", value);
  } else {
    fputc(',', stream);
  }
}

static void write_header(FILE *stream) {
  fputs("stage,setting,eye", stream);
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    fprintf(stream, ",%s", accuracy_error_names[k]);
  }
  fputs(",ms\n", stream);
}

static void write_table(FILE *stream, const struct accuracy_table *table) {
  fprintf(stream, "# %s\n# created %s\n# machine %s\n# probe_ms %.17g\n", FORMAT, table->created,
          table->machine, table->probe_ms);
  write_header(stream);
  for (size_t i = 0; i < table->count; i++) {
    const struct accuracy_row *row = &table->rows[i];
    fprintf(stream, "%s,%s,%s", accuracy_stage_names[row->stage], row->setting, row->eye);
    for (int k = 0; k < ACCURACY_ERRORS; k++) {
      write_number(stream, row->error[k]);
    }
    write_number(stream, row->ms);
    fputc('\n', stream);
  }
}

int accuracy_table_save(const struct accuracy_table *table, const char *path,
                        placido_error *err) {
  placido_file file = {0};
  const int status = placido_file_create(&file, path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  struct accuracy_table clean = *table;
  placido_text_line(clean.created);
  placido_text_line(clean.machine);
  write_table(file.stream, &clean);
  return placido_file_commit(&file, err);
}

/* Where in which file reading is. */
struct place {
  const char *name;
  size_t line;
};

static int refuse(const struct place *place, const char *expected, const char *found,
                  placido_error *err) {
  return placido_error_set(err, PLACIDO_INPUT, "%s:%zu: %s was expected, not \"%.80s\"",
                           place->name, place->line, expected, found);
}

/* The text behind a fact's name on its line; NULL where the line is another. */
static const char *fact_of(const char *line, const char *name) {
  const size_t length = strlen(name);
  if (strncmp(line, "# ", 2) != 0 || strncmp(line + 2, name, length) != 0) {
    return NULL;
  }
  line += 2 + length;
  return *line == ' ' ? line + 1 : *line == '\0' ? line : NULL;
}

/* A finite number of at least 0 that fills the field. */
static bool read_number(double *value, const char *field) {
  char *end;
  *value = strtod(field, &end);
  return end != field && *end == '\0' && isfinite(*value) && *value >= 0.0;
}

/* The head's four lines in their order. */
static int read_fact(struct accuracy_table *table, const char *line, const struct place *place,
                     placido_error *err) {
  static const char *const names[] = {"created", "machine", "probe_ms"};
  if (place->line == 1) {
    return strcmp(line, "# " FORMAT) == 0 ? PLACIDO_OK
                                          : refuse(place, "\"# " FORMAT "\"", line, err);
  }
  char expected[32];
  const char *name = names[place->line - 2], *text = fact_of(line, name);
  snprintf(expected, sizeof expected, "\"# %s ...\"", name);
  if (!text) {
    return refuse(place, expected, line, err);
  }
  if (place->line == 2) {
    snprintf(table->created, sizeof table->created, "%s", text);
  } else if (place->line == 3) {
    snprintf(table->machine, sizeof table->machine, "%s", text);
  } else if (!read_number(&table->probe_ms, text) || table->probe_ms <= 0.0) {
    return refuse(place, "a time over 0", text, err);
  }
  return PLACIDO_OK;
}

static int find_stage(const char *name) {
  int stage = 0;
  while (stage < ACCURACY_STAGES && strcmp(name, accuracy_stage_names[stage]) != 0) {
    stage++;
  }
  return stage;
}

static int read_text(char *text, size_t size, const char *field, const struct place *place,
                     placido_error *err) {
  const int length = snprintf(text, size, "%s", field);
  return length >= 0 && (size_t)length < size ? PLACIDO_OK
                                              : refuse(place, "a shorter text", field, err);
}

static int read_row(struct accuracy_table *table, char *line, const struct place *place,
                    placido_error *err) {
  struct accuracy_row row = {0};
  char *fields[COLUMNS];
  size_t count = 0;
  for (char *field; (field = strsep(&line, ",")) != NULL; count++) {
    if (count < COLUMNS) {
      fields[count] = field;
    }
  }
  if (count != COLUMNS) {
    return placido_error_set(err, PLACIDO_INPUT, "%s:%zu: %d columns were expected, not %zu",
                             place->name, place->line, COLUMNS, count);
  }
  const int stage = find_stage(fields[0]);
  if (stage == ACCURACY_STAGES) {
    return refuse(place, "a stage (mires, fit, trace ...)", fields[0], err);
  }
  row.stage = (enum accuracy_stage)stage;
  int status = read_text(row.setting, sizeof row.setting, fields[1], place, err);
  if (status == PLACIDO_OK) {
    status = read_text(row.eye, sizeof row.eye, fields[2], place, err);
  }
  for (int k = 0; k < ACCURACY_ERRORS && status == PLACIDO_OK; k++) {
    row.error[k] = NAN;
    if (fields[3 + k][0] != '\0' && !read_number(&row.error[k], fields[3 + k])) {
      status = refuse(place, "an error of 0 or more", fields[3 + k], err);
    }
  }
  if (status == PLACIDO_OK && !read_number(&row.ms, fields[COLUMNS - 1])) {
    status = refuse(place, "a time of 0 or more", fields[COLUMNS - 1], err);
  }
  return status == PLACIDO_OK ? accuracy_table_add(table, &row, err) : status;
}

static int read_header(const char *line, const struct place *place, placido_error *err) {
  char expected[160];
  size_t used = (size_t)snprintf(expected, sizeof expected, "stage,setting,eye");
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    used += (size_t)snprintf(expected + used, sizeof expected - used, ",%s",
                             accuracy_error_names[k]);
  }
  snprintf(expected + used, sizeof expected - used, ",ms");
  return strcmp(line, expected) == 0 ? PLACIDO_OK : refuse(place, expected, line, err);
}

/* Cuts `text` into lines and reads them. */
static int read_table(struct accuracy_table *table, char *text, const char *name,
                      placido_error *err) {
  struct place place = {.name = name};
  int status = PLACIDO_OK;
  for (char *line; status == PLACIDO_OK && (line = strsep(&text, "\n")) != NULL;) {
    line[strcspn(line, "\r")] = '\0';
    place.line++;
    if (place.line <= 4) {
      status = read_fact(table, line, &place, err);
    } else if (place.line == 5) {
      status = read_header(line, &place, err);
    } else if (*line != '\0') {
      status = read_row(table, line, &place, err);
    }
  }
  if (status == PLACIDO_OK && table->count == 0) {
    status = placido_error_set(err, PLACIDO_INPUT, "%s:%zu: the table ends without a row", name,
                               place.line);
  }
  return status;
}

/* Takes the text, of `size` bytes. */
static int take_text(struct accuracy_table *table, char *text, size_t size, const char *name,
                     placido_error *err) {
  *table = (struct accuracy_table){0};
  const int status = strlen(text) == size
                         ? read_table(table, text, name, err)
                         : placido_error_set(err, PLACIDO_INPUT, "%s holds zero bytes", name);
  placido_memory_free(text);
  if (status != PLACIDO_OK) {
    accuracy_table_free(table);
  }
  return status;
}

int accuracy_table_load(struct accuracy_table *table, const char *path, placido_error *err) {
  char *text;
  size_t size;
  *table = (struct accuracy_table){0};
  const int status = placido_file_read(&text, &size, path, SIZE_MAX_BYTES, err);
  return status == PLACIDO_OK ? take_text(table, text, size, placido_text_tail(path), err)
                              : status;
}

int accuracy_table_built_in(struct accuracy_table *table, placido_error *err) {
  *table = (struct accuracy_table){0};
  char *text = placido_memory_string((const char *)accuracy_standard_csv, err);
  return text ? take_text(table, text, strlen(text), "the built-in accuracy table", err)
              : PLACIDO_MEMORY;
}
