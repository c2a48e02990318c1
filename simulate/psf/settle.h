/* The eye's focus without the image of a point. */
#ifndef PLACIDO_SIMULATE_PSF_SETTLE_H
#define PLACIDO_SIMULATE_PSF_SETTLE_H

#include <placido/psf.h>

/* What is open in `eye`, decided as placido_psf_new decides it, and where on its retina fixation
 * lies; `found->correct` is PLACIDO_CORRECT_NONE. `notes` (may be NULL) is told where the data do
 * not fill the pupil. Errors as placido_psf_new. */
int placido_psf_settle(placido_eye *found, double fixation_mm[2], const placido_surface *surface,
                       const placido_eye *eye, placido_notes *notes, placido_error *err);

#endif
