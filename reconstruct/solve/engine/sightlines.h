/* All rays of a fit traced together: numbers of one kind side by side, cell by cell of the spline,
 * so that the rays of one cell share its polynomial and a processor's vectors are full. */
#ifndef PLACIDO_SOLVE_SIGHTLINES_H
#define PLACIDO_SOLVE_SIGHTLINES_H

#include "reconstruct/solve/engine/conicoid.h"
#include "reconstruct/solve/engine/shape.h"

/* What is kept of every ray. A camera's rays share the z of their origin, and their directions have
 * z = -1; by the image point either their origins move or their directions. */
enum placido_ray_number {
  PLACIDO_RAY_ORIGIN_X,
  PLACIDO_RAY_ORIGIN_Y,
  PLACIDO_RAY_DIRECTION_X,
  PLACIDO_RAY_DIRECTION_Y,
  PLACIDO_RAY_U_X, /* d/du and d/dv of what moves */
  PLACIDO_RAY_U_Y,
  PLACIDO_RAY_V_X,
  PLACIDO_RAY_V_Y,
  PLACIDO_RAY_EDGE_RADIUS,
  PLACIDO_RAY_EDGE_Z,
  PLACIDO_RAY_NOISE, /* of its sample */
  PLACIDO_RAY_T,     /* where it met the shape last */
  /* found by tracing: */
  PLACIDO_RAY_RESIDUAL_PX, /* NaN: it misses */
  PLACIDO_RAY_BY_Z,        /* of the residual, px/mm */
  PLACIDO_RAY_BY_P,
  PLACIDO_RAY_BY_Q,
  PLACIDO_RAY_PLACE_X, /* in its cell, 0 to 1 */
  PLACIDO_RAY_PLACE_Y,
  PLACIDO_RAY_ASIDE, /* how far from its place the ray meets the shape, mm */
  PLACIDO_RAY_NUMBERS
};

/* The rays stand in an order of their own, neighbours on the cornea near each other. */
typedef struct placido_sightlines {
  placido_sample *samples; /* borrowed */
  size_t *sample;          /* a ray's own among them */
  size_t count;
  double origin_z_mm;
  bool moves_origin;
  double *numbers[PLACIDO_RAY_NUMBERS];
  unsigned char *used;   /* whether its sample is */
  int *cells;            /* where the shape was asked for them last */
  unsigned char *chosen; /* the rays that are sorted */
  size_t *order;         /* they by cell, */
  size_t *starts;        /* and where in it the cells begin; one more is the end */
  size_t starts_room;
} placido_sightlines;

/* What the rays are traced to: base + spline. The grid NULL: the base alone. */
typedef struct placido_target {
  placido_conicoid base;
  const placido_grid *grid;
  const double *coefficients;
} placido_target;

/* Of samples with their rays and edges, which meet the target about where sample.t says. Free with
 * placido_sightlines_free. PLACIDO_MEMORY. */
int placido_sightlines_new(placido_sightlines *sightlines, placido_sample *samples, size_t count,
                           placido_error *err);
void placido_sightlines_free(placido_sightlines *sightlines);

/* Room for a grid's cells, before rays are traced to it. PLACIDO_MEMORY. */
int placido_sightlines_fit_grid(placido_sightlines *sightlines, const placido_grid *grid,
                                placido_error *err);

/* Hears from the samples what is used and how noisy they are; a trace stays as good as it was. */
void placido_sightlines_hear(placido_sightlines *sightlines);

/* Follows all rays to the target, mirrors them and takes the misses. */
void placido_sightlines_trace(placido_sightlines *sightlines, const placido_target *target,
                              int threads);

/* Orders the rays that count (those used that meet the target) by cell. */
void placido_sightlines_sort(placido_sightlines *sightlines, const placido_grid *grid);

/* Tells the samples of a traced sightlines their residual and where they are (hit.x and hit.y). */
void placido_sightlines_tell(const placido_sightlines *sightlines);

/* Tells them everything; the target is the one that was traced last. */
void placido_sightlines_tell_all(placido_sightlines *sightlines, const placido_target *target,
                                 int threads);

#endif
