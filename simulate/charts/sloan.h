/* The ten letters of Louise Sloan as outlines. */
#ifndef PLACIDO_SIMULATE_SLOAN_H
#define PLACIDO_SIMULATE_SLOAN_H

#include "simulate/charts/outline.h"

#include <stdbool.h>

#define PLACIDO_SLOAN_LETTERS 10

/* Adds letter `which` of "CDHKNORSVZ" to a shape whose unit is the stroke and whose (0, 0) is the
 * middle of the letter's square of 5 by 5. */
void placido_sloan_outline(placido_outline *outline, int which);

/* A ring 5 wide outside and 3 inside; with a gap 1 wide on the right it is the Landolt C. */
void placido_ring_outline(placido_outline *outline, bool gap);

#endif
