/* The ray trace from the camera by a ball to an edge's plane in closed form, and its derivatives
 * backwards through the same steps (reverse accumulation: Griewank & Walther, Evaluating
 * Derivatives, 2008, ch. 3). A name ending in _bar is F's derivative by the quantity before it. */
#include "acquire/calibrate/sphere.h"

#include <math.h>

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The ray's way to the ball and on, in the ball's own frame. */
typedef struct path {
  double t, hit[3], normal[3], cosine, mirrored[3];
} path;

static bool trace(path *p, const double origin[3], const double d[3], const double centre[3],
                  double radius_mm) {
  double o[3] = {origin[0] - centre[0], origin[1] - centre[1], origin[2] - centre[2]};
  double a = dot(d, d), b = dot(o, d), c = dot(o, o) - radius_mm * radius_mm;
  double discriminant = b * b - a * c;
  if (!(discriminant > 0)) {
    return false;
  }
  p->t = (-b - sqrt(discriminant)) / a;
  for (int i = 0; i < 3; i++) {
    p->hit[i] = o[i] + p->t * d[i];
    p->normal[i] = p->hit[i] / radius_mm;
  }
  p->cosine = dot(d, p->normal);
  for (int i = 0; i < 3; i++) {
    p->mirrored[i] = d[i] - 2 * p->cosine * p->normal[i];
  }
  return true;
}

bool placido_sphere_miss_at(placido_sphere_miss *miss, const double origin[3],
                            const double direction[3], const double centre[3], double radius_mm,
                            const placido_edge *edge) {
  *miss = (placido_sphere_miss){0};
  path p;
  if (!trace(&p, origin, direction, centre, radius_mm)) {
    return false;
  }
  const double *r = p.mirrored, *d = direction;
  double x = centre[0] + p.hit[0], y = centre[1] + p.hit[1];
  double height = edge->z_mm - centre[2] - p.hit[2];
  double gx = x * r[2] + height * r[0], gy = y * r[2] + height * r[1];
  double rho = sqrt(gx * gx + gy * gy);
  double cx = rho > 0 ? gx / rho : 0, cy = rho > 0 ? gy / rho : 0;
  double height_bar = cx * r[0] + cy * r[1];
  miss->f = rho - edge->radius_mm * r[2];
  miss->by_edge_radius = -r[2];
  miss->by_edge_z = height_bar;

  double point_bar[3] = {cx * r[2], cy * r[2], -height_bar};
  double r_bar[3] = {cx * height, cy * height, cx * x + cy * y - edge->radius_mm};
  double r_bar_normal = dot(r_bar, p.normal), hit_bar[3];
  for (int i = 0; i < 3; i++) {
    double normal_bar = -2 * (r_bar_normal * d[i] + p.cosine * r_bar[i]);
    hit_bar[i] = point_bar[i] + normal_bar / radius_mm;
    miss->by_radius -= normal_bar * p.normal[i] / radius_mm;
    miss->by_direction[i] = r_bar[i] - 2 * r_bar_normal * p.normal[i];
  }
  /* the hit stays on the ball: hit · (do + t dd + d dt) = R dR */
  double t_bar = dot(hit_bar, d) / dot(p.hit, d);
  miss->by_radius += t_bar * radius_mm;
  for (int i = 0; i < 3; i++) {
    double slid = hit_bar[i] - t_bar * p.hit[i];
    miss->by_origin[i] = slid;
    miss->by_direction[i] += p.t * slid;
    miss->by_centre[i] = point_bar[i] - slid;
  }
  return true;
}
