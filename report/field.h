/* A map's grid, interpolated to the fine lattice that a picture is coloured from. */
#ifndef PLACIDO_REPORT_FIELD_H
#define PLACIDO_REPORT_FIELD_H

#include <placido/map.h>

/* A square of size * size samples over the grid's whole square, rows from the top (largest y)
 * down; NaN where data do not support a value and outside the circle within the square. */
typedef struct placido_map_field {
  int size;
  float *values;
} placido_map_field;

/* Interpolates `values`, one of the arrays of `maps`: bicubically (Catmull and Rom 1974) inside,
 * from the supported corners alone at the rim. Free with placido_map_field_free. PLACIDO_OK,
 * PLACIDO_MEMORY. */
int placido_map_field_new(placido_map_field *field, const placido_maps *maps, const double *values,
                      int size, placido_error *err);
void placido_map_field_free(placido_map_field *field);

#endif
