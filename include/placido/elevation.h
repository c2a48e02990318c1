/* Heights that another program measured, read from its file. */
#ifndef PLACIDO_ELEVATION_H
#define PLACIDO_ELEVATION_H

#include <placido/heights.h>
#include <placido/index.h>
#include <placido/notes.h>

/* Which way heights grow in a file that does not say so. */
enum placido_height_sign {
  PLACIDO_HEIGHT_GUESS, /* whichever makes the points bulge towards the camera */
  PLACIDO_HEIGHT_UP,    /* towards the camera */
  PLACIDO_HEIGHT_DOWN   /* into the eye: a sag */
};

/* What a file may leave open. Zero means the default in brackets. */
typedef struct placido_elevation_options {
  double xy_mm; /* millimetres of its unit across, where it names none [1] */
  double z_mm;  /* and of heights [1] */
  enum placido_height_sign sign;
} placido_elevation_options;

/* Simulated keratometry as the maker of the file computed it; NaN where it does not say. */
typedef struct placido_elevation_maker {
  double k_D[2], axis_deg[2];    /* in the file's order */
  double corneal_diameter_mm, pupil_diameter_mm, pupil_radius_mm; /* the last of curvature */
  char eye_flag[16]; /* as in the file: what it says of the side, if anything */
} placido_elevation_maker;

typedef struct placido_elevation {
  const char *kind;        /* "cso" or "points"; a constant */
  size_t count;            /* points with a height */
  size_t missing;          /* points without */
  placido_height *heights; /* `count` of them, in the order of the file */
  int *lines;              /* where each height stands in the file */
  int ring_count, meridian_count; /* of a file of rings; 0 else */
  double *ring_x_mm, *ring_y_mm;  /* ring_count * meridian_count, innermost ring first; NaN where
                                     missing */
  placido_elevation_maker maker;
} placido_elevation;

/* Reads a CSO topographer's export (Italian header, number of rings and semi-meridians, radii and
 * then heights of all rings, a decimal comma, -1 or -1000 where missing), or points: a CSV of x, y
 * and z with commas, semicolons, tabs or blanks between, with or without a header that names the
 * columns (x_mm, "z (um)", sag_mm ...; others are passed over, so that maps.csv is taken, too) and
 * with empty or NaN heights where missing. A point that stands twice with one height counts once,
 * with a note; with two heights it is refused.
 * Free with placido_elevation_free. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT (file, line
 * and what was expected are named), PLACIDO_MEMORY. */
int placido_elevation_load(placido_elevation *elevation, const char *path,
                           const placido_elevation_options *options, placido_notes *notes,
                           placido_error *err);
void placido_elevation_free(placido_elevation *elevation);

/* What the rings of a file give beside its heights, none where it has no rings: appends the Placido
 * indices to values[*count...], and puts simulated keratometry by the maker's rule (CSO: mean axial
 * radius on the rings 6 to 10) in place of ours, with the error bars of `fit`, that of the file's
 * heights. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_elevation_indices(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                              const placido_elevation *elevation, const placido_fit *fit,
                              placido_error *err);

#endif
