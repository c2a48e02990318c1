/* Where a search of the focus sets out. */
#ifndef PLACIDO_SIMULATE_FOCUS_STARTS_H
#define PLACIDO_SIMULATE_FOCUS_STARTS_H

#include "simulate/focus_climb.h"

enum { PLACIDO_FOCUS_KEPT = 4 };

/* The best places that the search finds with the pencil's rays, which stand about the lens of
 * `refraction`, the best first; returns how many. */
int placido_focus_starts(placido_climb *climb, const placido_aim *refraction,
                         placido_trial kept[PLACIDO_FOCUS_KEPT]);

#endif
