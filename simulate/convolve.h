/* An image spread by a point spread function. */
#ifndef PLACIDO_SIMULATE_CONVOLVE_H
#define PLACIDO_SIMULATE_CONVOLVE_H

#include <placido/convolution.h>
#include <placido/image.h>
#include <placido/notes.h>
#include <placido/psf.h>
#include <placido/status.h>

/* target(x, y) = sum over buckets of psf(column, row) × source(x - (column - h), y - (row - h)),
 * h the PSF's middle; source is 0 beyond its rim. Planes 0, 1 and 2 alike; a fourth plane, alpha,
 * is copied. `target` has the size of `source`. A PSF with all its light in one bucket needs no
 * transform: then the result is the shifted image times that value, exact to the last bit.
 * `how` and `notes` may be NULL. Returns PLACIDO_OK, PLACIDO_INPUT, PLACIDO_MEMORY. */
int placido_convolve_as(placido_image *target, const placido_image *source, const placido_psf *psf,
                        const placido_convolution *how, placido_notes *notes, placido_error *err);

/* The same in the usual way. */
int placido_convolve(placido_image *target, const placido_image *source, const placido_psf *psf,
                     int threads, placido_error *err);

#endif
