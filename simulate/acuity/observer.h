/* The observer before a chart: what the letters have in common with each other, and the noise. */
#ifndef PLACIDO_SIMULATE_ACUITY_OBSERVER_H
#define PLACIDO_SIMULATE_ACUITY_OBSERVER_H

#include "simulate/acuity/lags.h"

#include <placido/acuity.h>

#define PLACIDO_CHOICES_MAX 10
#define PLACIDO_LETTER_PX 60 /* a dozen to the stroke; edges of an E fall between pixels */
#define PLACIDO_SHIFTS (2 * PLACIDO_LETTER_PX + 1)

/* Inner products of all pairs of letters. */
typedef struct placido_gram {
  double values[PLACIDO_CHOICES_MAX][PLACIDO_CHOICES_MAX];
} placido_gram;

struct placido_observer {
  const placido_acuity_test *test;
  placido_acuity_options options; /* settled */
  int choices, pairs;
  float *correlations; /* of each pair (i, j <= i) at shifts of 0 .. LETTER_PX rows and
                          -LETTER_PX .. LETTER_PX columns of pixels; pairs innermost */
  double *draws;       /* options.trials rows of `choices` standard normal numbers */
};

#define PLACIDO_TAPS 8 /* of the interpolation between buckets, to either side */
#define PLACIDO_REACH (PLACIDO_LETTER_PX + PLACIDO_TAPS)
#define PLACIDO_KNOWN (2 * PLACIDO_REACH + 1)

/* Room to work in. */
typedef struct placido_sight {
  double nodes[PLACIDO_LETTER_PX + 1][PLACIDO_SHIFTS]; /* at shifts of a letter's pixels */
  double weights[PLACIDO_SHIFTS][PLACIDO_KNOWN];
  double rows[PLACIDO_LETTER_PX + 1][PLACIDO_KNOWN];
} placido_sight;

/* How alike the letters of this stroke are when seen: contrast times gain, squared, times square
 * degrees. */
void placido_observer_look(placido_gram *gram, const placido_observer *observer,
                           const placido_lags *lags, double stroke_arcmin, placido_sight *sight);

/* Share of right answers with `noise_factor` times all the observer's noise; `sigma` (may be NULL):
 * its standard deviation from the finite number of trials. */
double placido_observer_score(const placido_observer *observer, const placido_gram *gram,
                              double noise_factor, double *sigma);

#endif
