/* The supported points of a round zone about the axis, for fits of simple shapes. */
#ifndef PLACIDO_MAPS_ZONE_H
#define PLACIDO_MAPS_ZONE_H

#include <placido/surface.h>

typedef struct placido_zone {
  double diameter_mm;    /* no wider than the surface */
  size_t count, sampled; /* points with data; points of the whole zone */
  double (*points)[3];   /* x, y, z, mm */
} placido_zone;

/* Takes the points of a 0.1 mm grid. Free with placido_zone_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_zone_new(placido_zone *zone, const placido_surface *surface, double diameter_mm,
                     placido_error *err);
void placido_zone_free(placido_zone *zone);

#endif
