/* Rays of one cell that are traced together. */
#ifndef PLACIDO_SOLVE_BATCH_H
#define PLACIDO_SOLVE_BATCH_H

#include "reconstruct/solve/engine/sightlines.h"

#define PLACIDO_BATCH 64 /* rays at a time */

/* Rays that are worked on together, and the shape's jet where they are. */
typedef struct placido_batch {
  int count, lanes; /* what is beyond the count repeats the last ray, for vectors that are full */
  double in[PLACIDO_RAY_NUMBERS][PLACIDO_BATCH];
  double x[PLACIDO_BATCH], y[PLACIDO_BATCH], z[PLACIDO_BATCH], p[PLACIDO_BATCH], q[PLACIDO_BATCH],
      xx[PLACIDO_BATCH], xy[PLACIDO_BATCH], yy[PLACIDO_BATCH];
  double f[PLACIDO_BATCH], by_z[PLACIDO_BATCH], by_p[PLACIDO_BATCH], by_q[PLACIDO_BATCH],
      by_u[PLACIDO_BATCH], by_v[PLACIDO_BATCH];
  double by_radius[PLACIDO_BATCH], by_height[PLACIDO_BATCH], slope[PLACIDO_BATCH];
} placido_batch;

/* Copies `count` rays of a sightlines, those whose numbers are in `which`. */
void placido_batch_gather(placido_batch *b, const placido_sightlines *sightlines,
                          const size_t *which, int count);

/* One step of Newton's to the base and, unless it is NULL, the cell's polynomial on it; then the
 * jet where the rays come to be, and their misses. */
void placido_batch_evaluate(placido_batch *b, const placido_conicoid *base,
                            const double *polynomial, double knot_mm, double origin_z_mm,
                            bool moves_origin);

/* Copies what was found back. */
void placido_batch_scatter(const placido_batch *b, placido_sightlines *sightlines,
                           const size_t *which);

#endif
