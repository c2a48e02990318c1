/* Places along the meridians where the image turns bright or dark. */
#ifndef PLACIDO_MIRES_EDGES_H
#define PLACIDO_MIRES_EDGES_H

#include "reconstruct/mires/polar.h"

#include <stdbool.h>
#include <stddef.h>

/* One candidate: what may be a mire's edge. */
typedef struct placido_crossing {
  int meridian;
  double radius_px;
  double slope;  /* derivative of the profile along the radius, signed: > 0 turns bright outwards */
  int chain;     /* set by linking; -1: in none */
  int edge;      /* set by numbering; -1: unknown */
  /* set by measuring: step, Gaussian blur, standard deviation, and what the light may add to it */
  double height, width_px, sigma_px, light_px;
  bool doubtful; /* set by the gate: numbered, but its place may be pulled */
  bool folded;   /* set by looking for folds: lies where the cornea seems to fold the mires */
} placido_crossing;

/* All candidates, ordered by meridian, then radius. */
typedef struct placido_crossings {
  int meridians;
  size_t count;
  size_t *first; /* meridians + 1 indices into list */
  placido_crossing *list;
} placido_crossings;

/* Finds the extrema of every profile's derivative that stand out from their neighbourhood.
 * `spacing_px` is the ordinary distance between edges, `reach_px` how far the mires ordinarily
 * reach. Free with placido_crossings_free. */
int placido_crossings_find(placido_crossings *out, const placido_polar *polar, double spacing_px,
                           double reach_px, int threads, placido_error *err);
void placido_crossings_free(placido_crossings *crossings);

/* Measures the numbered candidates: fits a blurred step to the profile about each and moves it to
 * the step's place. What cannot be fitted loses its number. */
int placido_crossings_measure(placido_crossings *crossings, const placido_polar *polar,
                              int threads, placido_error *err);

#endif
