/* Curvatures: axial, tangential, mean, Gaussian.
 * Axial and tangential belong to the meridian through the z axis, or through the line along it that
 * passes the corneal vertex (ISO 19980; Klein & Mandell,
 * Invest. Ophthalmol. Vis. Sci. 36, 2096-2109, 1995); mean and Gaussian are the surface's own (do
 * Carmo, Differential Geometry of Curves and Surfaces, 1976, section 3-3, for a graph). */
#include "reconstruct/maps/kinds.h"

#include <math.h>

/* The meridian of a point about a line along the z axis. */
typedef struct meridian {
  double r, slope, bend; /* distance from the line; slope of the sag along it, and its derivative */
} meridian;

/* On the line itself the meridian is along +x. Where r is so small that slope / r loses its digits
 * the limit, s', stands for it: r is 0. */
static meridian meridian_at(const placido_jet *jet, double x, double y) {
  double r = sqrt(x * x + y * y), c = r > 0 ? x / r : 1, s = r > 0 ? y / r : 0;
  return (meridian){.r = r < 1e-9 ? 0 : r,
                    .slope = c * jet->sx + s * jet->sy,
                    .bend = c * c * jet->sxx + 2 * c * s * jet->sxy + s * s * jet->syy};
}

static double axial(const meridian *m) {
  return PLACIDO_KERATOMETRIC *
         (m->r > 0 ? m->slope / (m->r * sqrt(1 + m->slope * m->slope)) : m->bend);
}

static double tangential(const meridian *m) {
  double square = 1 + m->slope * m->slope;
  return PLACIDO_KERATOMETRIC * (m->r > 0 ? m->bend / (square * sqrt(square)) : m->bend);
}

double placido_map_axial(const placido_map_point *point) {
  meridian m = meridian_at(&point->jet, point->x_mm, point->y_mm);
  return axial(&m);
}

double placido_map_tangential(const placido_map_point *point) {
  meridian m = meridian_at(&point->jet, point->x_mm, point->y_mm);
  return tangential(&m);
}

static meridian about_vertex(const placido_map_point *point) {
  return meridian_at(&point->jet, point->x_mm - point->vertex_mm[0],
                     point->y_mm - point->vertex_mm[1]);
}

double placido_map_axial_vertex(const placido_map_point *point) {
  meridian m = about_vertex(point);
  return isnan(point->vertex_mm[0]) ? (double)NAN : axial(&m);
}

double placido_map_tangential_vertex(const placido_map_point *point) {
  meridian m = about_vertex(point);
  return isnan(point->vertex_mm[0]) ? (double)NAN : tangential(&m);
}

double placido_map_mean(const placido_map_point *point) {
  const placido_jet *jet = &point->jet;
  double xx = 1 + jet->sx * jet->sx, yy = 1 + jet->sy * jet->sy;
  double square = xx + jet->sy * jet->sy;
  double numerator = xx * jet->syy - 2 * jet->sx * jet->sy * jet->sxy + yy * jet->sxx;
  return PLACIDO_KERATOMETRIC * numerator / (2 * square * sqrt(square));
}

double placido_map_gaussian(const placido_map_point *point) {
  const placido_jet *jet = &point->jet;
  double square = 1 + jet->sx * jet->sx + jet->sy * jet->sy;
  return (jet->sxx * jet->syy - jet->sxy * jet->sxy) / (square * square);
}
