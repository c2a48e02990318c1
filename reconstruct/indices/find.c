/* Indices: the shared figures computed once, then every row of the table. */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/sigma.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define RING_STEP_DEG 5

double placido_ring_sigma(const placido_surface *surface, const placido_fit *fit, double r_mm) {
  double sum = 0;
  int count = 0;
  for (int angle = 0; angle < 360; angle += RING_STEP_DEG) {
    double x = r_mm * cos(angle * DEGREE), y = r_mm * sin(angle * DEGREE), sigma_z, sigma;
    if (placido_surface_covered(surface, x, y)) {
      placido_sigma_at(fit, x, y, &sigma_z, &sigma);
      sum += sigma;
      count++;
    }
  }
  return count > 0 ? sum / count : NAN;
}

int placido_indices_find(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                         const placido_surface *surface, const placido_fit *fit,
                         placido_error *err) {
  *count = 0;
  placido_vertex vertex = placido_vertex_find(surface);
  placido_cornea cornea = {.vertex = vertex,
                           .simk = placido_simk_find(surface, fit, vertex),
                           .steepest = placido_steepest_find(surface)};
  int status = placido_conicoid_fit(&cornea.conicoid, surface, fit, err);
  if (!status) {
    status = placido_sphere_radius_find(&cornea.sphere_radius_mm, &cornea.sphere_sigma_mm, surface,
                                        fit, err);
  }
  if (status) {
    return status;
  }
  size_t row_count;
  const placido_index_row *rows = placido_index_rows(&row_count);
  for (size_t i = 0; i < row_count && i < PLACIDO_INDICES_MAX; i++) {
    placido_index_value *value = &values[(*count)++];
    *value = (placido_index_value){rows[i].name, rows[i].unit, rows[i].help, NAN, NAN};
    value->value = rows[i].at(&cornea, &value->sigma);
    if (isnan(value->value)) {
      value->sigma = NAN;
    }
  }
  return PLACIDO_OK;
}
