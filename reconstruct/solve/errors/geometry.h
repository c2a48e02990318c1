/* How the surface moves with the instrument's geometry. */
#ifndef PLACIDO_SOLVE_GEOMETRY_H
#define PLACIDO_SOLVE_GEOMETRY_H

#include "reconstruct/solve/engine/refine.h"

#include <placido/mires.h>
#include <placido/uncertainty.h>

/* Parameters that a sample's residual depends on: the camera's in the order of
 * placido/uncertainty.h, then radius and height of the sample's own edge. */
#define PLACIDO_SAMPLE_PARAMETERS (PLACIDO_UNCERTAINTY_CAMERA + 2)

/* d residual_px / d parameter of a traced sample, the surface held; `point` is where it was seen. */
void placido_sample_by_geometry(double by[PLACIDO_SAMPLE_PARAMETERS], const placido_sample *sample,
                                const placido_mire_point *point,
                                const placido_instrument *instrument);

/* How far, in px, an edge stands off the line through its neighbours because of the geometry's
 * first `modes` modes: the part of their effect that no smooth surface follows. From traced
 * samples. */
double placido_geometry_rough(const placido_sample *samples, size_t count,
                              const placido_mires *mires, const placido_instrument *instrument,
                              const placido_uncertainty *uncertainty, int modes);

/* What one standard deviation of each mode of the geometry does. */
typedef struct placido_moves {
  int modes;
  double *change;       /* sample by sample, its modes together: d residual in sigmas, the surface
                           held; 0 for samples that do not count */
  double *coefficients; /* mode by mode: how the fitted coefficients answer */
} placido_moves;

/* Of the first `modes` modes, at a refinement's end: one right-hand side each with its last factor.
 * Free with placido_moves_free. */
int placido_moves_new(placido_moves *moves, const placido_refinement *r,
                      const placido_mires *mires, const placido_instrument *instrument,
                      const placido_uncertainty *uncertainty, int modes, placido_error *err);
void placido_moves_free(placido_moves *moves);

#endif
