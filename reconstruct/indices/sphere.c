/* The best-fit sphere's radius as an index. */
#include "reconstruct/maps/sphere.h"

#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/kinds.h"

#include <math.h>

#define SHARE_MIN 0.7  /* of the zone that data must support */
#define MIDDLE_MM 2.67 /* mean distance from the axis of a zone 8 mm wide */

int placido_sphere_radius_find(double *radius_mm, double *sigma_mm, const placido_surface *surface,
                               const placido_fit *fit, placido_error *err) {
  *radius_mm = *sigma_mm = NAN;
  placido_zone zone;
  int status = placido_zone_new(&zone, surface, PLACIDO_SPHERE_ZONE_MM, err);
  if (status) {
    return status;
  }
  if (zone.diameter_mm == PLACIDO_SPHERE_ZONE_MM &&
      zone.count >= SHARE_MIN * (double)zone.sampled) {
    *radius_mm = placido_sphere_fit(&zone).radius_mm;
    *sigma_mm = *radius_mm * *radius_mm / PLACIDO_KERATOMETRIC *
                placido_ring_sigma(surface, fit, MIDDLE_MM);
  }
  placido_zone_free(&zone);
  return PLACIDO_OK;
}

double placido_index_sphere_radius(const placido_cornea *cornea, double *sigma) {
  *sigma = cornea->sphere_sigma_mm;
  return cornea->sphere_radius_mm;
}
