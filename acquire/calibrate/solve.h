/* The joint least squares: Levenberg's and Marquardt's steps with each view's own three unknowns
 * eliminated. */
#ifndef PLACIDO_CALIBRATE_SOLVE_H
#define PLACIDO_CALIBRATE_SOLVE_H

#include "acquire/calibrate/problem.h"

/* A view's share of the normal equations. */
typedef struct placido_calibrate_block {
  double own[3][3], gradient[3];
  double *across; /* shared × 3 */
} placido_calibrate_block;

typedef struct placido_calibrate_solver {
  const placido_calibrate_problem *problem;
  double *q;         /* the unknowns */
  double sigma_px;   /* robust, of the residuals */
  double inflation;  /* variance of whole edges over that of their points */
  int steps;
  double *normal, *gradient; /* of the shared unknowns, before the elimination */
  placido_calibrate_block *blocks;
  double *reduced, *trial, *right; /* room */
} placido_calibrate_solver;

/* Starts at q = 0. Free with placido_calibrate_solver_free. */
int placido_calibrate_solver_new(placido_calibrate_solver *solver,
                                 const placido_calibrate_problem *problem, placido_error *err);
void placido_calibrate_solver_free(placido_calibrate_solver *solver);

/* Steps until nothing changes, with a pseudo-Huber loss at three robust standard deviations.
 * PLACIDO_QUALITY where it does not converge. */
int placido_calibrate_solver_run(placido_calibrate_solver *solver, placido_error *err);

/* The Cholesky factor of the shared unknowns' inverse covariance at the solution, noise and its
 * correlation along edges included; borrowed. */
int placido_calibrate_solver_information(placido_calibrate_solver *solver, const double **factor,
                                         placido_error *err);

#endif
