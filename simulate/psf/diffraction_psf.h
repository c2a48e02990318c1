/* The point spread function by diffraction, in the frame and buckets of the geometric one. */
#ifndef PLACIDO_SIMULATE_PSF_DIFFRACTION_PSF_H
#define PLACIDO_SIMULATE_PSF_DIFFRACTION_PSF_H

#include "simulate/eye.h"

#include <placido/diffraction.h>
#include <placido/psf.h>
#include <placido/surface.h>
#include <stdbool.h>

/* As placido_geometric_fill, with light of optics->wavelength_nm. The PSF grows for rays alone: the
 * faint rings of diffraction go on without end. Returns PLACIDO_QUALITY, too, where the wavefront
 * is too steep to be sampled. */
int placido_diffraction_fill(placido_psf *psf, const placido_surface *surface,
                             const placido_apex *apex, const placido_eye *eye,
                             const placido_optics *optics, const double fixation_mm[2],
                             placido_error *err);

/* Whether a sample lies within the pupil. */
bool placido_pupil_lit(const placido_pupil *pupil, int column, int row);

/* Counts the pupil's samples as rays: psf->rays, rays_entered, rays_landed (all that entered) and
 * rays_missed. */
void placido_psf_count_samples(placido_psf *psf, const placido_pupil *pupil);

/* Fills psf->outside and strehl_g from its values. */
void placido_psf_summarise(placido_psf *psf);

#endif
