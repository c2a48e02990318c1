/* The mirrored ray's miss of an edge, regular where the ray runs parallel to the edge's plane. */
#include "reconstruct/mirror_inside.h"

placido_miss placido_mirror_miss(const placido_ray *ray, const placido_hit *hit,
                                 const placido_edge *edge) {
  placido_miss miss;
  placido_mirror_miss_inside(&miss, ray, hit, edge->radius_mm, edge->z_mm);
  return miss;
}
