/* What the rings of a topographer's export give beside heights. */
#ifndef PLACIDO_EXCHANGE_RINGS_H
#define PLACIDO_EXCHANGE_RINGS_H

#include <placido/elevation.h>
#include <placido/index.h>
#include <stdbool.h>

/* The complete rings from the inside, for placido_indices_of_rings: none where the file has no
 * rings of PLACIDO_MIRE_RING_POINTS points. */
void placido_elevation_rings(placido_mire_rings *rings, const placido_elevation *elevation);

/* Keratometry of a surface on the file's rings, by its maker's rule; axes 0 to 180, NaN without
 * cylinder. */
typedef struct placido_ring_simk {
  double flat_D, flat_axis_deg, steep_D, steep_axis_deg;
} placido_ring_simk;

/* False, and all NaN, where the file has not the rings for it. */
bool placido_elevation_simk(placido_ring_simk *simk, const placido_elevation *elevation,
                            const placido_surface *surface);

#endif
