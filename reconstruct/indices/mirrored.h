/* Mires on the cornea: the forward model of the topographer on a surface. */
#ifndef PLACIDO_INDICES_MIRRORED_H
#define PLACIDO_INDICES_MIRRORED_H

#include "reconstruct/indices/layout.h"

#include <placido/index.h>

/* Both edges of the mires on a surface: distances from the vertex in every direction, and how the
 * equation of the edge there changes by mm of that distance. */
typedef struct placido_mirrored {
  int count;      /* mires */
  int first_edge; /* mire k lies between the edges first_edge + 2k and the next */
  placido_vertex vertex;
  double r_mm[2 * PLACIDO_MIRE_RINGS_MAX][PLACIDO_MIRE_RING_POINTS];
  double slope[2 * PLACIDO_MIRE_RINGS_MAX][PLACIDO_MIRE_RING_POINTS];
} placido_mirrored;

void placido_mirrored_find(placido_mirrored *mirrored, const placido_surface *surface,
                           const placido_mires *mires, const placido_instrument *instrument);

/* The mires as polygons of every `stride`-th direction. On a variant of the surface that `mirrored`
 * was made for, they lie one Newton step away: a step of a micrometre is exact to its square. NULL
 * for `variant`: on that surface itself. The polygons stand in every `stride`-th point. */
void placido_mirrored_rings(placido_mire_rings *rings, const placido_mirrored *mirrored,
                            const placido_surface *variant, const placido_instrument *instrument,
                            int stride);

#endif
