/* Point spread functions of known wavefronts, for tests of what is made of them. */
#ifndef PLACIDO_TESTS_SIMULATE_ABERRATED_H
#define PLACIDO_TESTS_SIMULATE_ABERRATED_H

#include <placido/diffraction.h>
#include <placido/psf.h>

/* Diffraction at 555 nm of `count` Zernike terms (OSA, micrometres) and this blur over a pupil, 257
 * buckets of half a minute; free with placido_psf_free. */
placido_psf aberrated(double pupil_mm, const double *terms_um, int count, double m_D, double j0_D);

/* The same of an eye with the mean higher orders of its pupil, 3 to 4 mm: 0.045, 0.07 and 0.10 µm
 * rms at 3, 3.5 and 4 mm; coma, trefoil and spherical aberration have most of it. */
placido_psf normal_eye(double pupil_mm, double m_D, double j0_D);

/* An empty PSF of n * n buckets, and light in one of them. */
placido_psf dark(int n, double bucket_arcmin);
void put_spot(placido_psf *psf, double x_arcmin, double y_arcmin, double light);

/* The geometric blur disc of a perfect eye: light 1, sharp edge to the area. */
placido_psf blur_disc(double radius_arcmin);

#endif
