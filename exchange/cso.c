/* A CSO topographer's export: a header of "name : value" and "name = value" lines between rulers,
 * then a number a line: the radius (mm) of every ring on every semi-meridian, the innermost ring
 * first, and in the same order the heights (mm, 0 at the apex, falling outwards). */
#include "base/memory.h"
#include "exchange/elevation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEADER_BYTES 4096 /* within which a CSO export shows what it is */
#define HEADER_LINES 100
#define RINGS_MAX 200
#define MERIDIANS_MAX 3600
#define RADIUS_MAX_MM 20.0
#define PI 3.14159265358979323846

static const char rings_mark[] = "Anelli", meridians_mark[] = "Semimeridiani";

/* Radius -1 says that a point is missing; -1000 is how the header says it. The other block is not
 * asked: there -1 is a height that a cornea may have. */
static const double missing_marks[] = {-1.0, -1000.0};

bool placido_cso_recognise(const char *text) {
  const char *mark = strstr(text, meridians_mark);
  return mark && mark - text < HEADER_BYTES;
}

/* What stands behind the first ':' or '=' of a line that holds `name`; NULL for other lines. */
static char *value_of(char *line, const char *name) {
  char *found = strstr(line, name);
  char *mark = found ? strpbrk(found, ":=") : NULL;
  return mark ? placido_text_trim(mark + 1) : NULL;
}

static int read_count(int *count, const placido_reader *reader, const char *value, const char *name,
                      int most, placido_error *err) {
  double number;
  if (!placido_text_number(value, false, &number) || number != floor(number) || number < 1 ||
      number > most) {
    return placido_reader_refuse(reader, err,
                                 "%s: \"%.40s\": a whole number from 1 to %d is expected", name,
                                 value, most);
  }
  *count = (int)number;
  return PLACIDO_OK;
}

/* "41,46 D @ 177°": a number, and behind '@' another; NaN where there is none. */
static void read_power(double *power_D, double *axis_deg, char *value) {
  char *at = strchr(value, '@');
  double number;
  value[strspn(value, "0123456789,.")] = '\0';
  *power_D = placido_text_number(value, true, &number) ? number : (double)NAN;
  if (at) {
    at = placido_text_trim(at + 1);
    at[strspn(at, "0123456789,.")] = '\0';
    *axis_deg = placido_text_number(at, true, &number) ? number : (double)NAN;
  }
}

static void read_millimetres(double *target, char *value) {
  double number, ignored;
  read_power(&number, &ignored, value); /* "8,09 D" is a radius in mm in spite of the D */
  *target = number;
}

static void read_maker(placido_elevation_maker *maker, char *line) {
  static const char *const names[2] = {"K1", "K2"};
  char *value;
  for (int i = 0; i < 2; i++) {
    if (strncmp(line, names[i], 2) == 0 && (value = value_of(line, names[i]))) {
      read_power(&maker->k_D[i], &maker->axis_deg[i], value);
      return;
    }
  }
  if ((value = value_of(line, "Diametro Corneale"))) {
    read_millimetres(&maker->corneal_diameter_mm, value);
  } else if ((value = value_of(line, "Diametro Pupillare Medio"))) {
    read_millimetres(&maker->pupil_diameter_mm, value);
  } else if ((value = value_of(line, "Potere Pupillare Medio"))) {
    read_millimetres(&maker->pupil_radius_mm, value);
  } else if ((value = value_of(line, "Occhio"))) {
    snprintf(maker->eye_flag, sizeof maker->eye_flag, "%.15s", value);
  }
}

