/* maps.csv: a line per grid point within the surface's radius, numbers that read back bit for bit.
 */
#include "base/file.h"
#include "base/memory.h"

#include <placido/map.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define NUMBER_BYTES 26 /* a sign, 17 digits, point, exponent, zero byte */
#define EDGE_MM 1e-12   /* as for the surface */

static void print_header(FILE *stream) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  fputs("x_mm,y_mm,valid,z_mm", stream);
  for (size_t i = 0; i < count; i++) {
    fprintf(stream, ",%s", kinds[i].column);
  }
  fputs(",sigma_z_um,sigma_axial_D\n", stream);
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

static void print_point(FILE *stream, const placido_maps *maps, size_t index) {
  size_t count;
  placido_map_kinds(&count);
  fputs(maps->valid[index] ? ",1" : ",0", stream);
  print_cell(stream, maps->z_mm, index);
  for (size_t i = 0; i < count; i++) {
    print_cell(stream, maps->values[i], index);
  }
  print_cell(stream, maps->sigma_z_um, index);
  print_cell(stream, maps->sigma_axial_D, index);
  fputc('\n', stream);
}

static void print_points(FILE *stream, const placido_maps *maps, char (*positions)[NUMBER_BYTES]) {
  for (int j = 0; j < maps->size; j++) {
    for (int i = 0; i < maps->size; i++) {
      double x = placido_maps_position(maps, i), y = placido_maps_position(maps, j);
      if (hypot(x, y) <= maps->radius_mm + EDGE_MM) {
        fprintf(stream, "%s,%s", positions[i], positions[j]);
        print_point(stream, maps, (size_t)j * (size_t)maps->size + (size_t)i);
      }
    }
  }
}

int placido_maps_save(const placido_maps *maps, const char *path, placido_error *err) {
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
    print_header(file.stream);
    print_points(file.stream, maps, positions);
    status = placido_file_commit(&file, err);
  }
  placido_memory_free(positions);
  return status;
}
