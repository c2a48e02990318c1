/* The optics and the neural filter as one autocorrelation: all that an ideal observer in white
 * noise needs to know of them. */
#ifndef PLACIDO_SIMULATE_ACUITY_LAGS_H
#define PLACIDO_SIMULATE_ACUITY_LAGS_H

#include <placido/psf.h>

/* Values at shifts of whole buckets, columns and rows of the transform's grid, which wraps. */
typedef struct placido_lags {
  int columns, rows;
  size_t stride;
  double step_arcmin;
  float *values;     /* per degree to the fourth, gain squared */
  double lost;       /* share of the light outside the PSF's window */
  double window_arcmin;
} placido_lags;

/* Free with placido_lags_free. PLACIDO_OK, PLACIDO_INPUT (not a PSF), PLACIDO_MEMORY. */
int placido_lags_new(placido_lags *lags, const placido_psf *psf, placido_error *err);
void placido_lags_free(placido_lags *lags);

/* PLACIDO_OK, or PLACIDO_INPUT with what makes it no PSF. */
int placido_psf_check(const placido_psf *psf, placido_error *err);

#endif
