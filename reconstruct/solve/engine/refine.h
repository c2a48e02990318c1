/* The spline fitted on top of the conicoid: robust Gauss-Newton on the residuals in pixels. */
#ifndef PLACIDO_SOLVE_REFINE_H
#define PLACIDO_SOLVE_REFINE_H

#include "reconstruct/solve/engine/normal.h"
#include "reconstruct/solve/engine/sightlines.h"

/* Weight of the squared error in mm of the given distance at the axis: it holds to 0.3 nm. */
#define PLACIDO_DISTANCE_WEIGHT 1e13

/* What is being refined, and how well it went. `shape` holds base, grid and coefficients; the
 * spline is 0 at x = y = 0, where the distance is given. */
typedef struct placido_refinement {
  placido_target shape;
  double *coefficients; /* what shape.coefficients points to; whoever sets them clears `traced` */
  bool traced;          /* the residuals are those of the coefficients */
  bool told;            /* and the samples have been told everything */
  placido_normal *normal;
  bool damped;          /* the normal matrix's factor is that of a damped step */
  placido_sightlines *rays; /* borrowed, and its samples */
  placido_sample *samples;
  size_t count;
  double smoothing;
  int steps_max, threads;
  double sigma_px;      /* robust spread of the residuals; also the loss's unit */
  int steps;            /* taken so far */
  double *work;         /* `count` numbers */
} placido_refinement;

/* Sets up for rays (borrowed) and base on a fresh grid (borrowed). Free with
 * placido_refinement_free. */
int placido_refinement_new(placido_refinement *r, const placido_conicoid *base,
                           const placido_grid *grid, placido_sightlines *rays, double smoothing,
                           int steps_max, int threads, placido_error *err);
void placido_refinement_free(placido_refinement *r);

/* Goes on with other rays (borrowed) from where it is. PLACIDO_MEMORY. */
int placido_refinement_aim(placido_refinement *r, placido_sightlines *rays, placido_error *err);

/* A sample's row of the Jacobian over its cell's coefficients, residuals in sigmas. Returns its
 * weight, which the robust loss makes less than 1 for an outlier. For samples that have been told
 * everything. */
double placido_sample_row(double row[PLACIDO_SPLINE_CELL], const placido_sample *sample,
                          double sigma_px);

/* The weight alone. */
double placido_sample_weight(const placido_sample *sample, double sigma_px);

/* Adds JᵀW e to right-hand sides that stand one after the other: for each edge of `mires` (may be
 * NULL) one whose errors e are 1/noise for its own samples, then one for each of `columns` columns
 * of errors, in sigmas, which stand side by side sample by sample. */
void placido_refinement_push(double *rights, const placido_refinement *r,
                             const placido_mires *mires, const double *errors, int columns);

/* Follows the rays to the shape as it stands, where that has not been done, and tells the samples
 * their residuals. */
void placido_refinement_trace(placido_refinement *r);

/* Iterates until the cost falls by less than the share `settled` in a step, or would in the next
 * one, and the residuals' spread stays. Leaves in `normal` the matrix and its undamped factor, for
 * the error bars, and tells the samples their residuals and where they are. PLACIDO_QUALITY where
 * it does not settle. */
int placido_refinement_run(placido_refinement *r, double settled, placido_error *err);

/* Tells the samples everything else, where that has not been done. */
void placido_refinement_tell(placido_refinement *r);

#endif
