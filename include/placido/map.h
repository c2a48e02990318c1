/* A quantity of the cornea on a square grid: the rows of maps/table.c evaluated everywhere. */
#ifndef PLACIDO_MAP_H
#define PLACIDO_MAP_H

#include <placido/reconstruct.h>
#include <placido/surface.h>

/* Sphere fitted to a zone of the surface, least squares over radius and centre ("float"). NaN where
 * the supported part of the zone determines none. */
typedef struct placido_sphere {
  double radius_mm, x_mm, y_mm, z_mm; /* centre; z towards the camera */
  double zone_mm;                     /* diameter of the zone it was fitted to */
} placido_sphere;

/* What a map is computed from at one point of the surface. */
typedef struct placido_map_point {
  double x_mm, y_mm, z_mm;
  placido_jet jet;
  double axis_z_mm;      /* z of the surface at x = y = 0; NaN where it is not defined there */
  placido_sphere sphere; /* the elevation map's reference */
} placido_map_point;

/* One kind of map. */
typedef struct placido_map_kind {
  const char *name;   /* lower case, as in the file maps/NAME.png */
  const char *column; /* its column in maps.csv */
  const char *unit;
  const char *help;   /* one sentence with the formula's source */
  double step;        /* ISO 19980 colour step in the map's unit */
  double (*at)(const placido_map_point *point); /* its value; NaN where it is not defined */
} placido_map_kind;

/* The kinds that this build knows, `*count` rows. */
const placido_map_kind *placido_map_kinds(size_t *count);

/* All maps on one grid: point (i, j) at ((i - half) step, (j - half) step), j counted upwards. */
typedef struct placido_maps {
  double step_mm;
  double radius_mm;       /* of the surface: points beyond it are no part of the maps */
  int half, size;         /* size = 2 half + 1 points a side */
  placido_sphere sphere;  /* the elevation map's reference */
  unsigned char *valid;   /* size * size; 1 where the surface is defined and data support it */
  double *z_mm;           /* the surface; NaN where invalid */
  double **values; /* one array a kind, as placido_map_kinds orders them; NaN where invalid */
  double *sigma_z_um, *sigma_axial_D; /* NULL where the surface has no fit */
} placido_maps;

/* Evaluates every map on a grid of step_mm within the surface's radius. `fit` gives the error
 * bars and may be NULL. Works on rows in parallel; the result does not depend on the number of
 * threads. Free with placido_maps_free. Returns PLACIDO_OK, PLACIDO_INPUT (step not
 * within 0.01..1 mm), PLACIDO_QUALITY (no valid point), PLACIDO_MEMORY. */
int placido_maps_new(placido_maps *maps, const placido_surface *surface, const placido_fit *fit,
                     double step_mm, placido_error *err);
void placido_maps_free(placido_maps *maps);

/* Index of the map called `name`, -1 where there is none. */
int placido_maps_find(const char *name);

/* Coordinate of the grid's column (or row) `index`, mm. */
double placido_maps_position(const placido_maps *maps, int index);

/* Writes maps.csv (docs/formats.md) by way of a temporary name: a row per grid point within the
 * surface's radius, y outer and upwards. */
int placido_maps_save(const placido_maps *maps, const char *path, placido_error *err);

/* A figure of the whole cornea. */
typedef struct placido_index_value {
  const char *name, *unit, *help;
  double value, sigma; /* NaN where it cannot be given; sigma is 1 standard deviation */
} placido_index_value;

#define PLACIDO_INDICES_MAX 64

/* Evaluates the indices of indices/table.c (SimK, asphericity ...) of a surface. What the supported
 * part of the surface does not give is NaN. `fit` gives the error bars and may be NULL. Fills at
 * most PLACIDO_INDICES_MAX values, whose strings are constants, and sets *count. Returns PLACIDO_OK
 * or PLACIDO_MEMORY. */
int placido_indices_find(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                         const placido_surface *surface, const placido_fit *fit,
                         placido_error *err);

/* Writes indices.json (`placido-indices/1`, docs/formats.md) by way of a temporary name. */
int placido_indices_save(const placido_index_value *values, size_t count, const char *path,
                         placido_error *err);

#endif
