/* What the mires themselves say of the cornea's distance. Mires on one cone or plane say nothing:
 * the surface makes up for any distance. Staggered ones do. */
#ifndef PLACIDO_SOLVE_DISTANCE_H
#define PLACIDO_SOLVE_DISTANCE_H

#include "reconstruct/solve/geometry.h"

/* How the coefficients answer to the distance, per mm, with the normal matrix's last factor.
 * `by_distance` has room for all coefficients. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_distance_answer(double *by_distance, placido_normal *normal, const placido_grid *grid,
                            placido_error *err);

/* The step of z on the axis that the residuals ask for, and its standard deviation: from the edges'
 * noise, each edge one witness, and the geometry. NaN and INFINITY where nothing is said. */
typedef struct placido_distance {
  double step_mm, sigma_mm;
} placido_distance;

/* At a refinement's end, its samples told everything. `moves` may be NULL; its change of the
 * residuals is that under a surface that is held. */
placido_distance placido_distance_find(const placido_refinement *r, const placido_mires *mires,
                                       const double *by_distance, const placido_moves *moves);

/* Moves a refinement's base and coefficients by a step of the distance as they answer to it. */
void placido_distance_move(placido_refinement *r, const double *by_distance, double step_mm);

#endif
