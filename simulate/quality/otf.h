/* The optical transfer function of a PSF, at any frequency. */
#ifndef PLACIDO_SIMULATE_QUALITY_OTF_H
#define PLACIDO_SIMULATE_QUALITY_OTF_H

#include <placido/psf.h>

/* Its samples on a lattice, those of positive horizontal frequency. */
typedef struct placido_otf {
  int side;           /* samples of a period */
  int stride;         /* complex numbers from row to row: columns 0 to side / 2 */
  double step_cpd;    /* between samples */
  double bucket_deg;
  float *values;      /* real, imaginary; the one at frequency 0 is 1 */
} placido_otf;

/* Frequencies as the patient sees them, x right and y up; phases about the middle bucket. Free with
 * placido_otf_free. PLACIDO_OK, PLACIDO_QUALITY (no light), PLACIDO_MEMORY. */
int placido_otf_new(placido_otf *otf, const placido_psf *psf, placido_error *err);
void placido_otf_free(placido_otf *otf);

/* Below half a cycle a bucket; what the bucket's width takes from it is given back. */
void placido_otf_at(const placido_otf *otf, double x_cpd, double y_cpd, double *real,
                    double *imaginary);

#endif
