/* The conicoid that the spline starts from. */
#ifndef PLACIDO_SOLVE_CONIC_H
#define PLACIDO_SOLVE_CONIC_H

#include "reconstruct/solve/engine/sightlines.h"

/* Fits radius, asphericity and centre of a conicoid through (0, 0, axis_z_mm) to the rays, starting
 * from the 7.8 mm sphere, robustly. PLACIDO_QUALITY where most rays miss every such cornea. */
int placido_conic_fit(placido_conicoid *conicoid, placido_sightlines *rays, double axis_z_mm,
                      int threads, placido_error *err);

/* The same as a part of a surface. */
placido_part placido_conic_part(const placido_conicoid *conicoid);

#endif
