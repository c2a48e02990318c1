/* Error bars by linear propagation: edge noise through the inverse of the normal matrix, the
 * distance's uncertainty through the derivative of the solution. */
#include "reconstruct/solve/result.h"

#include "base/memory.h"
#include "reconstruct/solve/refine.h"

#include <math.h>

int placido_fit_covariance(placido_fit *fit, placido_error *err) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  double *right = placido_memory_new(n, sizeof *right, err);
  fit->by_distance = placido_memory_new(n, sizeof *fit->by_distance, err);
  int status = right && fit->by_distance ? PLACIDO_OK : PLACIDO_MEMORY;
  placido_basis basis;
  if (!status) {
    /* the spring at the axis pulls to the distance: its push per millimetre is weight · B(0, 0) */
    placido_grid_basis(&fit->grid, 0, 0, &basis);
    for (int i = 0; i < PLACIDO_SPLINE_CELL; i++) {
      int j = i / PLACIDO_SPLINE_ORDER, k = i % PLACIDO_SPLINE_ORDER;
      right[(basis.row + j) * fit->grid.side + basis.column + k] =
          PLACIDO_DISTANCE_WEIGHT * basis.y[0][j] * basis.x[0][k];
    }
    status = placido_normal_solve_more(fit->normal, right, fit->by_distance, err);
  }
  if (!status) {
    status = placido_normal_inverse(fit->normal, &fit->inverse, err);
  }
  placido_memory_free(right);
  return status;
}

void placido_fit_free(placido_fit *fit) {
  if (!fit) {
    return;
  }
  placido_surface_free(fit->surface);
  placido_normal_free(fit->normal);
  placido_memory_free(fit->inverse);
  placido_memory_free(fit->by_distance);
  placido_memory_free(fit);
}

const placido_surface *placido_fit_surface(const placido_fit *fit) {
  return fit->surface;
}

placido_fit_summary placido_fit_summary_get(const placido_fit *fit) {
  return fit->summary;
}

void placido_fit_sigma_at(const placido_fit *fit, double x_mm, double y_mm, double *sigma_z_um,
                          double *sigma_axial_D) {
  *sigma_z_um = *sigma_axial_D = NAN;
  placido_basis basis;
  placido_jet jet;
  if (!placido_surface_at(fit->surface, x_mm, y_mm, &jet) ||
      !placido_grid_basis(&fit->grid, x_mm, y_mm, &basis)) {
    return;
  }
  double r = hypot(x_mm, y_mm), slope, along[2] = {1, 0};
  /* what the distance lifts as a whole, itself included, is no error of the shape: lifted is what
   * is left at (x, y) beyond the lift on the axis. Axial curvature s/(r·sqrt(1+s²)) changes by
   * ds/(r·(1+s²)^1.5); at the axis it is s', and the slope's own row over a short radius stands for
   * it */
  double radius = fmax(r, 0.05);
  if (r > 0) {
    along[0] = x_mm / r;
    along[1] = y_mm / r;
  }
  slope = jet.sx * along[0] + jet.sy * along[1];
  double power = 337.5 / (radius * pow(1 + slope * slope, 1.5));
  double height[PLACIDO_SPLINE_CELL], tilt[PLACIDO_SPLINE_CELL], lifted = -1, tilted = 0;
  for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
    int j = k / PLACIDO_SPLINE_ORDER, i = k % PLACIDO_SPLINE_ORDER;
    height[k] = basis.y[0][j] * basis.x[0][i];
    tilt[k] = along[0] * basis.y[0][j] * basis.x[1][i] + along[1] * basis.y[1][j] * basis.x[0][i];
    double by = fit->by_distance[(basis.row + j) * fit->grid.side + basis.column + i];
    lifted += height[k] * by;
    tilted += tilt[k] * by;
  }
  double noise_z =
      placido_normal_variance(fit->normal, fit->inverse, basis.column, basis.row, height);
  double noise_tilt =
      placido_normal_variance(fit->normal, fit->inverse, basis.column, basis.row, tilt);
  double distance_z = lifted * fit->axis_z_sigma_mm, distance_tilt = tilted * fit->axis_z_sigma_mm;
  *sigma_z_um = 1e3 * sqrt(fit->variance_scale * noise_z + distance_z * distance_z);
  *sigma_axial_D = power * sqrt(fit->variance_scale * noise_tilt + distance_tilt * distance_tilt);
}
