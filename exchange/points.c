/* Points as a table: x, y and z in columns that a header names, or that are the only three. */
#include "exchange/elevation.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#define COLUMNS_MAX 64
#define MICROMETRE_MM 1e-3
#define PLACE_MAX_MM 1000.0 /* what no unit can mean */

enum column { COLUMN_X, COLUMN_Y, COLUMN_Z, COLUMNS };
static const char column_names[] = "xyz";

/* Names that a column of heights may have, the best first, and what they say of the sign. */
static const struct {
  const char *name;
  enum placido_height_sign sign;
} height_names[] = {{"z", PLACIDO_HEIGHT_GUESS},
                    {"sag", PLACIDO_HEIGHT_DOWN},
                    {"height", PLACIDO_HEIGHT_UP},
                    {"elevation", PLACIDO_HEIGHT_UP}};

/* How the table is laid out. */
struct table {
  char separator; /* ' ': blanks */
  int at[COLUMNS];
  double unit_mm[COLUMNS];
};

static char find_separator(const char *line) {
  static const char candidates[] = ";\t,";
  for (const char *c = candidates; *c; c++) {
    if (strchr(line, *c)) {
      return *c;
    }
  }
  return ' ';
}

/* Cuts a line into cells in place; returns their number, COLUMNS_MAX + 1 where there are more. */
static int split(char *line, char separator, char *cells[COLUMNS_MAX]) {
  const char stop[2] = {separator, '\0'};
  for (int count = 0; count < COLUMNS_MAX; count++) {
    if (separator == ' ') {
      line += strspn(line, " \t");
    }
    size_t length = strcspn(line, separator == ' ' ? " \t" : stop);
    bool last = line[length] == '\0';
    line[length] = '\0';
    cells[count] = placido_text_trim(line);
    if (last) {
      return count + 1;
    }
    line += length + 1;
  }
  return COLUMNS_MAX + 1;
}

/* Whether a header's cell is `name`, alone or with a unit behind: "z_um", "z (um)", "Z [mm]". */
static bool is_column(const char *cell, const char *name, double *unit_mm) {
  static const struct {
    const char *name;
    double mm;
  } units[] = {{"mm", 1.0}, {"um", MICROMETRE_MM}, {"\xC2\xB5m", MICROMETRE_MM},
               {"\xCE\xBCm", MICROMETRE_MM}};
  size_t length = strlen(name);
  cell += cell[0] == '"';
  if (strncasecmp(cell, name, length) != 0 || isalnum((unsigned char)cell[length])) {
    return false;
  }
  const char *unit = cell + length + strspn(cell + length, " _([/");
  const char *rest = unit;
  for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
    if (strncasecmp(unit, units[i].name, strlen(units[i].name)) == 0) {
      *unit_mm = units[i].mm;
      rest = unit + strlen(units[i].name);
    }
  }
  return rest[strspn(rest, " )]\"")] == '\0';
}

static int find_column(const char *name, char *const *cells, int count, double *unit_mm) {
  for (int i = 0; i < count; i++) {
    if (is_column(cells[i], name, unit_mm)) {
      return i;
    }
  }
  return -1;
}

static int read_header(struct table *table, placido_elevation_options *options, char *const *cells,
                       int count, const placido_reader *reader, placido_error *err) {
  for (int k = COLUMN_X; k <= COLUMN_Y; k++) {
    const char name[2] = {column_names[k], '\0'};
    table->at[k] = find_column(name, cells, count, &table->unit_mm[k]);
    if (table->at[k] < 0) {
      return placido_reader_refuse(reader, err,
                                  "no column is called %s: a header like x_mm,y_mm,z_um or "
                                  "three columns of numbers are expected",
                                  name);
    }
  }
  table->at[COLUMN_Z] = -1;
  for (size_t i = 0; i < sizeof height_names / sizeof height_names[0]; i++) {
    int at = find_column(height_names[i].name, cells, count, &table->unit_mm[COLUMN_Z]);
    if (at >= 0) {
      table->at[COLUMN_Z] = at;
      if (options->sign == PLACIDO_HEIGHT_GUESS) {
        options->sign = height_names[i].sign;
      }
      return PLACIDO_OK;
    }
  }
  return placido_reader_refuse(reader, err, "no column is called z (nor sag, height or elevation)");
}

