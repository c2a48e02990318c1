/* Reads columns of a grid's file by their names, wherever they stand. */
#include "reconstruct/maps/csv.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BYTES_MAX (64u << 20)
#define REACH_MAX_MM 20.0
#define COLUMNS_MAX (PLACIDO_MAP_COLUMNS_MAX + 3)
#define OFF_GRID 1e-6 /* of a step */

/* A file on its way into arrays. */
typedef struct reader {
  const char *path;
  const char *const *names; /* x_mm and y_mm, then what was asked for */
  int count;                /* of names */
  int places[COLUMNS_MAX];  /* column of each name */
  double step_mm;
  int line;
  double cells[COLUMNS_MAX]; /* of the row, by name */
} reader;

static int refuse(const reader *r, const char *what, const char *column, placido_error *err) {
  return placido_error_set(err, PLACIDO_INPUT, "%s:%d: %s %s", placido_text_tail(r->path), r->line,
                           column, what);
}

static const char *name_of(const reader *r, int index) {
  return index == 0 ? "x_mm" : index == 1 ? "y_mm" : r->names[index - 2];
}

/* The line's next cell, ended in place; NULL behind the last one. */
static char *next_cell(char **rest) {
  char *cell = *rest;
  if (cell) {
    char *comma = strchr(cell, ',');
    *rest = comma ? comma + 1 : NULL;
    if (comma) {
      *comma = '\0';
    }
  }
  return cell;
}

/* The next line without its end, cut off in place; NULL behind the last one. */
static char *next_line(char **rest) {
  char *line = *rest;
  if (!line || *line == '\0') {
    return NULL;
  }
  char *end = strchr(line, '\n');
  *rest = end ? end + 1 : NULL;
  if (end) {
    *end = '\0';
  }
  line[strcspn(line, "\r")] = '\0';
  return line;
}

static int read_header(reader *r, char *line, placido_error *err) {
  int column = 0;
  for (int k = 0; k < r->count; k++) {
    r->places[k] = -1;
  }
  for (char *cell; (cell = next_cell(&line)); column++) {
    for (int k = 0; k < r->count; k++) {
      if (strcmp(cell, name_of(r, k)) == 0) {
        r->places[k] = column;
      }
    }
  }
  for (int k = 0; k < r->count; k++) {
    if (r->places[k] < 0) {
      return refuse(r, "is missing: not a column of the file", name_of(r, k), err);
    }
  }
  return PLACIDO_OK;
}

static int read_cell(reader *r, int k, const char *cell, placido_error *err) {
  char *end;
  r->cells[k] = cell[0] == '\0' ? (double)NAN : strtod(cell, &end);
  if (cell[0] != '\0' && (*end != '\0' || !isfinite(r->cells[k]))) {
    return refuse(r, "is no number", name_of(r, k), err);
  }
  return PLACIDO_OK;
}

static int read_row(reader *r, char *line, placido_error *err) {
  int column = 0, status = PLACIDO_OK, found = 0;
  for (char *cell; !status && (cell = next_cell(&line)); column++) {
    for (int k = 0; k < r->count && !status; k++) {
      if (r->places[k] == column) {
        status = read_cell(r, k, cell, err);
        found++;
      }
    }
  }
  if (!status && found < r->count) {
    status = refuse(r, "has no cell: the row is too short", name_of(r, r->count - 1), err);
  }
  for (int k = 0; k < 2 && !status; k++) {
    double steps = r->cells[k] / r->step_mm;
    if (!(fabs(r->cells[k]) <= REACH_MAX_MM) || fabs(steps - round(steps)) > OFF_GRID) {
      status = refuse(r, "is no place of the grid", name_of(r, k), err);
    }
  }
  return status;
}

/* Reads all rows twice: for the reach, then into the arrays where these are there. */
static int read_all(reader *r, char *text, double **values, int *half, placido_error *err) {
  char *rest = text, *line = next_line(&rest);
  int status = line ? PLACIDO_OK : refuse(r, "is empty", "the file", err), reach = 0;
  r->line = 1;
  if (!status) {
    status = read_header(r, line, err);
  }
  while (!status && (line = next_line(&rest))) {
    r->line++;
    status = read_row(r, line, err);
    int i = (int)lround(r->cells[0] / r->step_mm), j = (int)lround(r->cells[1] / r->step_mm);
    if (!status && values) {
      size_t side = 2 * (size_t)*half + 1;
      for (int k = 2; k < r->count; k++) {
        values[k - 2][(size_t)(j + *half) * side + (size_t)(i + *half)] = r->cells[k];
      }
    } else if (!status) {
      reach = abs(i) > reach ? abs(i) : reach;
      reach = abs(j) > reach ? abs(j) : reach;
    }
  }
  if (!status && !values && reach == 0) {
    status = refuse(r, "has no rows", "the file", err);
  }
  *half = values ? *half : reach;
  return status;
}

static int new_arrays(double **values, int count, int half, placido_error *err) {
  size_t side = 2 * (size_t)half + 1;
  for (int k = 0; k < count; k++) {
    values[k] = placido_memory_new(side * side, sizeof **values, err);
    if (!values[k]) {
      return PLACIDO_MEMORY;
    }
    for (size_t i = 0; i < side * side; i++) {
      values[k][i] = NAN;
    }
  }
  return PLACIDO_OK;
}

int placido_map_columns_load(double **values, int *half, const char *const *names, int count,
                             double step_mm, const char *path, placido_error *err) {
  reader r = {.path = path, .names = names, .count = count + 2, .step_mm = step_mm, .line = 1};
  char *text = NULL, *copy = NULL;
  size_t size;
  for (int k = 0; k < count; k++) {
    values[k] = NULL;
  }
  int status = placido_file_read(&text, &size, path, BYTES_MAX, err);
  if (!status) {
    copy = placido_memory_string(text, err); /* reading cuts the text up */
    status = copy ? read_all(&r, copy, NULL, half, err) : PLACIDO_MEMORY;
  }
  if (!status) {
    status = new_arrays(values, count, *half, err);
  }
  if (!status) {
    status = read_all(&r, text, values, half, err);
  }
  for (int k = 0; k < count && status; k++) {
    placido_memory_free(values[k]);
    values[k] = NULL;
  }
  placido_memory_free(text);
  placido_memory_free(copy);
  return status;
}
