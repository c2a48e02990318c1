/* Error bars of a surface that may have none. */
#ifndef PLACIDO_MAPS_SIGMA_H
#define PLACIDO_MAPS_SIGMA_H

#include <placido/reconstruct.h>

/* As placido_fit_sigma_at, and NaN where `fit` is NULL. */
void placido_sigma_at(const placido_fit *fit, double x_mm, double y_mm, double *sigma_z_um,
                      double *sigma_axial_D);

#endif
