/* The values of the kinds of map at a point; listed in table.c, described there. */
#ifndef PLACIDO_MAPS_KINDS_H
#define PLACIDO_MAPS_KINDS_H

#include <placido/map.h>

/* Keratometric constant: 1000 (1.3375 - 1), dioptres times mm. */
#define PLACIDO_KERATOMETRIC 337.5

double placido_map_elevation(const placido_map_point *point);
double placido_map_axial(const placido_map_point *point);
double placido_map_tangential(const placido_map_point *point);
double placido_map_mean(const placido_map_point *point);
double placido_map_gaussian(const placido_map_point *point);
double placido_map_refractive(const placido_map_point *point);
double placido_map_elevation_conic(const placido_map_point *point);
double placido_map_elevation_toric(const placido_map_point *point);
double placido_map_axial_vertex(const placido_map_point *point);
double placido_map_tangential_vertex(const placido_map_point *point);
double placido_map_axial_refractive(const placido_map_point *point);
double placido_map_instantaneous_refractive(const placido_map_point *point);
double placido_map_focusing_distance(const placido_map_point *point);
double placido_map_retinal_distance(const placido_map_point *point);

#endif
