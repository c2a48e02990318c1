/* A surface as it stands in memory: for what makes, asks and saves it. */
#ifndef PLACIDO_SURFACE_SURFACE_H
#define PLACIDO_SURFACE_SURFACE_H

#include "reconstruct/surface/part.h"

#define PLACIDO_SURFACE_PARTS_MAX 256
#define PLACIDO_SURFACE_RADIUS_MAX_MM 20.0
#define PLACIDO_SURFACE_EDGE_MM 1e-12 /* a point this far outside the radius still lies within */

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

/* A copy whose last B-spline has its coefficients moved by change_mm, of sag, as many as it has.
 * Free with placido_surface_free. PLACIDO_INPUT where there is no B-spline. */
int placido_surface_bend(placido_surface **bent, const placido_surface *surface,
                         const double *change_mm, placido_error *err);

#endif
