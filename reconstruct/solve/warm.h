/* Where a fit starts from that has an earlier one of about the same cornea to go by: the frame
 * before, of an eye that has hardly moved. */
#ifndef PLACIDO_SOLVE_WARM_H
#define PLACIDO_SOLVE_WARM_H

#include "reconstruct/solve/engine/refine.h"
#include "reconstruct/solve/errors/result.h"

/* How to refine from there. */
typedef struct placido_warm_options {
  double axis_z_mm; /* the spline's base is shifted to it */
  double margin_mm; /* of spline beyond the outermost point */
  double smoothing, settled;
  int steps_max, threads;
} placido_warm_options;

/* Refines the earlier fit's spline to some rays. `r` is left empty (r->coefficients NULL) where the
 * earlier fit's mires lie too far from where they are now, the rays do not agree with its knots as
 * well as the earlier ones did, or the refinement does not settle: then there is nothing to go by.
 * `base` and `grid` receive what `r` borrows. PLACIDO_MEMORY. */
int placido_warm_start(placido_refinement *r, placido_conicoid *base, placido_grid *grid,
                       const placido_fit *start, placido_sightlines *rays,
                       const placido_warm_options *options, placido_error *err);

#endif
