/* What a fit leaves: the surface, and the covariances that its error bars come from. */
#ifndef PLACIDO_SOLVE_RESULT_H
#define PLACIDO_SOLVE_RESULT_H

#include "reconstruct/solve/errors/scatter.h"

#include "reconstruct/solve/engine/conicoid.h"

#include <placido/reconstruct.h>

struct placido_fit {
  placido_surface *surface;
  placido_conicoid base; /* what the next frame's fit may start from: the conicoid, */
  double *sags_mm;       /* the spline on it, as coefficients of the sag, */
  double axis_z_mm;      /* and the distance that both were fitted for */
  placido_grid grid;
  placido_normal *normal;
  double *inverse;      /* of the normal matrix, at its own pattern */
  double *by_distance;  /* d coefficients / d axis_z */
  double *geometry;     /* covariance from the instrument, as `inverse`; NULL: not known */
  double *modes;        /* mode by mode: how the coefficients answer; their outer products' sum is
                           `geometry` */
  int mode_count;
  double variance_scale; /* usual factor on `inverse` that makes the noise's covariance of it */
  placido_scatter scatter; /* what makes the noise's covariance of `inverse` */
  double *level;        /* mean height of the central zone, over the coefficients */
  double *with_level;   /* the noise's covariance times `level` */
  double level_variance; /* of the level itself, by the noise */
  double *lift;         /* how the distance, per mm, and each mode move the level */
  double axis_z_sigma_mm;
  placido_fit_summary summary;
};

/* Fills by_distance and what is missing of inverse and scatter from the normal matrix's last factor;
 * a scatter that is missing is even, sqrt(variance_scale). */
int placido_fit_covariance(placido_fit *fit, placido_error *err);

/* Fills what counts heights from the level, once surface and scatter are there. Until then heights
 * count from the axis. */
int placido_fit_level_find(placido_fit *fit, placido_error *err);

/* Where the mires tell least. */
typedef struct placido_open {
  double x_mm, y_mm, sigma_D;
} placido_open;

/* The share of the covered area where the points leave the axial power open by more than a limit,
 * and the worst place. */
double placido_fit_open_share(const placido_fit *fit, double limit_D, placido_open *worst);

/* The noise's covariance of a cell's coefficients, a full CELL × CELL matrix; beyond the grid's
 * order² it is 0. */
void placido_fit_noise_block(double block[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL],
                             const placido_fit *fit, int column, int row);

/* The noise's covariance times `count` rows of weights over all coefficients. */
int placido_fit_noise_times(double *answers, const placido_fit *fit, const double *weights,
                            int count, placido_error *err);

#endif
