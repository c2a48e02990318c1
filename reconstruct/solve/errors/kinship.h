/* How alike the errors of neighbouring edge points are, and so how much less they tell than as many
 * independent ones. */
#ifndef PLACIDO_SOLVE_KINSHIP_H
#define PLACIDO_SOLVE_KINSHIP_H

#include "reconstruct/solve/engine/refine.h"

/* The distance along an edge over which errors are alike, because points share pixels: meridians
 * that lie closer together are so many measurements of one thing. `residual_px` is a table of edges
 * × meridians with NaN where there is none, `step_px` the meridians' distance on each edge, 0 where
 * it has no points. 0 where points err independently, or are alike over so far that it is the
 * surface that does not follow them; the usual figure of pictures where meridians are too far apart
 * to tell. `work` holds `meridians` numbers. */
double placido_kinship_length(const double *residual_px, const double *step_px, int edges,
                              int meridians, double *work);

/* The factor by which a point's standard deviation is to be larger where the meridians lie
 * `step_px` apart: each stands for only a part of a point. */
double placido_kinship_factor(double length_px, double step_px);

/* Several edges move together under a smooth surface. */
typedef struct placido_kinship {
  double arcs;   /* variance of short arcs' means over that of independent points */
  double across; /* 1 + 2 Σ correlation of neighbouring edges: what that is times for all edges */
} placido_kinship;

/* From a refinement's end; `residual_px` are the samples' residuals. Differences of neighbouring
 * arcs show it, which a smooth surface cannot take away. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_kinship_find(placido_kinship *kinship, const placido_refinement *r,
                         const placido_mires *mires, const double *residual_px, placido_error *err);

#endif
