/* The mires' edges along every meridian, from the innermost outwards. */
#ifndef PLACIDO_GUIDE_WALK_H
#define PLACIDO_GUIDE_WALK_H

#include "acquire/guide/inner.h"

/* What is seen of the mires. Tables have PLACIDO_GUIDE_MERIDIANS rows of edge_count. */
typedef struct placido_guide_walk {
  int edge_count;
  const double *expected_px; /* on an ordinary cornea; borrowed */
  bool first_bright;         /* the band behind the first edge */
  float *radius_px;          /* NaN where no edge was seen */
  bool *wavers;              /* lies off its neighbours along the mire */
  int *numbered;             /* a row each: so many edges, from the first, have a sure number */
  double inner;              /* share of the innermost edges that are seen */
  double roughness;          /* usual distance of an edge from its neighbours' mean, in gaps */
  double coverage, upper, lower; /* shares of the area; of the picture's upper and lower half */
  double break_up;
} placido_guide_walk;

/* Follows the edges of `polar` (filled about inner->centre_px) and sums up. */
void placido_guide_walk_run(placido_guide_walk *walk, const placido_guide_polar *polar,
                            const placido_guide_inner *inner);

#endif
