/* The cornea as the fit sees it while it is being fitted: a base surface and a spline on top, and
 * the rays of the edge points on it. */
#ifndef PLACIDO_SOLVE_SHAPE_H
#define PLACIDO_SOLVE_SHAPE_H

#include "reconstruct/mirror.h"
#include "reconstruct/solve/engine/spline.h"

#include <placido/mires.h>
#include <placido/surface.h>

/* z = base + spline; the spline may be absent (coefficients NULL). Borrowed pointers. */
typedef struct placido_shape {
  const placido_surface *base;
  const placido_grid *grid;
  const double *coefficients;
} placido_shape;

/* Where on the spline: a cell, the place in it, 0 to 1 each way, and the grid's order and spacing.
 * */
typedef struct placido_spot {
  int column, row, order;
  double x, y, knot_mm;
} placido_spot;

/* One edge point on its way through the fit. */
typedef struct placido_sample {
  placido_ray ray;
  const placido_edge *edge;
  size_t point;       /* its place in the list of mires */
  double t;           /* where its ray met the shape last */
  placido_hit hit;
  placido_spot basis; /* valid where the shape has a spline */
  placido_miss miss;
  double slope;       /* of the miss in the image, per px */
  double residual_px; /* signed distance from the edge, first order (Sampson); NaN: ray misses */
  bool used;
  double shared;      /* the part of `noise` that is due to neighbours measuring the same */
  double noise;       /* standard deviation, relative to the others'. While the spline is fitted
                         (sightlines.h), what slope and residual call a px is so many */
} placido_sample;

/* Follows the sample's ray to the shape, mirrors it and takes the miss. */
void placido_sample_trace(placido_sample *sample, const placido_shape *shape);

/* The samples of all points; their rays start from the plane z = axis_z_mm. Free with
 * placido_memory_free. */
int placido_samples_new(placido_sample **samples, const placido_mires *mires,
                        const placido_instrument *instrument, double axis_z_mm,
                        placido_error *err);

/* 1.4826 · median |residual| of the used samples: a robust standard deviation. `work` holds `count`
 * numbers. NaN where none is used. */
double placido_samples_spread(const placido_sample *samples, size_t count, double *work);

#endif
