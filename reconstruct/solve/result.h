/* What a fit leaves: the surface, and the covariances that its error bars come from. */
#ifndef PLACIDO_SOLVE_RESULT_H
#define PLACIDO_SOLVE_RESULT_H

#include "reconstruct/solve/normal.h"

#include <placido/reconstruct.h>

struct placido_fit {
  placido_surface *surface;
  placido_grid grid;
  placido_normal *normal;
  double *inverse;      /* covariance of the coefficients at the normal matrix's pattern */
  double *by_distance;  /* d coefficients / d axis_z */
  double *geometry;     /* covariance from the instrument, as `inverse`; NULL: not known */
  double *modes;        /* mode by mode: how the coefficients answer; their outer products' sum is
                           `geometry` */
  int mode_count;
  double *draws;        /* PLACIDO_NOISE_VARIANTS draws of the coefficients' noise, each scaled so that
                           their outer products' sum is its covariance */
  double variance_scale, axis_z_sigma_mm;
  placido_fit_summary summary;
};

/* Fills inverse and by_distance from the normal matrix's last factor. */
int placido_fit_covariance(placido_fit *fit, placido_error *err);

/* Fills draws from the normal matrix's last factor and variance_scale. */
int placido_fit_variants_draw(placido_fit *fit, placido_error *err);

#endif
