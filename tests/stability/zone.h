/* A surface over its central zone, as results see it: heights against their mean, and axial power.
 */
#ifndef PLACIDO_TESTS_STABILITY_ZONE_H
#define PLACIDO_TESTS_STABILITY_ZONE_H

#include <placido/surface.h>

#define ZONE_MM 6.0  /* diameter */
#define LEVEL_MM 3.0 /* of the part whose mean height is 0 */
#define ZONE_STEP_MM 0.25
#define ZONE_HALF 12
#define ZONE_PLACES ((2 * ZONE_HALF + 1) * (2 * ZONE_HALF + 1))

struct zone {
  double height_um[ZONE_PLACES],
      axial_D[ZONE_PLACES]; /* NaN outside; axial power on the axis, too */
  double level_um;          /* the mean height */
};

/* Looks at place (x, y) where the surface has turn · (x, y), a symmetry of the grid (NULL: none).
 * The surface must be defined all over the zone. */
void zone_see(struct zone *zone, const placido_surface *surface, const double turn[2][2]);

/* Root mean square of a - b where neither is NaN. */
double zone_difference(const double *a, const double *b);

#endif
