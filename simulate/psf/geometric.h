/* The geometric point spread function: rays traced to a plane retina and counted, or spread, over
 * square buckets. */
#ifndef PLACIDO_SIMULATE_PSF_GEOMETRIC_H
#define PLACIDO_SIMULATE_PSF_GEOMETRIC_H

#include "simulate/eye.h"

#include <placido/psf.h>
#include <placido/surface.h>

/* Traces the pupil and fills psf->n, values, bucket sizes, centre, rays and shares. Everything in
 * `eye` and `optics` is settled; the middle bucket is about fixation_mm on the retina. Free with
 * placido_psf_free, whatever the status: PLACIDO_OK, PLACIDO_QUALITY (no light lands within the
 * PSF), PLACIDO_MEMORY. */
int placido_geometric_fill(placido_psf *psf, const placido_surface *surface,
                           const placido_apex *apex, const placido_eye *eye,
                           const placido_optics *optics, const double fixation_mm[2],
                           placido_error *err);

#endif
