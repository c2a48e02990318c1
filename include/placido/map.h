/* Quantities of the cornea on a square grid: the rows of maps/table.c evaluated everywhere, each
 * with its error bar. */
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

/* A conicoid whose axis runs along z, toric where its curvatures differ. With u the offset from its
 * apex and C = [[c + d, e], [e, c - d]] its sag is u·Cu / (1 + sqrt(1 - p |Cu|²)): the `biconic` of
 * docs/formats.md with equal asphericities, without the axis that a symmetric one does not have. */
typedef struct placido_conicoid_shape {
  double x_mm, y_mm, z_mm;       /* apex */
  double c_mm1, p, d_mm1, e_mm1; /* p = 1 + Q */
  double zone_mm;                /* diameter of the zone it was fitted to */
} placido_conicoid_shape;

/* What elevation is measured from. */
enum placido_reference {
  PLACIDO_REFERENCE_SPHERE, /* nearest along its radii */
  PLACIDO_REFERENCE_CONIC,  /* nearest along z: apex, radius and Q free */
  PLACIDO_REFERENCE_TORIC,  /* the same with two radii and an axis */
  PLACIDO_REFERENCES
};

/* What a map is computed from at one point of the surface. */
typedef struct placido_map_point {
  double x_mm, y_mm, z_mm;
  placido_jet jet;
  double axis_z_mm;      /* z of the surface at x = y = 0; NaN where it is not defined there */
  placido_sphere sphere; /* as references[PLACIDO_REFERENCE_SPHERE] */
  placido_conicoid_shape references[PLACIDO_REFERENCES]; /* of the elevation maps */
  double vertex_mm[2]; /* x, y of the corneal vertex, where the slope is 0; NaN: none */
  double index;        /* refractive index behind the cornea, for CWhatUC's maps */
  double retina_mm;    /* from the cornea's point on the axis down to the fovea, on the axis, too */
} placido_map_point;

/* What else of the whole surface a map depends on, for its error bar. */
enum placido_map_needs {
  PLACIDO_MAP_NEEDS_NOTHING,
  PLACIDO_MAP_NEEDS_SPHERE, /* a reference each, in the order of placido_reference */
  PLACIDO_MAP_NEEDS_CONIC,
  PLACIDO_MAP_NEEDS_TORIC,
  PLACIDO_MAP_NEEDS_VERTEX
};

/* One kind of map. */
typedef struct placido_map_kind {
  const char *name;   /* lower case, as in the file maps/NAME.png */
  const char *title;  /* for people */
  const char *column; /* in maps.csv or maps_more.csv; its error bar is sigma_COLUMN */
  const char *unit;
  const char *help;   /* one sentence with the formula */
  const char *source; /* of the formula */
  const char *limits; /* where it is valid, one sentence */
  double step;        /* ISO 19980 colour step in the map's unit */
  bool about_axis;    /* has no limit at the axis where the surface is tilted there */
  bool more;          /* stands in maps_more.csv rather than in maps.csv */
  enum placido_map_needs needs;
  double (*at)(const placido_map_point *point); /* its value; NaN where it is not defined */
} placido_map_kind;

/* The kinds that this build knows, `*count` rows. */
const placido_map_kind *placido_map_kinds(size_t *count);

/* Choices; zero means the default in brackets. */
typedef struct placido_maps_options {
  double zone_mm;   /* that the references of elevation are fitted to, a diameter, 1 to 20 [8] */
  double index;     /* behind the cornea, 1.01 to 2, for CWhatUC's maps [1.3375] */
  double retina_mm; /* 5 to 200 [n R / (n - 1), the paraxial focus, with n the index and R the
                       radius of the mean curvature of the central 3 mm] */
} placido_maps_options;

/* All maps on one grid: point (i, j) at ((i - half) step, (j - half) step), j counted upwards. */
typedef struct placido_maps {
  double step_mm;
  double radius_mm;      /* of the surface: points beyond it are no part of the maps */
  int half, size;        /* size = 2 half + 1 points a side */
  placido_sphere sphere; /* what elevation is measured from */
  placido_conicoid_shape references[PLACIDO_REFERENCES];
  double vertex_mm[2], index, retina_mm; /* as in placido_map_point; retina_mm as it was used */
  unsigned char *valid; /* size * size; 1 where the surface is defined and data support it */
  double *z_mm;         /* the surface; NaN where invalid */
  double **values;      /* one array a kind, as placido_map_kinds orders them; NaN where invalid */
  double **sigmas; /* their standard deviations, as `values`; NULL where the surface has no fit */
  double *sigma_z_um;    /* as placido_fit_sigma_at; NULL as above */
  double *sigma_axial_D; /* one of `sigmas` */
} placido_maps;

/* Evaluates every map on a grid of step_mm within the surface's radius. `fit` gives the error
 * bars, from all sources of placido_sigma_source, by linear propagation (the retina counts as being
 * where it is); it may be NULL, and one thread at a time may use it here. `options` may be NULL.
 * Works on rows in parallel; the result does not depend on the number of threads. Free with
 * placido_maps_free. Returns PLACIDO_OK, PLACIDO_INPUT (step not within 0.01..1 mm, an option out
 * of its range), PLACIDO_QUALITY (no valid point), PLACIDO_MEMORY. */
int placido_maps_find_all(placido_maps *maps, const placido_surface *surface,
                          const placido_fit *fit, const placido_maps_options *options,
                          double step_mm, placido_error *err);

/* The same with the default options. */
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

/* Writes maps_more.csv: the kinds that maps.csv has no column for, in the same rows. */
int placido_maps_save_more(const placido_maps *maps, const char *path, placido_error *err);

/* Writes maps_sigma.csv: the error bars of every kind but axial, which stands in maps.csv, in the
 * same rows; their cells are empty where the surface has no fit. */
int placido_maps_save_sigma(const placido_maps *maps, const char *path, placido_error *err);

#endif
