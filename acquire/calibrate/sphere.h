/* How far a camera ray, mirrored by a ball, passes from a mire's edge, with its derivatives by
 * everything that a calibration looks for. */
#ifndef PLACIDO_CALIBRATE_SPHERE_H
#define PLACIDO_CALIBRATE_SPHERE_H

#include <placido/instrument.h>
#include <stdbool.h>

/* F = (radius at which the mirrored ray crosses the edge's plane - radius of the edge) * r_z, with
 * r the mirrored ray, and F's derivatives by ray, ball and edge. */
typedef struct placido_sphere_miss {
  double f;
  double by_origin[3], by_direction[3]; /* of the camera ray */
  double by_centre[3], by_radius;       /* of the ball, centre held */
  double by_edge_radius, by_edge_z;
} placido_sphere_miss;

/* False, with everything zero, where the ray passes the ball. The direction need not be
 * normalised. */
bool placido_sphere_miss_at(placido_sphere_miss *miss, const double origin[3],
                            const double direction[3], const double centre[3], double radius_mm,
                            const placido_edge *edge);

#endif