/* Reads up to the first line that is a number; gives it back in *first. */
static int read_header(placido_elevation *e, placido_reader *reader, char **first,
                       placido_error *err) {
  char *line, *value;
  double number;
  int status = PLACIDO_OK;
  *first = NULL;
  while (!status && (line = placido_reader_next(reader))) {
    if (placido_text_number(line, true, &number)) {
      *first = line;
      break;
    }
    if (reader->line > HEADER_LINES) {
      return placido_reader_refuse(reader, err, "no number within the first %d lines of what looks "
                                  "like a CSO export", HEADER_LINES);
    }
    if ((value = value_of(line, rings_mark))) {
      status = read_count(&e->ring_count, reader, value, "number of rings", RINGS_MAX, err);
    } else if ((value = value_of(line, meridians_mark))) {
      status = read_count(&e->meridian_count, reader, value, "number of semi-meridians",
                          MERIDIANS_MAX, err);
    } else if ((value = value_of(line, "Dato misurato")) && strncmp(value, "Elev", 4) != 0) {
      status = placido_reader_refuse(
          reader, err, "the data are \"%.40s\", elevations (\"Elevazioni\") are expected", value);
    } else {
      read_maker(&e->maker, line);
    }
  }
  if (!status && (e->ring_count == 0 || e->meridian_count == 0)) {
    status = placido_reader_refuse(reader, err, "the header names no number of %s (\"%s : N\")",
                                  e->ring_count == 0 ? "rings" : "semi-meridians",
                                  e->ring_count == 0 ? rings_mark : meridians_mark);
  }
  return status;
}

/* Both blocks into `values`, the line of each into `places`. */
static int read_numbers(double *values, int *places, size_t count, placido_reader *reader,
                        char *first, placido_error *err) {
  size_t got = 0;
  for (char *line = first; line; line = placido_reader_next(reader)) {
    if (line[0] == '\0') {
      continue;
    }
    if (got == count) {
      return placido_reader_refuse(
          reader, err, "\"%.40s\" is one number too many: %zu are expected", line, count);
    }
    if (!placido_text_number(line, true, &values[got])) {
      return placido_reader_refuse(reader, err, "\"%.40s\" is no number (mm, with a decimal comma)",
                                  line);
    }
    places[got++] = reader->line;
  }
  if (got < count) {
    return placido_reader_refuse(reader, err, "the file ends after %zu of %zu numbers", got, count);
  }
  return PLACIDO_OK;
}

static bool is_missing(double value) {
  return value == missing_marks[0] || value == missing_marks[1];
}

/* Places the points and keeps those that have a height. */
static int take_points(placido_elevation *e, const double *values, const int *places,
                       placido_reader *reader, placido_error *err) {
  size_t count = (size_t)e->ring_count * (size_t)e->meridian_count, room = 0;
  int status = PLACIDO_OK;
  for (size_t i = 0; i < count && !status; i++) {
    double radius = values[i], height = values[count + i];
    double angle = 2 * PI * (double)(i % (size_t)e->meridian_count) / e->meridian_count;
    e->ring_x_mm[i] = e->ring_y_mm[i] = NAN;
    if (is_missing(radius)) {
      e->missing++;
      continue;
    }
    if (!(radius > 0 && radius <= RADIUS_MAX_MM)) {
      reader->line = places[i];
      return placido_reader_refuse(reader, err, "a radius of %g mm: more than 0, at most %g, or -1 "
                                  "where missing is expected", radius, RADIUS_MAX_MM);
    }
    e->ring_x_mm[i] = radius * cos(angle);
    e->ring_y_mm[i] = radius * sin(angle);
    if (height == missing_marks[1]) {
      e->missing++;
      continue;
    }
    const placido_height point = {e->ring_x_mm[i], e->ring_y_mm[i], height};
    status = placido_elevation_add(e, &room, point, places[count + i], err);
  }
  return status;
}

int placido_cso_read(placido_elevation *elevation, placido_reader *reader, placido_error *err) {
  char *first;
  elevation->kind = "cso";
  int status = read_header(elevation, reader, &first, err);
  if (status) {
    return status;
  }
  size_t count = (size_t)elevation->ring_count * (size_t)elevation->meridian_count;
  double *values = placido_memory_new(2 * count, sizeof *values, err);
  int *places = placido_memory_new(2 * count, sizeof *places, err);
  elevation->ring_x_mm = placido_memory_new(count, sizeof *elevation->ring_x_mm, err);
  elevation->ring_y_mm = placido_memory_new(count, sizeof *elevation->ring_y_mm, err);
  if (!values || !places || !elevation->ring_x_mm || !elevation->ring_y_mm) {
    status = PLACIDO_MEMORY;
  }
  if (!status) {
    status = read_numbers(values, places, 2 * count, reader, first, err);
  }
  if (!status) {
    status = take_points(elevation, values, places, reader, err);
  }
  placido_memory_free(values);
  placido_memory_free(places);
  return status;
}
