/* Elevation: height above the best-fit sphere along the z axis, positive towards the camera. */
#include "reconstruct/maps/kinds.h"

#include <math.h>

double placido_map_elevation(const placido_map_point *point) {
  const placido_sphere *sphere = &point->sphere;
  double x = point->x_mm - sphere->x_mm, y = point->y_mm - sphere->y_mm;
  double root = sphere->radius_mm * sphere->radius_mm - x * x - y * y;
  return root >= 0 ? 1000 * (point->z_mm - (sphere->z_mm + sqrt(root))) : NAN;
}
