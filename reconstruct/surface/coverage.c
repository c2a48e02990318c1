/* Coverage: which cells of a grid are supported by data, asked for, read and written. */
#include "reconstruct/surface/coverage.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SIDE_MAX 4096        /* cells along one axis */
#define POINTS_MAX 10000     /* of a polygon */
#define POLYGON_STEP_MM 0.05 /* half a point of maps.csv */

static const char *const grid_keys[] = {"kind", "x0_mm", "y0_mm", "step_mm", "mask", NULL};
static const char *const polygon_keys[] = {"kind", "points_mm", NULL};

int placido_coverage_copy(placido_coverage *copy, unsigned char **mask,
                          const placido_coverage *source, placido_error *err) {
  *copy = (placido_coverage){0};
  *mask = NULL;
  if (!isfinite(source->x0_mm) || !isfinite(source->y0_mm) || !isfinite(source->step_mm) ||
      source->step_mm <= 0 || source->columns < 1 || source->columns > SIDE_MAX ||
      source->rows < 1 || source->rows > SIDE_MAX) {
    return placido_error_set(
        err, PLACIDO_INPUT, "coverage: %d x %d cells of %g mm from (%g, %g) mm make no grid",
        source->columns, source->rows, source->step_mm, source->x0_mm, source->y0_mm);
  }
  size_t cells = (size_t)source->columns * (size_t)source->rows;
  *mask = placido_memory_new(cells, 1, err);
  if (!*mask) {
    return PLACIDO_MEMORY;
  }
  memcpy(*mask, source->mask, cells);
  *copy = *source;
  copy->mask = *mask;
  return PLACIDO_OK;
}

bool placido_coverage_at(const placido_coverage *coverage, double x_mm, double y_mm) {
  double column = floor((x_mm - coverage->x0_mm) / coverage->step_mm + 0.5);
  double row = floor((y_mm - coverage->y0_mm) / coverage->step_mm + 0.5);
  if (!(column >= 0 && column < coverage->columns && row >= 0 && row < coverage->rows)) {
    return false;
  }
  return coverage->mask[(size_t)row * (size_t)coverage->columns + (size_t)column] != 0;
}

/* The strings of the mask: as many characters in each, '0' or '1'. */
static int check_mask(size_t *columns, size_t *rows, const placido_json *json, placido_error *err) {
  *columns = *rows = 0;
  const char *path = "coverage.mask";
  const json_t *list = placido_json_find(json, path);
  if (!json_is_array(list) || json_array_size(list) < 1 || json_array_size(list) > SIDE_MAX) {
    return placido_json_refuse(json, path, err, "an array of 1 to %d strings is expected",
                               SIDE_MAX);
  }
  *rows = json_array_size(list);
  *columns = json_string_length(json_array_get(list, 0));
  for (size_t i = 0; i < *rows; i++) {
    const char *text = json_string_value(json_array_get(list, i));
    size_t length = text ? strspn(text, "01") : 0;
    if (length < 1 || length > SIDE_MAX || text[length] || length != *columns) {
      char place[64];
      snprintf(place, sizeof place, "%s[%zu]", path, i);
      return placido_json_refuse(
          json, place, err,
          "a string of zeros and ones is expected, all of one length from 1 to %d", SIDE_MAX);
    }
  }
  return PLACIDO_OK;
}

static int read_grid(placido_coverage *coverage, unsigned char **mask, const placido_json *json,
                     placido_error *err) {
  size_t columns, rows;
  int status = placido_json_number(json, "coverage.x0_mm", &coverage->x0_mm, err);
  if (status || (status = placido_json_number(json, "coverage.y0_mm", &coverage->y0_mm, err)) ||
      (status = placido_json_number(json, "coverage.step_mm", &coverage->step_mm, err)) ||
      (status = check_mask(&columns, &rows, json, err))) {
    return status;
  }
  if (coverage->step_mm <= 0) {
    return placido_json_refuse(json, "coverage.step_mm", err, "is not greater than 0");
  }
  *mask = placido_memory_new(columns * rows, 1, err);
  if (!*mask) {
    return PLACIDO_MEMORY;
  }
  const json_t *list = placido_json_find(json, "coverage.mask");
  for (size_t i = 0; i < rows; i++) {
    const char *text = json_string_value(json_array_get(list, i));
    for (size_t k = 0; k < columns; k++) {
      (*mask)[i * columns + k] = text[k] == '1';
    }
  }
  coverage->columns = (int)columns;
  coverage->rows = (int)rows;
  coverage->mask = *mask;
  return PLACIDO_OK;
}

