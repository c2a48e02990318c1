/* Places among the nodes, and the directions that these stand for. */
#include "simulate/plan/nodes.h"

#include "simulate/eye.h"

#include <math.h>

double placido_node_place(int at, int size, int bleed_px, int nodes) {
  int last = size - 2 * bleed_px - 1, from = at - bleed_px;
  return last > 0 ? fmin(fmax((double)from, 0), last) * (nodes - 1) / last : 0;
}

void placido_field_of_px(double field_deg[2], double right_px, double down_px,
                         double arcmin_per_px) {
  const double deg_per_rad = 180 / acos(-1), step = arcmin_per_px * PLACIDO_ARCMIN_RAD;
  field_deg[0] = -atan(right_px * step) * deg_per_rad;
  field_deg[1] = -atan(down_px * step) * deg_per_rad;
}

void placido_node_field_deg(double field_deg[2], int width_px, int height_px, int bleed_px,
                            double arcmin_per_px, int nodes, int node) {
  double right = 0, down = 0;
  if (nodes > 1) {
    right = ((double)(node % nodes) / (nodes - 1) - 0.5) * (width_px - 2 * bleed_px - 1);
    down = ((double)(node / nodes) / (nodes - 1) - 0.5) * (height_px - 2 * bleed_px - 1);
  }
  placido_field_of_px(field_deg, right, down, arcmin_per_px);
}
