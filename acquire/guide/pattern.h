/* How the innermost mires look along a radius, for a row of blurs. */
#ifndef PLACIDO_GUIDE_PATTERN_H
#define PLACIDO_GUIDE_PATTERN_H

#include <stdbool.h>

#define PLACIDO_GUIDE_PATTERN_EDGES 8
#define PLACIDO_GUIDE_BLURS 19
#define PLACIDO_GUIDE_PATTERN_SAMPLES 1024

/* How the mires look on an ordinary cornea, as light from 0 to 1 over the radius in pixels, for a
 * row of blurs. Sharp enough a grid for linear interpolation. */
typedef struct placido_guide_pattern {
  double step_px, low_px, high_px; /* the part that is compared */
  double gap_px;                   /* mean distance of two edges */
  double middle_px;                /* of the compared edges */
  double inner_px;                 /* the innermost edge */
  int count;
  double blur_px[PLACIDO_GUIDE_BLURS];
  float light[PLACIDO_GUIDE_BLURS][PLACIDO_GUIDE_PATTERN_SAMPLES];
} placido_guide_pattern;

/* `edges_px` grow; there are `count`, at least 4. `first_bright`: of the band behind the first. */
void placido_guide_pattern_make(placido_guide_pattern *pattern, const double *edges_px, int count,
                                bool first_bright);

#define PLACIDO_GUIDE_PROFILE_MAX 1024

/* Grey levels from 0 to 1 over the radius; negative where there is no picture. */
typedef struct placido_guide_profile {
  int count;
  double step_px;
  float grey[PLACIDO_GUIDE_PROFILE_MAX];
} placido_guide_profile;

/* What of the pattern is tried: r = scale × (radius in the pattern) + shift_px, at a blur. */
typedef struct placido_guide_trial {
  double scale, shift_px;
  int blur; /* index of the row */
} placido_guide_trial;

/* How a trial agrees: correlation, -1..1, and the mires' height in the profile. */
typedef struct placido_guide_match {
  double likeness, contrast;
} placido_guide_match;

placido_guide_match placido_guide_compare(const placido_guide_profile *profile,
                                          const placido_guide_pattern *pattern,
                                          const placido_guide_trial *trial);

/* A sample of the picture at a radius of the pattern, in steps of its step_px. */
typedef struct placido_guide_sample {
  float place, grey;
} placido_guide_sample;

/* The blur at which the samples agree best with the pattern, interpolated between rows, in the
 * pattern's px. NaN where they show none. */
double placido_guide_pattern_blur(const placido_guide_pattern *pattern,
                                  const placido_guide_sample *samples, int count);

#endif
