/* Surfaces for tests of maps and indices; each fails the test where it cannot be made. */
#ifndef PLACIDO_TESTS_MAPS_EYES_H
#define PLACIDO_TESTS_MAPS_EYES_H

#include <placido/map.h>

/* A surface of 4.5 mm radius, vertex at z = 0. */
placido_surface *eye_of(const placido_part *parts, size_t count);

/* A conicoid with its apex at (x, y). */
placido_surface *conicoid_eye(double radius_mm, double q, double x_mm, double y_mm);

/* A sphere supported where column i (x = -4.5 + i * 0.5) has supported[i] != 0. */
placido_surface *partly_covered_eye(double radius_mm, const unsigned char supported[19]);

/* The maps on a grid of 0.1 mm. Free with placido_maps_free. */
placido_maps maps_of(const placido_surface *surface);

/* The map called `name` at column i, row j. */
double map_at(const placido_maps *maps, const char *name, int i, int j);

/* Distance of column i, row j from the axis. */
double distance_of(const placido_maps *maps, int i, int j);

#endif
