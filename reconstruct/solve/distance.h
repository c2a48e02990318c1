/* What the mires themselves say of the cornea's distance. Mires on one cone or plane say nothing:
 * the surface makes up for any distance. Staggered ones do. */
#ifndef PLACIDO_SOLVE_DISTANCE_H
#define PLACIDO_SOLVE_DISTANCE_H

#include "reconstruct/solve/errors/geometry.h"

#include <placido/notes.h>

/* How the coefficients answer to the distance, per mm, with the normal matrix's last factor.
 * `by_distance` has room for all coefficients. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_distance_answer(double *by_distance, placido_normal *normal, const placido_grid *grid,
                            placido_error *err);

/* z of the cornea on the axis: as given, and as it is known now. */
typedef struct placido_axis {
  double given_mm, given_sigma_mm; /* 0: exactly known, never solved for */
  double z_mm, sigma_mm;
  bool solved;
} placido_axis;

placido_axis placido_axis_given(double z_mm, double sigma_mm);

/* What else it takes; borrowed. */
typedef struct placido_distance_source {
  const placido_mires *mires;
  const placido_instrument *instrument;
  const placido_uncertainty *geometry; /* NULL where `modes` is 0 */
  int modes;
  double settled; /* of placido_refinement_run */
} placido_distance_source;

/* From a refinement's end: where the mires tell the distance better than whoever gave it, moves the
 * refinement to the mean of both, weighted by their variances, and refines it there. It cannot run
 * off: far from what was given, what was given holds, with a warning. Returns PLACIDO_OK or what
 * placido_refinement_run returns. */
int placido_distance_solve(placido_axis *axis, placido_refinement *r,
                           const placido_distance_source *source, placido_notes *notes,
                           placido_error *err);

#endif
