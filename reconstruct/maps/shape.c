/* Best-fit conicoids: least squares of the height along z by Gauss and Newton, the step halved
 * until it gains. The conic starts from the best-fit sphere, the toric one from the conic. The sag
 * is that of the conic r² = 2 R s - p s² (Baker, Proc. Phys. Soc. 55, 361-364, 1943) with a matrix
 * of curvatures in place of 1/R. */
#include "reconstruct/maps/shape.h"

#include "reconstruct/maps/equations.h"
#include "reconstruct/maps/sphere.h"

#include <math.h>
#include <string.h>

#define STEPS_MAX 40
#define HALVINGS_MAX 12
#define CONVERGED 1e-12 /* of every parameter: millimetres and 1/mm */

int placido_shape_free(enum placido_reference reference) {
  static const int counts[PLACIDO_REFERENCES] = {4, 5, 7};
  return counts[reference];
}

/* The sag and its derivatives: by u, by p, and by C along the three matrices that c, d and e
 * multiply. */
static double sag_at(const placido_conicoid_shape *s, const double u[2], double by_u[2],
                     double *by_p, double by_matrix[3]) {
  double w[2] = {(s->c_mm1 + s->d_mm1) * u[0] + s->e_mm1 * u[1],
                 s->e_mm1 * u[0] + (s->c_mm1 - s->d_mm1) * u[1]};
  double a = u[0] * w[0] + u[1] * w[1], b = w[0] * w[0] + w[1] * w[1];
  double root = sqrt(1 - s->p * b), below = 1 + root;
  /* dS = da / below + db * share */
  double share = a * s->p / (2 * root * below * below);
  double cw[2] = {(s->c_mm1 + s->d_mm1) * w[0] + s->e_mm1 * w[1],
                  s->e_mm1 * w[0] + (s->c_mm1 - s->d_mm1) * w[1]};
  const double turned[3][2] = {{u[0], u[1]}, {u[0], -u[1]}, {u[1], u[0]}};
  for (int k = 0; k < 2; k++) {
    by_u[k] = 2 * w[k] / below + 2 * cw[k] * share;
  }
  for (int k = 0; k < 3; k++) {
    by_matrix[k] = (u[0] * turned[k][0] + u[1] * turned[k][1]) / below +
                   2 * (w[0] * turned[k][0] + w[1] * turned[k][1]) * share;
  }
  *by_p = a * b / (2 * root * below * below);
  return a / below;
}

double placido_shape_at(const placido_conicoid_shape *shape, double x_mm, double y_mm,
                        double derivatives[PLACIDO_SHAPE_PARAMETERS]) {
  double u[2] = {x_mm - shape->x_mm, y_mm - shape->y_mm}, by_u[2], by_p, by_matrix[3];
  double sag = sag_at(shape, u, by_u, &by_p, by_matrix);
  if (derivatives) {
    const double all[PLACIDO_SHAPE_PARAMETERS] = {
        by_u[0], by_u[1], 1, -by_matrix[0], -by_p, -by_matrix[1], -by_matrix[2]};
    memcpy(derivatives, all, sizeof all);
  }
  return shape->z_mm - sag;
}

double placido_shape_weight(enum placido_reference reference, const placido_conicoid_shape *shape,
                            double x_mm, double y_mm) {
  if (reference != PLACIDO_REFERENCE_SPHERE) {
    return 1;
  }
  /* a distance along the radius is the height times the cosine of the inclination */
  double x = (x_mm - shape->x_mm) * shape->c_mm1, y = (y_mm - shape->y_mm) * shape->c_mm1;
  return 1 - x * x - y * y;
}

static double sum_squares(const placido_zone *zone, const placido_conicoid_shape *shape) {
  double sum = 0;
  for (size_t i = 0; i < zone->count; i++) {
    const double *p = zone->points[i];
    double error = p[2] - placido_shape_at(shape, p[0], p[1], NULL);
    sum += error * error;
  }
  return sum;
}

static placido_conicoid_shape moved(const placido_conicoid_shape *shape, const double *step,
                                    int count, double share) {
  placido_conicoid_shape s = *shape;
  double *const parameters[PLACIDO_SHAPE_PARAMETERS] = {&s.x_mm, &s.y_mm,  &s.z_mm, &s.c_mm1,
                                                        &s.p,    &s.d_mm1, &s.e_mm1};
  for (int k = 0; k < count; k++) {
    *parameters[k] += share * step[k];
  }
  return s;
}

/* Takes one step that does not lose; returns its length, NaN where none was found. */
static double improve(placido_conicoid_shape *shape, double *cost, const placido_zone *zone,
                      int count) {
  placido_equations equations = {.unknowns = count};
  double row[PLACIDO_SHAPE_PARAMETERS], step[PLACIDO_SHAPE_PARAMETERS], length = 0;
  for (size_t i = 0; i < zone->count; i++) {
    const double *p = zone->points[i];
    double z = placido_shape_at(shape, p[0], p[1], row);
    placido_equations_add(&equations, row, p[2] - z);
  }
  if (!placido_equations_solve(&equations, step)) {
    return NAN;
  }
  for (int k = 0; k < count; k++) {
    length = fmax(length, fabs(step[k]));
  }
  for (int halving = 0; halving < HALVINGS_MAX; halving++) {
    double share = ldexp(1, -halving);
    placido_conicoid_shape tried = moved(shape, step, count, share);
    double found = sum_squares(zone, &tried);
    if (found <= *cost) {
      *shape = tried;
      *cost = found;
      return share * length;
    }
  }
  return 0; /* nothing gains any more: rounding */
}

static placido_conicoid_shape no_shape(double zone_mm) {
  return (placido_conicoid_shape){NAN, NAN, NAN, NAN, NAN, NAN, NAN, zone_mm};
}

static placido_conicoid_shape fit(const placido_conicoid_shape *start, const placido_zone *zone,
                                  int count) {
  placido_conicoid_shape shape = *start;
  double cost = sum_squares(zone, &shape), length = INFINITY;
  for (int i = 0; i < STEPS_MAX && length > CONVERGED; i++) {
    length = improve(&shape, &cost, zone, count);
  }
  return isfinite(cost) && length <= 1e-6 ? shape : no_shape(zone->diameter_mm);
}

void placido_shapes_fit(placido_conicoid_shape shapes[PLACIDO_REFERENCES], placido_sphere *sphere,
                        const placido_zone *zone) {
  *sphere = placido_sphere_fit(zone);
  shapes[PLACIDO_REFERENCE_SPHERE] =
      (placido_conicoid_shape){.x_mm = sphere->x_mm,
                               .y_mm = sphere->y_mm,
                               .z_mm = sphere->z_mm + sphere->radius_mm,
                               .c_mm1 = 1 / sphere->radius_mm,
                               .p = 1,
                               .zone_mm = zone->diameter_mm};
  for (int k = PLACIDO_REFERENCE_CONIC; k < PLACIDO_REFERENCES; k++) {
    shapes[k] = isfinite(shapes[k - 1].c_mm1)
                    ? fit(&shapes[k - 1], zone, placido_shape_free((enum placido_reference)k))
                    : no_shape(zone->diameter_mm);
  }
}
