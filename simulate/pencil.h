/* The rays of a pupil as the search of the correction sees them: slopes behind the cornea that
 * change in proportion with what is searched, and how much of the light lies close together. */
#ifndef PLACIDO_SIMULATE_PENCIL_H
#define PLACIDO_SIMULATE_PENCIL_H

#include "simulate/eye.h"
#include "simulate/trace.h"

#include <stdbool.h>

enum { PLACIDO_PENCIL_UNKNOWNS = 3 }; /* power, J0, J45 */

/* Where the light is to meet: power of the sphere, cross-cylinder worn, and a place on the retina,
 * its offset from behind the pupil's centre over the retina's distance L, so as a slope. The power
 * is the vergence on the retina, 1000 n / L, where the retina is searched, else the lens's M. */
typedef struct placido_aim {
  double power_D[PLACIDO_PENCIL_UNKNOWNS]; /* sphere, J0, J45 */
  double x, y;
} placido_aim;

/* A part of the pupil: what lies between two circles. */
typedef struct placido_patch {
  double x_mm, y_mm; /* from the pupil's centre */
  double inner_mm, outer_mm;
} placido_patch;

/* Columns of `padded` numbers each, in one block; what is behind `count` gathers no light. */
typedef struct placido_pencil {
  size_t room, count, padded;
  double about_D[PLACIDO_PENCIL_UNKNOWNS];   /* where the slopes were traced */
  float *x, *y;                              /* where a ray enters, mm from the pupil's centre */
  float *slope_x, *slope_y;                  /* there */
  float *change_x[PLACIDO_PENCIL_UNKNOWNS], *change_y[PLACIDO_PENCIL_UNKNOWNS]; /* a dioptre */
  float *u, *v;                              /* how far off the aim */
  float *weight;
} placido_pencil;

/* Room for `rays` rays. Free with placido_pencil_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_pencil_new(placido_pencil *pencil, size_t rays, placido_error *err);
void placido_pencil_free(placido_pencil *pencil);

/* Traces the rays, no more than there is room for, through what `eye` wears; exact for that lens,
 * linear about it. Where eye->retina_mm is 0 the retina's distance is the sphere, else the lens.
 * Rays that cannot enter are left out. */
void placido_pencil_trace(placido_pencil *pencil, const placido_rays *rays,
                          const placido_eye *eye);

/* Ends columns that the caller has filled with `count` rays. */
void placido_pencil_close(placido_pencil *pencil);

/* The light within about `width` (a slope) of the aim: the sum of (1 + d²/width²)^-3/2 over the
 * rays, d their distance from it. Fills u and v; weights become the profile's derivative,
 * (1 + d²/width²)^-5/2. */
double placido_pencil_gather(placido_pencil *pencil, const placido_aim *aim, double width);

/* Fills u and v, and weights of 1. */
void placido_pencil_aim(placido_pencil *pencil, const placido_aim *aim);

/* Weight 1 inside the patch, 0 outside; returns how many rays are inside. */
size_t placido_pencil_select(placido_pencil *pencil, const placido_patch *patch);

/* The change of aim that brings the weighted rays closest to one place (least squares); powers
 * change where `open`. `rms` receives how far from that place they are after it. False where the rays
 * do not determine it. */
bool placido_pencil_fit(const placido_pencil *pencil, const bool open[PLACIDO_PENCIL_UNKNOWNS],
                        placido_aim *change, double *rms);

#endif
