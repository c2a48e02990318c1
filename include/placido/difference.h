/* Two measurements of one eye, or of a person's two eyes: the second one moved onto the first, and
 * what then is left between them, with its error bars. */
#ifndef PLACIDO_DIFFERENCE_H
#define PLACIDO_DIFFERENCE_H

#include <placido/map.h>

/* Whose error bars a difference needs. */
enum placido_difference_kind {
  PLACIDO_DIFFERENCE_ELEVATION,  /* z, micrometres */
  PLACIDO_DIFFERENCE_AXIAL,      /* dioptres, each cornea's about its own vertex */
  PLACIDO_DIFFERENCE_TANGENTIAL, /* likewise */
  PLACIDO_DIFFERENCES
};

/* A measured cornea as an exam's directory holds it: surface.json, and on the grid of maps.csv the
 * error bars of z, axial_vertex and tangential_vertex. */
typedef struct placido_measured {
  placido_surface *surface;
  bool mirrored; /* x counts the other way: a left eye looked at as a right one */
  double step_mm;
  int half, size;                      /* of the grid, as in placido_maps */
  double *sigmas[PLACIDO_DIFFERENCES]; /* size * size; NaN where they are not known */
} placido_measured;

/* Reads an exam's directory. Without maps_sigma.csv, or with its cells empty, error bars are NaN,
 * and a note says so. Refuses files of another format or with broken rows, naming file, line and
 * column. Free with placido_measured_free. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT,
 * PLACIDO_MEMORY. */
int placido_measured_load(placido_measured *measured, const char *directory, placido_notes *notes,
                          placido_error *err);
void placido_measured_free(placido_measured *measured);

/* How the second cornea was moved onto the first: turned about the origin by the rotation vector
 * (tilt x, tilt y, torsion), counted from +x to +y, then shifted. */
enum placido_motion_term {
  PLACIDO_SHIFT_X, /* mm */
  PLACIDO_SHIFT_Y,
  PLACIDO_PISTON, /* mm, along z */
  PLACIDO_TILT_X, /* radians, about the x axis */
  PLACIDO_TILT_Y,
  PLACIDO_TORSION, /* about the z axis: cyclotorsion */
  PLACIDO_MOTION_TERMS
};

typedef struct placido_alignment {
  bool aligned; /* false: not asked for, all terms are 0 */
  double terms[PLACIDO_MOTION_TERMS];
  double sigmas[PLACIDO_MOTION_TERMS];
  double covariance[PLACIDO_MOTION_TERMS][PLACIDO_MOTION_TERMS];
  size_t points; /* that took part */
  int steps;
  double rms_before_um, rms_um; /* of the heights' difference, the mean taken off before */
  double chi_square;            /* reduced: of the heights' difference over its sigma */
} placido_alignment;

/* Least squares of the difference in height over the part that both data support, weighted by both
 * error bars (and 0.02 micrometres, the spline's own, so that no place is an anchor). What the
 * shapes leave open (a sphere turned about its centre is the same sphere) is held by what eyes do
 * between two looks at one target: shifts of 0.5 mm, tilts of 3 degrees and torsion of 5, one sigma
 * each. Sigmas count what the error bars of neighbours share over 0.5 mm once, and grow with the
 * root of the reduced chi-square where that exceeds 1. Returns PLACIDO_OK, PLACIDO_QUALITY (fewer
 * than 500 common points, no convergence). */
int placido_align(placido_alignment *alignment, const placido_measured *first,
                  const placido_measured *second, placido_error *err);

/* The second less the first, on the first's grid. */
typedef struct placido_difference {
  double step_mm, radius_mm;
  int half, size;
  double vertices_mm[2][2]; /* x, y of both, that curvatures are about; the axis where there is
                               none */
  unsigned char *valid;     /* size * size; 1 where data of both support a value */
  double *values[PLACIDO_DIFFERENCES], *sigmas[PLACIDO_DIFFERENCES]; /* NaN where not known */
} placido_difference;

/* The error bars are those of both corneas and of the alignment. Works on rows in parallel; the
 * result does not depend on the number of threads. Free with placido_difference_free. Returns
 * PLACIDO_OK, PLACIDO_QUALITY (no common point), PLACIDO_MEMORY. */
int placido_difference_new(placido_difference *difference, const placido_measured *first,
                           const placido_measured *second, const placido_alignment *alignment,
                           placido_error *err);
void placido_difference_free(placido_difference *difference);

/* Writes difference.csv (docs/formats.md) by way of a temporary name. */
int placido_difference_save(const placido_difference *difference, const char *path,
                            placido_error *err);

/* Area-weighted figures of one kind between two diameters (ISO 19980, annex C: every point of a
 * square grid stands for the same area). */
typedef struct placido_difference_zone {
  double from_mm, to_mm;
  size_t points;
  double mean, deviation, largest; /* standard deviation about the mean; largest magnitude */
  double significant;              /* share of points where it exceeds twice its sigma; NaN: not
                                      known */
} placido_difference_zone;

placido_difference_zone placido_difference_zone_find(const placido_difference *difference,
                                                     enum placido_difference_kind kind,
                                                     double from_mm, double to_mm);

/* The zones that comparisons tell of: ISO 19980's central, middle and outer one up to 8 mm, and the
 * central 8 mm as a whole. Diameters. */
#define PLACIDO_DIFFERENCE_ZONES 4
const double *placido_difference_zone_mm(int zone);

/* Name of a kind as in column and file names, its title and its unit. */
const char *placido_difference_name(enum placido_difference_kind kind);
const char *placido_difference_title(enum placido_difference_kind kind);
const char *placido_difference_unit(enum placido_difference_kind kind);

#endif
