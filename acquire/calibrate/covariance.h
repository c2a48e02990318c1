/* What is known after the solution, and what is not. */
#ifndef PLACIDO_CALIBRATE_COVARIANCE_H
#define PLACIDO_CALIBRATE_COVARIANCE_H

#include "acquire/calibrate/solve.h"

/* Fills uncertainty, condition, inflation, undetermined and the balls' sigma_mm (ball_count is
 * set, balls allocated). `ordinary` is the view whose picture weighs the modes. */
int placido_calibrate_covariance(placido_calibration *calibration,
                                 placido_calibrate_solver *solver, int ordinary,
                                 placido_error *err);

#endif
