/* The error bars of the maps. */
#ifndef PLACIDO_MAPS_ERRORS_H
#define PLACIDO_MAPS_ERRORS_H

#include "reconstruct/maps/zone.h"
#include "reconstruct/solve/errors/jet_sigma.h"

#include <placido/map.h>

/* What they are propagated from; the fit is borrowed. */
typedef struct placido_map_errors {
  const placido_fit *fit;
  placido_jet_cells cells;
  placido_jet_figures figures; /* the references' parameters, the vertex, the level */
} placido_map_errors;

/* `common` holds what all points have in common. Free with placido_map_errors_free. Returns
 * PLACIDO_OK or PLACIDO_MEMORY. */
int placido_map_errors_new(placido_map_errors *errors, const placido_fit *fit,
                           const placido_surface *surface, const placido_zone *zone,
                           const placido_map_point *common, placido_error *err);
void placido_map_errors_free(placido_map_errors *errors);

/* The standard deviations at a point of z and of every kind, whose values there are `values`; NaN
 * where they cannot be told. */
void placido_map_errors_at(const placido_map_errors *errors, const placido_map_point *point,
                           const double *values, double *sigma_z_um, double *sigmas);

#endif
