/* The pupil's rays traced run by run, into columns that the caller has. */
#ifndef PLACIDO_SIMULATE_RAYS_TRACER_H
#define PLACIDO_SIMULATE_RAYS_TRACER_H

#include "reconstruct/surface/sheet.h"
#include "simulate/eye.h"
#include "simulate/rays/pattern.h"

#include <placido/surface.h>

/* Immutable once made; any number of threads may trace with it, each into its own columns. */
typedef struct placido_tracer {
  const placido_surface *surface; /* borrowed */
  double axis_sag_mm;
  placido_eye eye;
  placido_pattern pattern;
  placido_sheet *sheets[2]; /* of the crosshatch: its nodes and its middles */
  size_t work;              /* numbers that a run needs to work in */
} placido_tracer;

/* Room for a run's rays, in its order. */
typedef struct placido_ray_columns {
  double *x_mm, *y_mm;      /* where each meets the surface */
  double *depth_mm;         /* of that point behind the surface's point on the axis */
  double *sx, *sy;          /* slopes of the surface; NaN where it is not defined */
  double *u, *v;            /* slopes dx/dz, dy/dz behind it; NaN where a ray does not go on */
  double *weight;           /* share of the pupil's area; NULL: not wanted */
  double *sxx, *sxy, *syy;  /* second derivatives, of patterns without rows only; or NULL */
  double *work;
} placido_ray_columns;

/* `rays` as for placido_bundle_new; everything in `eye` is settled. Free with placido_tracer_free.
 * PLACIDO_OK or PLACIDO_MEMORY. */
int placido_tracer_new(placido_tracer *tracer, const placido_surface *surface,
                       const placido_apex *apex, const placido_eye *eye,
                       enum placido_pattern_kind pattern, long rays, placido_error *err);
void placido_tracer_free(placido_tracer *tracer);

/* Traces the rays of a run that are inside the pupil and returns how many there are. */
int placido_tracer_run(const placido_tracer *tracer, long run, const placido_ray_columns *columns);

#endif
