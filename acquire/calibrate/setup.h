/* From views with found mires to a problem. */
#ifndef PLACIDO_CALIBRATE_SETUP_H
#define PLACIDO_CALIBRATE_SETUP_H

#include "acquire/calibrate/problem.h"

/* Room for `view_count` views of `ball_count` balls about an instrument; the prior's standard
 * deviations are taken (NULL: the instrument is exactly known), views and balls are the caller's to
 * fill. Free with placido_calibrate_problem_free. */
int placido_calibrate_problem_new(placido_calibrate_problem *problem,
                                  const placido_instrument *start,
                                  const placido_uncertainty *prior, int ball_count,
                                  int view_count, placido_error *err);
void placido_calibrate_problem_free(placido_calibrate_problem *problem);

void placido_calibrate_ball_set(placido_calibrate_problem *problem, int ball, double radius_mm,
                                double sigma_mm);

/* A view of ball `ball` with its vertex about z_mm; x and y are guessed from the mires' centre. */
void placido_calibrate_view_set(placido_calibrate_problem *problem, int view,
                                const placido_mires *mires, int ball, double z_mm,
                                double z_sigma_mm);

#endif
