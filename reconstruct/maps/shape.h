/* The shapes that elevation is measured from, as the fits and the error bars see them. */
#ifndef PLACIDO_MAPS_SHAPE_H
#define PLACIDO_MAPS_SHAPE_H

#include "reconstruct/maps/zone.h"

#include <placido/map.h>

/* A shape's parameters in this order: apex x, y, z; c; p; d; e. */
#define PLACIDO_SHAPE_PARAMETERS 7

/* How many of the parameters, from the first, are free in a reference: 4, 5, 7. */
int placido_shape_free(enum placido_reference reference);

/* z of the shape at (x, y) and, unless NULL, its derivatives by the parameters. NaN where it does
 * not reach. */
double placido_shape_at(const placido_conicoid_shape *shape, double x_mm, double y_mm,
                        double derivatives[PLACIDO_SHAPE_PARAMETERS]);

/* Fits all references to the zone's points. What they do not determine is NaN. */
void placido_shapes_fit(placido_conicoid_shape shapes[PLACIDO_REFERENCES], placido_sphere *sphere,
                        const placido_zone *zone);

/* Weight of a point of the zone in the fit of a reference, of its squared error in z. */
double placido_shape_weight(enum placido_reference reference, const placido_conicoid_shape *shape,
                            double x_mm, double y_mm);

#endif
