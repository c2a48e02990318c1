/* The corneal vertex: where the tangent plane is perpendicular to the instrument's axis (ISO
 * 19980). An eye seldom sits on that axis to better than some tenths of a millimetre, and axial
 * power means something only about a line through the vertex. */
#include "reconstruct/indices/cornea.h"

#include <math.h>

#define STEPS_MAX 30
#define STEP_MAX_MM 0.5
#define CLOSE_MM 1e-9

placido_vertex placido_vertex_find(const placido_surface *surface) {
  double x = 0, y = 0;
  for (int step = 0; step < STEPS_MAX; step++) {
    placido_jet jet;
    if (!placido_surface_at(surface, x, y, &jet)) {
      break;
    }
    double determinant = jet.sxx * jet.syy - jet.sxy * jet.sxy;
    double dx = -(jet.syy * jet.sx - jet.sxy * jet.sy) / determinant;
    double dy = -(jet.sxx * jet.sy - jet.sxy * jet.sx) / determinant;
    double length = sqrt(dx * dx + dy * dy);
    if (!(determinant > 0)) {
      break; /* no dome here */
    }
    if (length < CLOSE_MM) {
      return placido_surface_covered(surface, x, y) ? (placido_vertex){x, y}
                                                    : (placido_vertex){NAN, NAN};
    }
    double share = length > STEP_MAX_MM ? STEP_MAX_MM / length : 1;
    x += share * dx;
    y += share * dy;
  }
  return (placido_vertex){NAN, NAN};
}

static double vertex_x(const placido_cornea *cornea) {
  return cornea->vertex.x_mm;
}

static double vertex_y(const placido_cornea *cornea) {
  return cornea->vertex.y_mm;
}

static const placido_index_row rows[] = {
    {.name = "vertex_x_mm",
     .unit = "mm",
     .help = "The corneal vertex, where the cornea faces the instrument squarely (ISO 19980): to "
             "the right of the axis. Axial powers and zones of the indices are about it.",
     .at = vertex_x},
    {.name = "vertex_y_mm",
     .unit = "mm",
     .help = "The corneal vertex: upwards of the axis.",
     .at = vertex_y},
};

const placido_index_group placido_vertex_group = {NULL, rows, sizeof rows / sizeof rows[0]};
