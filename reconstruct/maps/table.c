/* The list of the kinds of map, in the order of their columns in maps.csv. */
#include "reconstruct/maps/kinds.h"

#include <string.h>

/* Colour steps are among those that ISO 19980 names: 0.5, 1 or 1.5 D; 2, 5, 10 or 20 micrometres.
 * Gaussian curvature has none there: 0.001/mm² is what 1.3 D are at a radius of 7.8 mm. */
static const placido_map_kind kinds[] = {
    {.name = "elevation",
     .column = "elevation_um",
     .unit = "µm",
     .help =
         "Height above the best-fit sphere, along the instrument's axis; positive where the cornea "
         "stands nearer to the camera.",
     .step = 5,
     .at = placido_map_elevation},
    {.name = "axial",
     .column = "axial_D",
     .unit = "D",
     .help = "Axial (sagittal) curvature, 337.5 s/(r sqrt(1+s²)), s the slope along the meridian "
             "(ISO 19980).",
     .step = 1,
     .at = placido_map_axial},
    {.name = "tangential",
     .column = "tangential_D",
     .unit = "D",
     .help = "Tangential (meridional, instantaneous) curvature, 337.5 s'/(1+s²)^1.5 along the "
             "meridian (ISO 19980).",
     .step = 1.5,
     .at = placido_map_tangential},
    {.name = "mean",
     .column = "mean_D",
     .unit = "D",
     .help = "Mean of the two principal curvatures, times 337.5; needs no axis.",
     .step = 1,
     .at = placido_map_mean},
    {.name = "gaussian",
     .column = "gaussian_mm2",
     .unit = "1/mm²",
     .help = "Product of the two principal curvatures (Gaussian curvature); needs no axis.",
     .step = 0.001,
     .at = placido_map_gaussian},
    {.name = "refractive",
     .column = "refractive_D",
     .unit = "D",
     .help =
         "1337.5/f by Snell's law at index 1.3375 for a distant source on the axis: f in mm from "
         "the corneal vertex plane to where the point's refracted ray, seen in its meridian, "
         "crosses the axis.",
     .step = 1,
     .at = placido_map_refractive},
};

#define KINDS (sizeof kinds / sizeof kinds[0])

const placido_map_kind *placido_map_kinds(size_t *count) {
  *count = KINDS;
  return kinds;
}

int placido_maps_find(const char *name) {
  for (size_t i = 0; i < KINDS; i++) {
    if (strcmp(kinds[i].name, name) == 0) {
      return (int)i;
    }
  }
  return -1;
}
