/* How a pupil is filled with rays, run by run: a row of the crosshatch, or a piece of a pattern
 * without rows. */
#ifndef PLACIDO_SIMULATE_RAYS_PATTERN_H
#define PLACIDO_SIMULATE_RAYS_PATTERN_H

#include "simulate/rays/crosshatch.h"

#include <placido/psf.h>

typedef struct placido_pattern {
  enum placido_pattern_kind kind;
  placido_crosshatch crosshatch;
  double radius_mm, x_mm, y_mm; /* of the pupil */
  long total;                   /* rays as asked for: of the crosshatch over the pupil's square */
  long runs;
  int run_max;                  /* rays of the longest run */
} placido_pattern;

/* `rays` of 1 or more; of the crosshatch the least that has so many. */
placido_pattern placido_pattern_of(const placido_eye *eye, enum placido_pattern_kind kind,
                                   long rays);

/* How many rays of run `run` are inside the pupil. */
int placido_pattern_count(const placido_pattern *pattern, long run);

/* Their places and their shares of the pupil's area (weight may be NULL); returns how many they
 * are. */
int placido_pattern_run(const placido_pattern *pattern, long run, double *x_mm, double *y_mm,
                        double *weight);

#endif
