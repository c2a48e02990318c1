/* The point spread function by diffraction, in the frame and buckets of the geometric one. */
#ifndef PLACIDO_SIMULATE_PSF_DIFFRACTION_PSF_H
#define PLACIDO_SIMULATE_PSF_DIFFRACTION_PSF_H

#include "simulate/eye.h"

#include <placido/psf.h>
#include <placido/surface.h>

/* As placido_geometric_fill, with light of optics->wavelength_nm. The PSF grows for rays alone: the
 * faint rings of diffraction go on without end. Returns PLACIDO_QUALITY, too, where the wavefront
 * is too steep to be sampled. */
int placido_diffraction_fill(placido_psf *psf, const placido_surface *surface,
                             const placido_apex *apex, const placido_eye *eye,
                             const placido_optics *optics, const double fixation_mm[2],
                             placido_error *err);

#endif
