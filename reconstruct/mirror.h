/* How far a camera ray, mirrored by the cornea, passes from a mire's edge: the one equation of the
 * reconstruction, with its derivatives. Free of the azimuth, so skew rays are exact
 * (Klein, Optom. Vis. Sci. 74:945, 1997). */
#ifndef PLACIDO_RECONSTRUCT_MIRROR_H
#define PLACIDO_RECONSTRUCT_MIRROR_H

#include "reconstruct/camera.h"

#include <placido/instrument.h>
#include <placido/surface.h>

/* Where a ray meets the surface z = z(x, y): the point and z's jet there (derivatives of z, not of
 * the sag). */
typedef struct placido_hit {
  double x, y, z;
  double p, q;        /* dz/dx, dz/dy */
  double xx, xy, yy;  /* second derivatives of z */
} placido_hit;

/* F = (radius at which the mirrored ray crosses the edge's plane - radius of the edge) * r_z, and
 * what the fit needs of it: dF = by_z dz + by_p dp + by_q dq for a change of the surface under the
 * fixed camera ray (the point slides along the ray), F's gradient in the image, and what it changes
 * by with the edge. */
typedef struct placido_miss {
  double f;
  double by_z, by_p, by_q;
  double by_u, by_v; /* per pixel */
  double by_radius, by_height; /* per mm of the edge's radius and z */
} placido_miss;

placido_miss placido_mirror_miss(const placido_ray *ray, const placido_hit *hit,
                                 const placido_edge *edge);

#endif