/* Whether a cell says that there is no value. */
static bool is_missing(const char *cell) {
  return cell[0] == '\0' || strcasecmp(cell, "nan") == 0 || strcasecmp(cell, "na") == 0;
}

static int read_cell(double *value_mm, const struct table *table, enum column k,
                     char *const *cells, int count, const placido_reader *reader,
                     placido_error *err) {
  if (table->at[k] >= count) {
    return placido_reader_refuse(reader, err, "%d columns, %c was expected in column %d", count,
                                column_names[k], table->at[k] + 1);
  }
  const char *cell = cells[table->at[k]];
  if (k == COLUMN_Z && is_missing(cell)) {
    *value_mm = NAN;
    return PLACIDO_OK;
  }
  if (!placido_text_number(cell, table->separator != ',', value_mm)) {
    return placido_reader_refuse(reader, err, "\"%.40s\" is no number (column %d, %c)", cell,
                                table->at[k] + 1, column_names[k]);
  }
  *value_mm *= table->unit_mm[k];
  if (fabs(*value_mm) > PLACE_MAX_MM) {
    return placido_reader_refuse(reader, err, "%c is %g mm: the unit is wrong", column_names[k],
                                *value_mm);
  }
  return PLACIDO_OK;
}

static int read_row(placido_elevation *e, size_t *room, const struct table *table,
                    char *const *cells, int count, const placido_reader *reader,
                    placido_error *err) {
  double value[COLUMNS];
  int status = PLACIDO_OK;
  for (enum column k = COLUMN_X; k < COLUMNS && !status; k++) {
    status = read_cell(&value[k], table, k, cells, count, reader, err);
  }
  if (!status && isnan(value[COLUMN_Z])) {
    e->missing++;
    return PLACIDO_OK;
  }
  if (!status && e->count == PLACIDO_ELEVATION_POINTS_MAX) {
    status = placido_reader_refuse(reader, err, "more than %d points",
                                   PLACIDO_ELEVATION_POINTS_MAX);
  }
  const placido_height point = {value[COLUMN_X], value[COLUMN_Y], value[COLUMN_Z]};
  return status ? status : placido_elevation_add(e, room, point, reader->line, err);
}

/* The first row: a header, or numbers of which there must be three. */
static int begin(struct table *table, bool *header, placido_elevation_options *options,
                 char *const *cells, int count, const placido_reader *reader, placido_error *err) {
  double number;
  *header = !placido_text_number(cells[0], table->separator != ',', &number);
  if (*header) {
    return read_header(table, options, cells, count, reader, err);
  }
  if (count != COLUMNS) {
    return placido_reader_refuse(reader, err,
                                "%d columns without a header: three (x, y, z) are expected, or a "
                                "header that names them",
                                count);
  }
  for (int k = 0; k < COLUMNS; k++) {
    table->at[k] = k;
  }
  return PLACIDO_OK;
}

int placido_points_read(placido_elevation *elevation, placido_reader *reader,
                        placido_elevation_options *options, placido_error *err) {
  struct table table = {.unit_mm = {options->xy_mm, options->xy_mm, options->z_mm}};
  char *line, *cells[COLUMNS_MAX];
  size_t room = 0;
  bool begun = false;
  elevation->kind = "points";
  int status = PLACIDO_OK;
  while (!status && (line = placido_reader_next(reader))) {
    if (line[0] == '\0' || line[0] == '#') {
      continue;
    }
    table.separator = begun ? table.separator : find_separator(line);
    int count = split(line, table.separator, cells);
    if (count > COLUMNS_MAX) {
      return placido_reader_refuse(reader, err, "more than %d columns", COLUMNS_MAX);
    }
    bool header = false;
    if (!begun) {
      status = begin(&table, &header, options, cells, count, reader, err);
      begun = true;
    }
    if (!status && !header) {
      status = read_row(elevation, &room, &table, cells, count, reader, err);
    }
  }
  if (!status && !begun) {
    status = placido_reader_refuse(reader, err,
                                   "the file is empty: a table of x, y and z is expected");
  }
  return status;
}
