/* Quasi-interpolation: a uniform B-spline's coefficients from its values at their own places, by
 * the inverse of c + δ²c/4 + δ⁴c/120 (degree 5) or c + δ²c/6 (degree 3) up to that degree's order
 * (de Boor, A Practical Guide to Splines, chapter XII). */
#include "reconstruct/solve/engine/prolong.h"

#include "base/memory.h"

#include <math.h>
#include <stddef.h>

#define REACH 2 /* values on either side that a coefficient is made of */

/* Weights of the values at distances 0, 1 and 2. */
static const double quintic[REACH + 1] = {1 + 1.0 / 2 + 6 * 13.0 / 240, -1.0 / 4 - 4 * 13.0 / 240,
                                          13.0 / 240};
static const double cubic[REACH + 1] = {1 + 1.0 / 3, -1.0 / 6, 0};

static double value_at(const placido_grid *grid, const double *known, double x_mm, double y_mm) {
  placido_basis basis;
  double out[6], half = grid->half_mm;
  if (!placido_grid_basis(grid, fmin(fmax(x_mm, -half), half), fmin(fmax(y_mm, -half), half),
                          &basis)) {
    return 0;
  }
  placido_grid_value(grid, known, &basis, out);
  return out[0];
}

/* The weighted sum along one axis of values `step` apart. */
static double weigh(const double *value, ptrdiff_t step, const double weights[REACH + 1]) {
  double sum = weights[0] * value[0];
  for (int k = 1; k <= REACH; k++) {
    sum += weights[k] * (value[k * step] + value[-k * step]);
  }
  return sum;
}

int placido_grid_prolong(double *coefficients, const placido_grid *to, const double *known,
                         const placido_grid *from, placido_error *err) {
  const double *weights = to->order == PLACIDO_SPLINE_ORDER ? quintic : cubic;
  ptrdiff_t wide = to->side + 2 * REACH;
  double first_mm = -to->half_mm - (0.5 * (to->order - 2) + REACH) * to->knot_mm;
  double *values = placido_memory_new((size_t)(wide * wide), sizeof *values, err);
  double *rows = values ? placido_memory_new((size_t)(wide * to->side), sizeof *rows, err) : NULL;
  if (!rows) {
    placido_memory_free(values);
    return PLACIDO_MEMORY;
  }
  for (ptrdiff_t j = 0; j < wide; j++) {
    for (ptrdiff_t i = 0; i < wide; i++) {
      values[j * wide + i] = value_at(from, known, first_mm + (double)i * to->knot_mm,
                                      first_mm + (double)j * to->knot_mm);
    }
    for (ptrdiff_t i = 0; i < to->side; i++) {
      rows[j * to->side + i] = weigh(&values[j * wide + i + REACH], 1, weights);
    }
  }
  for (ptrdiff_t j = 0; j < to->side; j++) {
    for (ptrdiff_t i = 0; i < to->side; i++) {
      coefficients[j * to->side + i] = weigh(&rows[(j + REACH) * to->side + i], to->side, weights);
    }
  }
  placido_memory_free(rows);
  placido_memory_free(values);
  return PLACIDO_OK;
}
