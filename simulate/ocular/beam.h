/* Rays in columns, led from surface to surface by Snell's law, with their optical paths. */
#ifndef PLACIDO_SIMULATE_BEAM_H
#define PLACIDO_SIMULATE_BEAM_H

#include <placido/eye.h>
#include <stddef.h>

/* Where `count` rays enter, and how far they have come. Depths grow into the eye, from the
 * surface's point on the axis; a ray that does not go on is NaN. */
typedef struct placido_beam {
  size_t count;
  double *x_mm, *y_mm, *depth_mm; /* on the cornea */
  double *sx, *sy;                /* slopes of the cornea there */
  double *px, *py, *pz;           /* where it is, mm */
  double *tx, *ty, *tz;           /* its direction, of length 1 */
  double *path_mm;                /* from the wave through the pupil's centre at depth 0 */
} placido_beam;

enum { PLACIDO_BEAM_COLUMNS = 12 };

/* Puts the columns into PLACIDO_BEAM_COLUMNS * room numbers at `block`. */
placido_beam placido_beam_of(double *block, size_t room);

/* Light in air, and the thin lens on the cornea. The light comes from the point
 * (x_mm, y_mm, 0) - (slope, 1) / nearness: a plane wave where that is 0. */
typedef struct placido_incidence {
  double slope[2];       /* dx/dz, dy/dz of the ray through (x_mm, y_mm, 0), the pupil's centre */
  double nearness;       /* 1 / mm */
  double xx, xy, yy;     /* the lens's slopes per mm from the pupil's centre */
  double x_mm, y_mm;
  double index;          /* behind the cornea */
} placido_incidence;

/* A surface of revolution about the axis: c (x² + y² + (1 + q) z²) = 2 z behind its vertex. */
typedef struct placido_conic {
  double vertex_mm, curvature, q;
  double before, behind; /* indices */
} placido_conic;

/* Through the cornea, from x_mm, y_mm, depth_mm, sx and sy on. The lens is a phase plate, so that
 * rays are those of the paths (Fermat); within 0.1' of Prentice's rule for 10 D at 4 mm. Light that
 * meets the cornea from behind or at more than 80 degrees does not go on. */
void placido_beam_enter(const placido_beam *beam, const placido_incidence *incidence);

/* On to a surface and through it. */
void placido_beam_refract(const placido_beam *beam, const placido_conic *conic);

/* To the plane at depth_mm, back if need be. */
void placido_beam_plane(const placido_beam *beam, double depth_mm, double index);

/* To the far side of the sphere of radius_mm about the depth centre_mm. */
void placido_beam_sphere(const placido_beam *beam, double centre_mm, double radius_mm,
                         double index);

#endif
