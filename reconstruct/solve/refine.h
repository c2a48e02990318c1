/* The spline fitted on top of the conicoid: robust Gauss-Newton on the residuals in pixels. */
#ifndef PLACIDO_SOLVE_REFINE_H
#define PLACIDO_SOLVE_REFINE_H

#include "reconstruct/solve/normal.h"
#include "reconstruct/solve/shape.h"

/* Weight of the squared error in mm of the given distance at the axis: it holds to 0.3 nm. */
#define PLACIDO_DISTANCE_WEIGHT 1e13

/* What is being refined, and how well it went. `shape` holds base, grid and coefficients; the
 * spline is 0 at x = y = 0, where the distance is given. */
typedef struct placido_refinement {
  placido_shape shape;
  double *coefficients; /* what shape.coefficients points to; whoever sets them clears `traced` */
  bool traced;          /* the samples' residuals are those of the coefficients */
  placido_normal *normal;
  bool damped;          /* the normal matrix's factor is that of a damped step */
  placido_sample *samples;
  size_t count;
  double smoothing;
  int steps_max, threads;
  double sigma_px;      /* robust spread of the residuals; also the loss's unit */
  int steps;            /* taken so far */
  double *work;         /* `count` numbers */
  size_t *order;        /* samples by cell */
  double *blocks;       /* cells² blocks of the normal matrix with their right-hand sides */
} placido_refinement;

/* Sets up for samples and base (borrowed) on a fresh grid. Free with placido_refinement_free. */
int placido_refinement_new(placido_refinement *r, const placido_surface *base,
                           const placido_grid *grid, placido_sample *samples, size_t count,
                           double smoothing, int steps_max, int threads, placido_error *err);
void placido_refinement_free(placido_refinement *r);

/* A sample's row of the Jacobian over its cell's coefficients, residuals in sigmas. Returns its
 * weight, which the robust loss makes less than 1 for an outlier. */
double placido_sample_row(double row[PLACIDO_SPLINE_CELL], const placido_sample *sample,
                          double sigma_px);

/* Iterates until the cost falls by less than the share `settled` in a step and the residuals'
 * spread stays. Leaves in `normal` the matrix and its undamped factor, for the error bars.
 * PLACIDO_QUALITY where it does not settle. */
int placido_refinement_run(placido_refinement *r, double settled, placido_error *err);

#endif