/* Toggles the cells of every row to the right of where the polygon's side from a to b crosses it;
 * after all sides, a cell is set where it lies inside. */
static void draw_side(const placido_coverage *grid, unsigned char *mask, const double a[2],
                      const double b[2]) {
  for (int row = 0; row < grid->rows; row++) {
    double y = grid->y0_mm + row * grid->step_mm;
    if ((a[1] <= y) == (b[1] <= y)) {
      continue;
    }
    double x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    for (int column = 0; column < grid->columns; column++) {
      mask[(size_t)row * (size_t)grid->columns + (size_t)column] ^=
          grid->x0_mm + column * grid->step_mm > x;
    }
  }
}

static int read_points(double **points, size_t *count, const placido_json *json,
                       placido_error *err) {
  const char *path = "coverage.points_mm";
  *points = NULL;
  int status = placido_json_count(json, path, count, err);
  if (status) {
    return status;
  }
  if (*count < 3 || *count > POINTS_MAX) {
    return placido_json_refuse(json, path, err, "has %zu points, 3 to %d are expected", *count,
                               POINTS_MAX);
  }
  *points = placido_memory_new(*count, 2 * sizeof **points, err);
  if (!*points) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < *count && !status; i++) {
    char place[64];
    snprintf(place, sizeof place, "%s[%zu]", path, i);
    status = placido_json_numbers(json, place, *points + 2 * i, 2, err);
  }
  return status;
}

static int read_polygon(placido_coverage *coverage, unsigned char **mask, double radius_mm,
                        const placido_json *json, placido_error *err) {
  double *points;
  size_t count;
  int status = read_points(&points, &count, json, err);
  int half = (int)ceil(radius_mm / POLYGON_STEP_MM), side = 2 * half + 1;
  if (!status) {
    *mask = placido_memory_new((size_t)side * (size_t)side, 1, err);
    status = *mask ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (!status) {
    coverage->x0_mm = coverage->y0_mm = -half * POLYGON_STEP_MM;
    coverage->step_mm = POLYGON_STEP_MM;
    coverage->columns = coverage->rows = side;
    coverage->mask = *mask;
    for (size_t i = 0; i < count; i++) {
      draw_side(coverage, *mask, points + 2 * i, points + 2 * ((i + 1) % count));
    }
  }
  placido_memory_free(points);
  return status;
}

int placido_coverage_read(placido_coverage *coverage, unsigned char **mask, double radius_mm,
                          const placido_json *json, placido_notes *notes, placido_error *err) {
  *coverage = (placido_coverage){0};
  *mask = NULL;
  char kind[16];
  int status = placido_json_string(json, "coverage.kind", kind, sizeof kind, err);
  if (status) {
    return status;
  }
  bool grid = strcmp(kind, "grid") == 0;
  if (!grid && strcmp(kind, "polygon") != 0) {
    return placido_json_refuse(json, "coverage.kind", err,
                               "unknown kind \"%s\" (known: grid, polygon)", kind);
  }
  status = grid ? read_grid(coverage, mask, json, err)
                : read_polygon(coverage, mask, radius_mm, json, err);
  if (!status) {
    placido_json_warn_unknown(json, "coverage", grid ? grid_keys : polygon_keys, notes);
  }
  return status;
}

static json_t *write_mask(const placido_coverage *coverage, placido_error *err) {
  json_t *list = json_array();
  size_t columns = (size_t)coverage->columns;
  char *text = placido_memory_new(columns, 1, err);
  int failed = !text;
  for (int row = 0; row < coverage->rows && !failed; row++) {
    for (size_t k = 0; k < columns; k++) {
      text[k] = coverage->mask[(size_t)row * columns + k] ? '1' : '0';
    }
    failed = json_array_append_new(list, json_stringn(text, columns));
  }
  placido_memory_free(text);
  if (failed) {
    json_decref(list);
    return NULL;
  }
  return list;
}

json_t *placido_coverage_write(const placido_coverage *coverage, placido_error *err) {
  json_t *object = json_object();
  if (json_object_set_new(object, "kind", json_string("grid")) ||
      json_object_set_new(object, "x0_mm", placido_json_real(coverage->x0_mm)) ||
      json_object_set_new(object, "y0_mm", placido_json_real(coverage->y0_mm)) ||
      json_object_set_new(object, "step_mm", placido_json_real(coverage->step_mm)) ||
      json_object_set_new(object, "mask", write_mask(coverage, err))) {
    json_decref(object);
    return NULL;
  }
  return object;
}
