/* The mires as a body: the surface of revolution through their edges, and which band of it a ray
 * meets. */
#ifndef PLACIDO_PHANTOM_PROFILE_H
#define PLACIDO_PHANTOM_PROFILE_H

#include "phantom/camera.h"

#include <stdbool.h>

/* Edges as a polyline in the half-plane (r, z). Band k lies between edge k and edge k + 1; -1 lies
 * inside edge 0, edge_count - 1 beyond the last one. */
typedef struct placido_phantom_profile {
  const placido_edge *edges; /* borrowed */
  int edge_count;
  bool funnel; /* radius never falls and z never rises from edge to edge */
} placido_phantom_profile;

/* The profile of an instrument, which it borrows. */
placido_phantom_profile placido_phantom_profile_of(const placido_instrument *instrument);

/* The band that a reflected ray meets first. `guess` is the band of a ray nearby: it saves time and
 * never changes the answer. */
int placido_phantom_profile_band(const placido_phantom_profile *profile,
                                 const placido_phantom_ray *ray, int guess);

#endif
