/* The files of a grid: a header, then a row per point within the radius. */
#ifndef PLACIDO_MAPS_CSV_H
#define PLACIDO_MAPS_CSV_H

#include <placido/map.h>

#define PLACIDO_MAP_COLUMNS_MAX 32

/* Columns behind x_mm, y_mm and valid. */
typedef struct placido_map_table {
  const char *prefixes[PLACIDO_MAP_COLUMNS_MAX], *names[PLACIDO_MAP_COLUMNS_MAX];
  const double *values[PLACIDO_MAP_COLUMNS_MAX]; /* on the grid; NULL: all cells are empty */
  int count;
} placido_map_table;

/* Adds the column prefix + name. */
void placido_map_table_add(placido_map_table *table, const char *prefix, const char *name,
                           const double *values);

/* Writes the table on the grid of `maps`, of which step, radius, half, size and valid count, by way
 * of a temporary name. */
int placido_map_table_save(const placido_map_table *table, const placido_maps *maps,
                           const char *path, placido_error *err);

/* Reads columns of such a file. The grid is that of the file: `*half` receives its reach in steps
 * of `step_mm`, `values` a new array for every one of `count` names, (2 half + 1)² numbers each,
 * NaN where a cell is empty or a row is missing. Free with placido_memory_free. Refuses, naming
 * file, line and column, a column that is missing, a cell that is no number, a point beside the
 * grid or further out than 20 mm. */
int placido_map_columns_load(double **values, int *half, const char *const *names, int count,
                             double step_mm, const char *path, placido_error *err);

#endif
