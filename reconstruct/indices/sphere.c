/* The best-fit sphere's radius as an index. */
#include "reconstruct/maps/sphere.h"

#include "reconstruct/indices/cornea.h"

#include <math.h>

static void measure(placido_cornea *cornea) {
  const placido_zone *zone = &cornea->grid;
  bool enough = (double)zone->count >= PLACIDO_SHARE_MIN * (double)zone->sampled;
  cornea->sphere_radius_mm = enough ? placido_sphere_fit(zone).radius_mm : NAN;
}

static double radius(const placido_cornea *cornea) {
  return cornea->sphere_radius_mm;
}

static const char *why_none(const placido_cornea *cornea) {
  (void)cornea;
  return PLACIDO_REASON_NOT_COVERED; /* it needs no vertex */
}

static const placido_index_row rows[] = {
    {.name = "best_fit_sphere_radius_mm",
     .unit = "mm",
     .help = "Radius of the sphere fitted to 8 mm about the axis, centre and radius free "
             "(\"float\"), as the elevation map's reference is, on a grid of 0.2 mm. Needs 70 % of "
             "the zone.",
     .at = radius,
     .reason = why_none},
};

const placido_index_group placido_sphere_group = {measure, rows, sizeof rows / sizeof rows[0]};
