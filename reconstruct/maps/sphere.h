/* The best-fit sphere. */
#ifndef PLACIDO_MAPS_SPHERE_H
#define PLACIDO_MAPS_SPHERE_H

#include "reconstruct/maps/zone.h"

#include <placido/map.h>

#define PLACIDO_SPHERE_ZONE_MM 8.0

/* The sphere nearest to the zone's points, radius and centre free; all NaN but for zone_mm where
 * the points determine none. */
placido_sphere placido_sphere_fit(const placido_zone *zone);

#endif
