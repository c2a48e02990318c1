/* The conicoid that the spline starts from. */
#ifndef PLACIDO_SOLVE_CONIC_H
#define PLACIDO_SOLVE_CONIC_H

#include "reconstruct/solve/shape.h"

/* Fits radius, asphericity and centre of a conicoid through (0, 0, axis_z_mm) to the samples,
 * starting from the 7.8 mm sphere, robustly. Sets `part` and `vertex_z_mm`. PLACIDO_QUALITY where
 * most rays miss every such cornea. */
int placido_conic_fit(placido_part *part, double *vertex_z_mm, placido_sample *samples,
                      size_t count, double axis_z_mm, int threads, placido_error *err);

/* A surface of that part alone, wide enough for any ray that matters. */
int placido_conic_surface(placido_surface **surface, const placido_part *part, double vertex_z_mm,
                          placido_error *err);

#endif
