/* maps.csv and its companions: a line per grid point within the surface's radius, numbers that read
 * back bit for bit. */
#include "reconstruct/maps/csv.h"

#include "base/file.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define NUMBER_BYTES 26 /* a sign, 17 digits, point, exponent, zero byte */
#define EDGE_MM 1e-12   /* as for the surface */

void placido_map_table_add(placido_map_table *table, const char *prefix, const char *name,
                           const double *values) {
  table->prefixes[table->count] = prefix;
  table->names[table->count] = name;
  table->values[table->count++] = values;
}

static void print_header(FILE *stream, const placido_map_table *t) {
  fputs("x_mm,y_mm,valid", stream);
  for (int i = 0; i < t->count; i++) {
    fprintf(stream, ",%s%s", t->prefixes[i], t->names[i]);
  }
  fputc('\n', stream);
}

/* The shortest of 15 to 17 digits that reads back as the same number: 0.3, not 0.29999999999999999.
 */
static void print_position(char *text, double value) {
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(text, NUMBER_BYTES, "%.*g", digits, value);
    if (strtod(text, NULL) == value) {
      return;
    }
  }
}

static void print_cell(FILE *stream, const double *values, size_t index) {
  if (values && isfinite(values[index])) {
    fprintf(stream, ",%.17g", values[index]);
  } else {
    fputc(',', stream);
  }
}

static void print_points(FILE *stream, const placido_maps *maps, const placido_map_table *t,
                         char (*positions)[NUMBER_BYTES]) {
  for (int j = 0; j < maps->size; j++) {
    for (int i = 0; i < maps->size; i++) {
      double x = placido_maps_position(maps, i), y = placido_maps_position(maps, j);
      if (hypot(x, y) > maps->radius_mm + EDGE_MM) {
        continue;
      }
      size_t index = (size_t)j * (size_t)maps->size + (size_t)i;
      fprintf(stream, "%s,%s,%d", positions[i], positions[j], (int)maps->valid[index]);
      for (int k = 0; k < t->count; k++) {
        print_cell(stream, t->values[k], index);
      }
      fputc('\n', stream);
    }
  }
}

int placido_map_table_save(const placido_map_table *table, const placido_maps *maps,
                           const char *path, placido_error *err) {
  char(*positions)[NUMBER_BYTES] = placido_memory_new((size_t)maps->size, sizeof *positions, err);
  if (!positions) {
    return PLACIDO_MEMORY;
  }
  for (int i = 0; i < maps->size; i++) {
    print_position(positions[i], placido_maps_position(maps, i));
  }
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (!status) {
    print_header(file.stream, table);
    print_points(file.stream, maps, table, positions);
    status = placido_file_commit(&file, err);
  }
  placido_memory_free(positions);
  return status;
}

/* The kinds of one of the two files. */
static void add_kinds(placido_map_table *t, const placido_maps *maps, bool more) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  for (size_t i = 0; i < count; i++) {
    if (kinds[i].more == more) {
      placido_map_table_add(t, "", kinds[i].column, maps->values[i]);
    }
  }
}

int placido_maps_save(const placido_maps *maps, const char *path, placido_error *err) {
  placido_map_table t = {.count = 0};
  placido_map_table_add(&t, "", "z_mm", maps->z_mm);
  add_kinds(&t, maps, false);
  placido_map_table_add(&t, "", "sigma_z_um", maps->sigma_z_um);
  placido_map_table_add(&t, "", "sigma_axial_D", maps->sigma_axial_D);
  return placido_map_table_save(&t, maps, path, err);
}

int placido_maps_save_more(const placido_maps *maps, const char *path, placido_error *err) {
  placido_map_table t = {.count = 0};
  add_kinds(&t, maps, true);
  return placido_map_table_save(&t, maps, path, err);
}

int placido_maps_save_sigma(const placido_maps *maps, const char *path, placido_error *err) {
  placido_map_table t = {.count = 0};
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  for (size_t i = 0; i < count; i++) {
    if ((int)i != placido_maps_find("axial")) {
      placido_map_table_add(&t, "sigma_", kinds[i].column, maps->sigmas ? maps->sigmas[i] : NULL);
    }
  }
  return placido_map_table_save(&t, maps, path, err);
}
