/* The best-fit sphere ("float"): least squares of the radial distance over radius and centre.
 * Starts from the algebraic fit, linear in the centre and |centre|² - R² (the simple fit of Pratt,
 * Comput. Graph. 21, 145-152, 1987), and takes Gauss-Newton steps in x, y, vertex z and R. The
 * vertex stands in for the centre because centre and radius of a shallow cap nearly compensate each
 * other. */
#include "reconstruct/maps/sphere.h"

#include "reconstruct/maps/equations.h"

#include <math.h>

#define STEPS_MAX 20
#define CONVERGED_MM 1e-13 /* relative to the radius */

/* Centre and radius in unknowns: x, y, vertex z, radius. */
static bool start(const placido_zone *zone, double sphere[4]) {
  placido_equations equations = {.unknowns = 4};
  for (size_t i = 0; i < zone->count; i++) {
    const double *p = zone->points[i];
    const double row[4] = {2 * p[0], 2 * p[1], 2 * p[2], 1};
    placido_equations_add(&equations, row, p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  }
  double u[4];
  if (!placido_equations_solve(&equations, u)) {
    return false;
  }
  double radius = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3]);
  sphere[0] = u[0];
  sphere[1] = u[1];
  sphere[2] = u[2] + radius;
  sphere[3] = radius;
  return isfinite(radius);
}

/* One Gauss-Newton step; false where it is not determined. */
static bool improve(const placido_zone *zone, double sphere[4], double *length) {
  placido_equations equations = {.unknowns = 4};
  for (size_t i = 0; i < zone->count; i++) {
    const double *p = zone->points[i];
    double x = p[0] - sphere[0], y = p[1] - sphere[1], z = p[2] - (sphere[2] - sphere[3]);
    double distance = sqrt(x * x + y * y + z * z);
    const double row[4] = {-x / distance, -y / distance, -z / distance, z / distance - 1};
    placido_equations_add(&equations, row, sphere[3] - distance);
  }
  double step[4];
  if (!placido_equations_solve(&equations, step)) {
    return false;
  }
  *length = 0;
  for (int i = 0; i < 4; i++) {
    sphere[i] += step[i];
    *length = fmax(*length, fabs(step[i]));
  }
  return isfinite(*length);
}

placido_sphere placido_sphere_fit(const placido_zone *zone) {
  double u[4], length = INFINITY;
  bool found = start(zone, u);
  for (int i = 0; i < STEPS_MAX && found && length > CONVERGED_MM * u[3]; i++) {
    found = improve(zone, u, &length);
  }
  if (!found || !(u[3] > 0)) {
    return (placido_sphere){NAN, NAN, NAN, NAN, zone->diameter_mm};
  }
  return (placido_sphere){.radius_mm = u[3],
                          .x_mm = u[0],
                          .y_mm = u[1],
                          .z_mm = u[2] - u[3],
                          .zone_mm = zone->diameter_mm};
}
