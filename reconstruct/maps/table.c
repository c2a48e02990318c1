/* The list of the kinds of map: first those of maps.csv in the order of their columns, then those
 * of maps_more.csv. */
#include "reconstruct/maps/kinds.h"

#include <string.h>

/* The formulas of ISO 19980 and of differential geometry, and where they end. */
static const char iso[] = "ISO 19980:2012";
static const char geometry[] = "do Carmo, Differential Geometry of Curves and Surfaces, 1976, 3-3";
static const char spie[] = "Klein, Barsky and others, Proc. SPIE 3246, 1998 (CWhatUC)";
static const char snell[] = "Snell's law; Klein and Mandell, IOVS 36, 2096-2109, 1995";
static const char everywhere[] = "Everywhere.";
static const char dome[] = "Where the cornea faces the instrument.";
static const char off_axis[] =
    "Has no limit on the axis where the surface is tilted there; beside it the tilt over the "
    "distance comes on top.";
static const char comparable[] = "Only maps of the same zone compare.";
static const char retina[] =
    "One refracting surface and a flat retina; the retina counts as being where it is said to be.";

/* Colour steps are among those that ISO 19980 names: 0.5, 1 or 1.5 D; 2, 5, 10 or 20 micrometres.
 * Gaussian curvature has none there: 0.001/mm² is what 1.3 D are at a radius of 7.8 mm; nor have
 * the distances on and from the retina. */
static const placido_map_kind kinds[] = {
    {.name = "elevation",
     .title = "Elevation over the best-fit sphere",
     .column = "elevation_um",
     .unit = "µm",
     .help =
         "Height above the best-fit sphere, along the instrument's axis; positive where the cornea "
         "stands nearer to the camera.",
     .source = iso,
     .limits = comparable,
     .step = 5,
     .needs = PLACIDO_MAP_NEEDS_SPHERE,
     .at = placido_map_elevation},
    {.name = "axial",
     .title = "Axial curvature",
     .column = "axial_D",
     .unit = "D",
     .help = "Axial (sagittal) curvature, 337.5 s/(r sqrt(1+s²)), s the slope along the meridian "
             "(ISO 19980).",
     .source = iso,
     .limits = off_axis,
     .step = 1,
     .about_axis = true,
     .at = placido_map_axial},
    {.name = "tangential",
     .title = "Tangential curvature",
     .column = "tangential_D",
     .unit = "D",
     .help = "Tangential (meridional, instantaneous) curvature, 337.5 s'/(1+s²)^1.5 along the "
             "meridian (ISO 19980).",
     .source = iso,
     .limits = everywhere,
     .step = 1.5,
     .at = placido_map_tangential},
    {.name = "mean",
     .title = "Mean curvature",
     .column = "mean_D",
     .unit = "D",
     .help = "Mean of the two principal curvatures, times 337.5; needs no axis.",
     .source = geometry,
     .limits = everywhere,
     .step = 1,
     .at = placido_map_mean},
    {.name = "gaussian",
     .title = "Gaussian curvature",
     .column = "gaussian_mm2",
     .unit = "1/mm²",
     .help = "Product of the two principal curvatures (Gaussian curvature); needs no axis.",
     .source = geometry,
     .limits = everywhere,
     .step = 0.001,
     .at = placido_map_gaussian},
    {.name = "refractive",
     .title = "Refractive power",
     .column = "refractive_D",
     .unit = "D",
     .help =
         "1337.5/f by Snell's law at index 1.3375 for a distant source on the axis: f in mm from "
         "the corneal vertex plane to where the point's refracted ray, seen in its meridian, "
         "crosses the axis.",
     .source = snell,
     .limits = off_axis,
     .step = 1,
     .about_axis = true,
     .at = placido_map_refractive},
    {.name = "elevation_conic",
     .title = "Elevation over the best-fit conicoid",
     .column = "elevation_conic_um",
     .unit = "µm",
     .help = "Height above the best-fit conicoid (apex, radius and asphericity free), along the "
             "instrument's axis.",
     .source = "Least squares of the height; conic: Baker, Proc. Phys. Soc. 55, 361, 1943",
     .limits = comparable,
     .step = 5,
     .more = true,
     .needs = PLACIDO_MAP_NEEDS_CONIC,
     .at = placido_map_elevation_conic},
    {.name = "elevation_toric",
     .title = "Elevation over the best-fit toric conicoid",
     .column = "elevation_toric_um",
     .unit = "µm",
     .help = "Height above the best-fit toric conicoid (apex, both radii, axis and asphericity "
             "free): what a sphere, a cylinder and regular asphericity leave.",
     .source = "Least squares of the height; conic: Baker, Proc. Phys. Soc. 55, 361, 1943",
     .limits = comparable,
     .step = 2,
     .more = true,
     .needs = PLACIDO_MAP_NEEDS_TORIC,
     .at = placido_map_elevation_toric},
    {.name = "axial_vertex",
     .title = "Axial curvature about the corneal vertex",
     .column = "axial_vertex_D",
     .unit = "D",
     .help = "Axial curvature about the line through the corneal vertex (where the slope is 0) "
             "along the axis: what it would be, had the eye been aligned.",
     .source = iso,
     .limits = "Where a vertex was seen.",
     .step = 1,
     .more = true,
     .needs = PLACIDO_MAP_NEEDS_VERTEX,
     .at = placido_map_axial_vertex},
    {.name = "tangential_vertex",
     .title = "Tangential curvature about the corneal vertex",
     .column = "tangential_vertex_D",
     .unit = "D",
     .help = "Tangential curvature along meridians through the corneal vertex.",
     .source = iso,
     .limits = "Where a vertex was seen.",
     .step = 1.5,
     .more = true,
     .needs = PLACIDO_MAP_NEEDS_VERTEX,
     .at = placido_map_tangential_vertex},
    {.name = "axial_refractive",
     .title = "Axial refractive power",
     .column = "axial_refractive_D",
     .unit = "D",
     .help = "1000 n over the distance in mm along the refracted ray from the cornea to where it "
             "crosses (comes nearest to) the axis.",
     .source = spie,
     .limits = off_axis,
     .step = 1,
     .about_axis = true,
     .more = true,
     .at = placido_map_axial_refractive},
    {.name = "instantaneous_refractive",
     .title = "Instantaneous refractive power",
     .column = "instantaneous_refractive_D",
     .unit = "D",
     .help = "1000 n over the distance in mm from the cornea to the local focus, where the "
             "refracted ray meets its neighbour along the meridian.",
     .source = spie,
     .limits = dome,
     .step = 1.5,
     .more = true,
     .at = placido_map_instantaneous_refractive},
    {.name = "focusing_distance",
     .title = "Focusing distance",
     .column = "focusing_distance_mm",
     .unit = "mm",
     .help = "Distance of the local focus from the fovea, in space.",
     .source = spie,
     .limits = retina,
     .step = 0.5,
     .more = true,
     .at = placido_map_focusing_distance},
    {.name = "retinal_distance",
     .title = "Retinal distance",
     .column = "retinal_distance_mm",
     .unit = "mm",
     .help = "Distance from the fovea to where the refracted ray lands on the retina, a plane "
             "through it.",
     .source = spie,
     .limits = retina,
     .step = 0.02,
     .more = true,
     .at = placido_map_retinal_distance},
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
