/* What this simulation does not model, each with an estimate of what that is worth. */
#ifndef PLACIDO_SIMULATE_LEFT_OUT_H
#define PLACIDO_SIMULATE_LEFT_OUT_H

#include <placido/simulate.h>
#include <stddef.h>

/* One effect. `estimate` returns a figure in `unit`, NaN where it depends on what the eye's front
 * surface cannot tell. */
typedef struct placido_left_out {
  const char *name, *unit, *why;
  double (*estimate)(const placido_psf *psf);
} placido_left_out;

/* The effects, `*count` of them. */
const placido_left_out *placido_left_out_list(size_t *count);

/* Root mean square distance of the landed light from its centroid, arcmin. */
double placido_psf_rms_arcmin(const placido_psf *psf);

#endif
