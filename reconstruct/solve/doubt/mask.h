/* Where data support the surface. */
#ifndef PLACIDO_SOLVE_MASK_H
#define PLACIDO_SOLVE_MASK_H

#include "reconstruct/solve/engine/shape.h"

/* The used samples' places grown into an area and shrunk back: holes narrower than twice the
 * reach close, wider ones stay open, and nothing is added outside the outermost mires. The reach
 * spans the pupil inside the innermost mire and the ordinary distance between mires, at least
 * 0.3 mm. `mask` is allocated into `coverage`; free it with placido_memory_free. `radius_mm`
 * receives the radius of the disc about the axis that holds the area. */
int placido_mask_new(placido_coverage *coverage, unsigned char **mask, double *radius_mm,
                     const placido_sample *samples, size_t count, placido_error *err);

/* A place on the cornea. */
typedef struct placido_place {
  double x_mm, y_mm;
} placido_place;

/* The same of `count` places (at least one, within 20 mm of the axis) and a given reach. */
int placido_mask_close(placido_coverage *coverage, unsigned char **mask, double *radius_mm,
                       const placido_place *places, size_t count, double reach_mm,
                       placido_error *err);

#endif
