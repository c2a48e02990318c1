/* What a calibration solves for, what is known beforehand, and what was seen. */
#ifndef PLACIDO_CALIBRATE_PROBLEM_H
#define PLACIDO_CALIBRATE_PROBLEM_H

#include <placido/calibrate.h>
#include <placido/mires.h>
#include <placido/uncertainty.h>

#define PLACIDO_CALIBRATE_BALLS_MAX 32

/* A picture's own three unknowns are where the ball's vertex is, its point nearest the camera. */
typedef struct placido_calibrate_view {
  const placido_mires *mires;
  int ball;
  double start_mm[3], sigma_mm[3]; /* of the vertex */
} placido_calibrate_view;

/* The unknowns are told in prior standard deviations from the start: first those of the instrument
 * in the order of placido/uncertainty.h, then the balls' radii, then three a view. What has a
 * standard deviation of 0 stays where it is. */
typedef struct placido_calibrate_problem {
  placido_instrument start;
  int parameters;      /* of the instrument */
  int shared;          /* those and the balls' radii */
  int ball_count, view_count;
  double *start_value, *sigma; /* of the shared unknowns */
  placido_calibrate_view *views;
} placido_calibrate_problem;

/* A view's rays all begin with these. */
typedef struct placido_calibrate_geometry {
  placido_instrument instrument;
  double radius_mm, centre_mm[3];
} placido_calibrate_geometry;

/* What the unknowns `q` say of view `view`. */
placido_calibrate_geometry placido_calibrate_geometry_of(const placido_calibrate_problem *problem,
                                                         const double *q, int view);

/* The derivatives of a point's residual by the unknowns it depends on: the camera's twelve, its
 * edge's two, the ball's radius; and the view's three. */
#define PLACIDO_CALIBRATE_SHARED_MAX (PLACIDO_UNCERTAINTY_CAMERA + 3)
typedef struct placido_calibrate_row {
  double residual_px; /* distance across the edge */
  double shared[PLACIDO_CALIBRATE_SHARED_MAX], view[3]; /* px per unit of the parameter */
} placido_calibrate_row;

/* False where the point's ray passes the ball. `derivatives` false leaves them out. */
bool placido_calibrate_row_at(placido_calibrate_row *row,
                              const placido_calibrate_geometry *geometry,
                              const placido_mire_point *point, bool derivatives);

/* The places of row->shared in the vector of unknowns, ascending. */
void placido_calibrate_places(int places[PLACIDO_CALIBRATE_SHARED_MAX],
                              const placido_calibrate_problem *problem, int edge, int ball);

#endif
