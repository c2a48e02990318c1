/* The mirrored ray's miss of an edge, regular where the ray runs parallel to the edge's plane. */
#include "reconstruct/mirror.h"

#include <math.h>

placido_miss placido_mirror_miss(const placido_ray *ray, const placido_hit *hit,
                                 const placido_edge *edge) {
  const double *d = ray->direction;
  double p = hit->p, q = hit->q;
  double n2 = 1 + p * p + q * q;
  double g = 2 * (d[2] - p * d[0] - q * d[1]) / n2; /* mirrored ray r = d - g (-p, -q, 1) */
  double rx = d[0] + g * p, ry = d[1] + g * q, rz = d[2] - g;
  double h = edge->z_mm - hit->z;
  double gx = hit->x * rz + h * rx, gy = hit->y * rz + h * ry;
  double rho = sqrt(gx * gx + gy * gy);
  double cx = rho > 0 ? gx / rho : 0, cy = rho > 0 ? gy / rho : 0;
  placido_miss miss = {.f = rho - edge->radius_mm * rz};

  /* by the point, and by the mirrored ray */
  double by_x = cx * rz, by_y = cy * rz, by_point_z = -(cx * rx + cy * ry);
  double by_rx = h * cx, by_ry = h * cy;
  double by_rz = cx * hit->x + cy * hit->y - edge->radius_mm;
  miss.by_radius = -rz;
  miss.by_height = -by_point_z;
  double gp = (-2 * d[0] - 2 * p * g) / n2, gq = (-2 * d[1] - 2 * q * g) / n2;
  miss.by_p = by_rx * (g + p * gp) + by_ry * q * gp - by_rz * gp;
  miss.by_q = by_rx * p * gq + by_ry * (g + q * gq) - by_rz * gq;

  /* moving the point along the ray by d */
  double descent = d[2] - p * d[0] - q * d[1];
  double along = by_x * d[0] + by_y * d[1] + by_point_z * d[2] +
                 miss.by_p * (hit->xx * d[0] + hit->xy * d[1]) +
                 miss.by_q * (hit->xy * d[0] + hit->yy * d[1]);
  miss.by_z = along / descent;

  /* moving the image point: origin and direction change, the hit slides on the surface */
  double t = (ray->origin[2] - hit->z) / -d[2];
  const double *origins[2] = {ray->origin_u, ray->origin_v};
  const double *directions[2] = {ray->direction_u, ray->direction_v};
  double *out[2] = {&miss.by_u, &miss.by_v};
  for (int i = 0; i < 2; i++) {
    const double *dd = directions[i];
    double ex = origins[i][0] + t * dd[0], ey = origins[i][1] + t * dd[1];
    double ez = origins[i][2] + t * dd[2];
    double dt = (p * ex + q * ey - ez) / descent;
    double mx = ex + dt * d[0], my = ey + dt * d[1], mz = ez + dt * d[2];
    double dg = 2 * (dd[2] - p * dd[0] - q * dd[1]) / n2;
    *out[i] = by_x * mx + by_y * my + by_point_z * mz +
              miss.by_p * (hit->xx * mx + hit->xy * my) +
              miss.by_q * (hit->xy * mx + hit->yy * my) + by_rx * (dd[0] + dg * p) +
              by_ry * (dd[1] + dg * q) + by_rz * (dd[2] - dg);
  }
  return miss;
}
