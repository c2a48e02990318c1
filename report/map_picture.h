/* The round map as such: what every map figure shows, whatever quantity it is of. */
#ifndef PLACIDO_REPORT_MAP_PICTURE_H
#define PLACIDO_REPORT_MAP_PICTURE_H

#include "report/scale.h"

/* What one map figure shows; everything borrowed. */
typedef struct placido_map_picture {
  const placido_maps *maps;
  const double *values; /* one of the arrays of `maps` */
  const char *title, *unit, *note;
  placido_scale scale;
  const char *second_note; /* NULL: none */
  double hole_mm;          /* radius about the axis where the map is not defined; 0: none */
  const double *sigmas;    /* hatched where the value is less than twice its sigma; NULL: nowhere */
} placido_map_picture;

/* Draws the map, its frame, legend and title, and writes the PNG of 900 × 760 px. */
int placido_map_picture_write(const placido_map_picture *picture, const char *path,
                              placido_error *err);

#endif
