/* How far away the cornea is, from the sizes of all mires together. */
#ifndef PLACIDO_GUIDE_FOCUS_H
#define PLACIDO_GUIDE_FOCUS_H

#include "acquire/guide/walk.h"

#include <placido/instrument.h>

/* What the sizes depend on: first order about an ordinary cornea. */
typedef struct placido_guide_focus {
  int edge_count;
  bool can_tell; /* the mires stand at heights different enough */
  double expected_px[PLACIDO_EDGES_MAX];
  double slope_px[3][PLACIDO_EDGES_MAX]; /* by radius (mm), asphericity, z (mm) */
} placido_guide_focus;

/* Edges from 0 to edge_count - 1 must be seen by an ordinary cornea. */
void placido_guide_focus_prepare(placido_guide_focus *focus, const placido_instrument *instrument,
                                 int edge_count);

/* z of the cornea, + towards the camera; NaN where the mires do not tell. */
double placido_guide_focus_find(const placido_guide_focus *focus, const placido_guide_walk *walk);

#endif
