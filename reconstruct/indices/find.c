/* Indices: the shared figures computed once, then every row of the table. */
#include "reconstruct/indices/cornea.h"

#include <math.h>

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
