/* The mirror's equation itself, for loops that take many rays at a time. */
#ifndef PLACIDO_RECONSTRUCT_MIRROR_INSIDE_H
#define PLACIDO_RECONSTRUCT_MIRROR_INSIDE_H

#include "reconstruct/mirror.h"
#include "reconstruct/vector.h"

#include <math.h>

/* So little changes no number, but keeps 0 / 0 away where a ray comes back along the axis. */
#define PLACIDO_MIRROR_TINY 1e-300

/* What moving the image point needs of the mirror: F's derivatives by the point, by the mirrored
 * ray, and the surface there. */
typedef struct placido_mirror_slopes {
  double by_x, by_y, by_point_z, by_rx, by_ry, by_rz;
  double t, descent, n2;
} placido_mirror_slopes;

/* Moving the image point: origin and direction change, the hit slides on the surface. */
PLACIDO_INSIDE double placido_mirror_by_image(const placido_mirror_slopes *m,
                                              const placido_miss *miss, const placido_hit *hit,
                                              const double d[3], const double origin[3],
                                              const double direction[3]) {
  double p = hit->p, q = hit->q;
  double ex = origin[0] + m->t * direction[0], ey = origin[1] + m->t * direction[1];
  double ez = origin[2] + m->t * direction[2];
  double dt = (p * ex + q * ey - ez) / m->descent;
  double mx = ex + dt * d[0], my = ey + dt * d[1], mz = ez + dt * d[2];
  double dg = 2 * (direction[2] - p * direction[0] - q * direction[1]) / m->n2;
  return m->by_x * mx + m->by_y * my + m->by_point_z * mz +
         miss->by_p * (hit->xx * mx + hit->xy * my) + miss->by_q * (hit->xy * mx + hit->yy * my) +
         m->by_rx * (direction[0] + dg * p) + m->by_ry * (direction[1] + dg * q) +
         m->by_rz * (direction[2] - dg);
}

/* As placido_mirror_miss. */
PLACIDO_INSIDE void placido_mirror_miss_inside(placido_miss *miss, const placido_ray *ray,
                                               const placido_hit *hit, double edge_radius_mm,
                                               double edge_z_mm) {
  const double *d = ray->direction;
  double p = hit->p, q = hit->q;
  double n2 = 1 + p * p + q * q;
  double g = 2 * (d[2] - p * d[0] - q * d[1]) / n2; /* mirrored ray r = d - g (-p, -q, 1) */
  double rx = d[0] + g * p, ry = d[1] + g * q, rz = d[2] - g;
  double h = edge_z_mm - hit->z;
  double gx = hit->x * rz + h * rx, gy = hit->y * rz + h * ry;
  double rho = sqrt(gx * gx + gy * gy + PLACIDO_MIRROR_TINY);
  double cx = gx / rho, cy = gy / rho;
  miss->f = rho - edge_radius_mm * rz;

  /* by the point, and by the mirrored ray */
  placido_mirror_slopes m = {.by_x = cx * rz,
                             .by_y = cy * rz,
                             .by_point_z = -(cx * rx + cy * ry),
                             .by_rx = h * cx,
                             .by_ry = h * cy,
                             .by_rz = cx * hit->x + cy * hit->y - edge_radius_mm,
                             .t = (ray->origin[2] - hit->z) / -d[2],
                             .descent = d[2] - p * d[0] - q * d[1],
                             .n2 = n2};
  miss->by_radius = -rz;
  miss->by_height = -m.by_point_z;
  double gp = (-2 * d[0] - 2 * p * g) / n2, gq = (-2 * d[1] - 2 * q * g) / n2;
  miss->by_p = m.by_rx * (g + p * gp) + m.by_ry * q * gp - m.by_rz * gp;
  miss->by_q = m.by_rx * p * gq + m.by_ry * (g + q * gq) - m.by_rz * gq;

  /* moving the point along the ray by d */
  double along = m.by_x * d[0] + m.by_y * d[1] + m.by_point_z * d[2] +
                 miss->by_p * (hit->xx * d[0] + hit->xy * d[1]) +
                 miss->by_q * (hit->xy * d[0] + hit->yy * d[1]);
  miss->by_z = along / m.descent;
  miss->by_u = placido_mirror_by_image(&m, miss, hit, d, ray->origin_u, ray->direction_u);
  miss->by_v = placido_mirror_by_image(&m, miss, hit, d, ray->origin_v, ray->direction_v);
}

#endif
