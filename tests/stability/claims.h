/* What an examination claims of its own errors, and what these are: for each quantity the error
 * against the true cornea over the standard deviation that stands beside it. */
#ifndef PLACIDO_TESTS_STABILITY_CLAIMS_H
#define PLACIDO_TESTS_STABILITY_CLAIMS_H

#include <placido/reconstruct.h>
#include <stdint.h>

enum claim {
  CLAIM_ELEVATION, /* um, on the map */
  CLAIM_AXIAL,     /* D, on the map */
  CLAIM_K1,        /* simk_flat_D */
  CLAIM_K2,        /* simk_steep_D */
  CLAIM_TERMS_3,   /* um, all terms of order 2 to 8 of the wavefront of 3 mm */
  CLAIM_TERMS_6,   /* the same of 6 mm */
  CLAIM_STREHL_3,  /* strehl_555nm of that wavefront */
  CLAIM_STREHL_6,
  CLAIM_STREHL_G,  /* of the point spread function */
  CLAIM_LOGMAR,   /* by sigma_optics and sigma_trials; people differ by sigma_observer beyond that,
                     which is no error of the eye */
  CLAIMS
};

/* One quantity of one eye. Where it has several values all are means of them; NaN: none. */
struct claim_result {
  double square;  /* of error over sigma */
  double within;  /* share within 1 sigma */
  double error, sigma; /* root mean squares */
};

const char *claim_name(enum claim claim);
const char *claim_unit(enum claim claim);

/* Holds a fit against the truth; pupil_mm is that of the point spread function, and the observer's
 * trials come from the seed: the same ones would err alike in all eyes. The truth has other trials,
 * and more of them. */
void claims_find(struct claim_result results[CLAIMS], const placido_fit *fit,
                 const placido_surface *truth, double pupil_mm, uint64_t seed);

#endif
