/* The normal equations of a refinement, from its rays cell by cell. */
#ifndef PLACIDO_SOLVE_ASSEMBLE_H
#define PLACIDO_SOLVE_ASSEMBLE_H

#include "reconstruct/solve/engine/refine.h"

#define PLACIDO_HUBER 3.0 /* in sigmas: where the loss turns from square to linear */

/* The spline's value at the axis, and the basis there. */
double placido_refinement_at_axis(const placido_refinement *r, placido_basis *basis);

/* Sets up r->normal at the present coefficients, where the rays have been traced to. */
void placido_refinement_assemble(placido_refinement *r);

#endif
