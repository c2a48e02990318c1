/* Extremes of a map, with and without its few outermost points. */
#include "report/range.h"

#include "base/memory.h"
#include "report/number.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static bool is_beside_hole(const placido_maps *maps, size_t k, double hole_mm) {
  int i = (int)(k % (size_t)maps->size) - maps->half,
      j = (int)(k / (size_t)maps->size) - maps->half;
  return hole_mm <= 0 || sqrt((double)(i * i + j * j)) * maps->step_mm > hole_mm;
}

int placido_range_find(placido_range *found, const placido_maps *maps, const double *values,
                       double hole_mm, placido_error *err) {
  *found = (placido_range){NAN, NAN, NAN, NAN};
  size_t all = (size_t)maps->size * (size_t)maps->size, count = 0;
  double *sorted = placido_memory_new(all, sizeof *sorted, err);
  if (sorted == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t k = 0; k < all; k++) {
    if (maps->valid[k] && isfinite(values[k]) && is_beside_hole(maps, k, hole_mm)) {
      sorted[count++] = values[k];
    }
  }
  if (count > 0) {
    qsort(sorted, count, sizeof *sorted, compare);
    size_t tail = count / 200;
    *found = (placido_range){sorted[0], sorted[count - 1], sorted[tail], sorted[count - 1 - tail]};
  }
  placido_memory_free(sorted);
  return PLACIDO_OK;
}

/* Decimals that show a hundredth of the step's order of magnitude or better. */
static int decimals(double step) {
  double wanted = 1 - floor(log10(step));
  return (int)fmin(fmax(wanted, 0), 8);
}

void placido_range_describe(char *note, size_t size, const placido_range *range, double step,
                            const char *unit) {
  char lowest[PLACIDO_NUMBER_SIZE] = "–", highest[PLACIDO_NUMBER_SIZE] = "–";
  if (isfinite(range->lowest)) {
    placido_number_write(lowest, sizeof lowest, range->lowest, decimals(step));
    placido_number_write(highest, sizeof highest, range->highest, decimals(step));
  }
  snprintf(note, size, "step %g %s   ·   lowest %s   ·   highest %s", step, unit, lowest, highest);
}
