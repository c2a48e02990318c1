/* Elevation: height above a reference along the z axis, positive towards the camera. */
#include "reconstruct/maps/kinds.h"
#include "reconstruct/maps/shape.h"

#include <math.h>

double placido_map_elevation(const placido_map_point *point) {
  const placido_sphere *sphere = &point->sphere;
  double x = point->x_mm - sphere->x_mm, y = point->y_mm - sphere->y_mm;
  double root = sphere->radius_mm * sphere->radius_mm - x * x - y * y;
  return root >= 0 ? 1000 * (point->z_mm - (sphere->z_mm + sqrt(root))) : NAN;
}

static double above(const placido_map_point *point, enum placido_reference reference) {
  return 1000 * (point->z_mm - placido_shape_at(&point->references[reference], point->x_mm,
                                                point->y_mm, NULL));
}

double placido_map_elevation_conic(const placido_map_point *point) {
  return above(point, PLACIDO_REFERENCE_CONIC);
}

double placido_map_elevation_toric(const placido_map_point *point) {
  return above(point, PLACIDO_REFERENCE_TORIC);
}
