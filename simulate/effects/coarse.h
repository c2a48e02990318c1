/* The coarse picture among a scene's facts, by the area of its cells. */
#ifndef PLACIDO_SIMULATE_COARSE_H
#define PLACIDO_SIMULATE_COARSE_H

#include "simulate/effects/facts.h"

/* How much of the cell is picture, 0 to 1: the last column and row may stick out. */
double placido_coarse_area(const placido_facts *facts, const placido_scene *scene, int column,
                           int row);

/* Mean luminance of the picture, its bleed included, relative to white. */
double placido_coarse_mean(const placido_facts *facts, const placido_scene *scene);

#endif
