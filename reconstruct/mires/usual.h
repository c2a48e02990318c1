/* What is usual about an edge: means over the meridians beside it. */
#ifndef PLACIDO_MIRES_USUAL_H
#define PLACIDO_MIRES_USUAL_H

#include "reconstruct/mires/tracks.h"

/* A step that was fitted to a crossing's profile. */
typedef struct placido_fitted {
  double place_px;
  float offset, height, width; /* in units of the profile and px; the height is signed */
  float squares, freedom;      /* sum of squared residuals, its degrees of freedom (0: unfitted) */
  float spread;                /* variance of the place for samples of variance 1, px² */
  float bend;                  /* of the background, a px² */
  bool good;
} placido_fitted;

/* Means over the good fits of an edge on nearby meridians; NaN where there are none. */
typedef struct placido_usual {
  float offset, height, width; /* the height is without sign */
  float variance;              /* of a sample */
} placido_usual;

/* Fills `usual`, one a crossing, for all crossings that have a number; of the others each is usual
 * in itself. `fitted` has one fit a crossing. */
void placido_usual_find(placido_usual *usual, const placido_crossings *crossings,
                        const placido_tracks *tracks, const placido_fitted *fitted);

#endif
