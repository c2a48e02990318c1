/* The list of the indices, in the order of indices.json. */
#include "reconstruct/indices/cornea.h"

static const placido_index_row rows[] = {
    {"vertex_x_mm", "mm",
     "The corneal vertex, where the cornea faces the instrument squarely: to the right of the "
     "axis.",
     placido_index_vertex_x},
    {"vertex_y_mm", "mm", "The corneal vertex: upwards of the axis.", placido_index_vertex_y},
    {"simk_flat_D", "D",
     "Simulated keratometry, flattest meridian: 337.5 over the mean axial radius at 1.3 to 1.7 mm "
     "from the vertex, about the line through it along the axis; both semi-meridians.",
     placido_index_simk_flat},
    {"simk_flat_axis_deg", "deg",
     "Meridian of simk_flat_D, 0 to 180, from +x (right) towards +y (up).",
     placido_index_simk_flat_axis},
    {"simk_steep_D", "D",
     "Simulated keratometry of the meridian perpendicular to the flattest, by the same rule.",
     placido_index_simk_steep},
    {"simk_steep_axis_deg", "deg", "Meridian of simk_steep_D, perpendicular to the flattest.",
     placido_index_simk_steep_axis},
    {"simk_cylinder_D", "D", "Corneal astigmatism: simk_steep_D less simk_flat_D.",
     placido_index_simk_cylinder},
    {"simk_mean_D", "D", "Mean of simk_flat_D and simk_steep_D.", placido_index_simk_mean},
    {"asphericity_q", "",
     "Asphericity Q of the toric conicoid fitted to the central 6 mm (0 is a sphere, below 0 "
     "flattens outwards).",
     placido_index_asphericity},
    {"apical_radius_mm", "mm",
     "Mean radius of curvature at the apex of the toric conicoid fitted to the central 6 mm.",
     placido_index_apical_radius},
    {"best_fit_sphere_radius_mm", "mm",
     "Radius of the sphere fitted to the central 8 mm, centre free: the elevation map's reference.",
     placido_index_sphere_radius},
    {"max_tangential_D", "D",
     "Greatest tangential power on a 0.1 mm grid over the central 8 mm, where data support it.",
     placido_index_steepest},
    {"max_tangential_x_mm", "mm", "Where max_tangential_D is found: to the right.",
     placido_index_steepest_x},
    {"max_tangential_y_mm", "mm", "Where max_tangential_D is found: upwards.",
     placido_index_steepest_y},
};

const placido_index_row *placido_index_rows(size_t *count) {
  *count = sizeof rows / sizeof rows[0];
  return rows;
}
