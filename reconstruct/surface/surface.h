/* A surface as it stands in memory: for what makes, asks and saves it. */
#ifndef PLACIDO_SURFACE_SURFACE_H
#define PLACIDO_SURFACE_SURFACE_H

#include "reconstruct/surface/part.h"

#define PLACIDO_SURFACE_PARTS_MAX 256
#define PLACIDO_SURFACE_RADIUS_MAX_MM 20.0

typedef struct placido_surface_term {
  placido_part part; /* its arrays belong to `state` */
  const placido_part_row *row;
  void *state;
} placido_surface_term;

struct placido_surface {
  double vertex_z_mm, radius_mm;
  size_t term_count;
  placido_surface_term *terms;
  bool has_coverage;
  placido_coverage coverage;
  unsigned char *mask; /* of the coverage */
};

#endif
