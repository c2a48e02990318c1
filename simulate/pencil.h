/* The rays of a pupil as the search of the focus sees them: slopes behind the cornea that change in
 * proportion with vergence and cross-cylinder, and weights. */
#ifndef PLACIDO_SIMULATE_PENCIL_H
#define PLACIDO_SIMULATE_PENCIL_H

#include "simulate/eye.h"
#include "simulate/trace.h"

#include <stdbool.h>

/* Vergence of the light that meets on the retina (1000 n / L for a retina L mm away), the
 * cross-cylinder worn, and a place on the retina: its offset from behind the pupil's centre over
 * L, so as a slope. */
typedef struct placido_aim {
  double vergence_D, j0_D, j45_D, x, y;
} placido_aim;

/* A part of the pupil: what lies between two circles. */
typedef struct placido_patch {
  double x_mm, y_mm; /* from the pupil's centre */
  double inner_mm, outer_mm;
} placido_patch;

/* Columns of `count` numbers each, in one block. */
typedef struct placido_pencil {
  size_t count;
  double index, j0_D, j45_D;   /* about which slopes are linear */
  float *x, *y;                /* where a ray enters, mm from the pupil's centre */
  float *slope_x, *slope_y;    /* at vergence 0 */
  float *m_x, *m_y;            /* their changes per dioptre of vergence, J0, J45 */
  float *j0_x, *j0_y, *j45_x, *j45_y;
  float *u, *v;                /* how far off the aim */
  float *weight;
} placido_pencil;

/* Room for `rays` rays, 1 at least. Free with placido_pencil_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_pencil_new(placido_pencil *pencil, size_t rays, placido_error *err);
void placido_pencil_free(placido_pencil *pencil);

/* Traces the rays, no more than there is room for, through what `eye` wears; exact for that lens,
 * linear about it. Rays that cannot enter are left out. */
void placido_pencil_trace(placido_pencil *pencil, const placido_rays *rays,
                          const placido_eye *eye);

/* Fills u and v. */
void placido_pencil_aim(placido_pencil *pencil, const placido_aim *aim);

/* Weight 1 inside the patch, 0 outside. */
void placido_pencil_select(placido_pencil *pencil, const placido_patch *patch);

/* Weights (1 + d²/width²)^-3 of the distance from the aim; returns the light gathered there, the
 * sum of (1 + d²/width²)^-2. */
double placido_pencil_gather(placido_pencil *pencil, double width);

/* The change of aim that brings the weighted rays closest to one place (least squares), with
 * vergence or cross-cylinder held where they are not open. `rms` receives how far from their middle
 * they are before it. False where the rays do not determine it. */
bool placido_pencil_fit(const placido_pencil *pencil, bool vergence_open, bool cylinder_open,
                        placido_aim *change, double *rms);

#endif
