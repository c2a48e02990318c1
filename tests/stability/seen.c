/* The results one by one. */
#include "tests/stability/seen.h"

#include <math.h>
#include <placido/index.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

const struct seen_result seen_results[RESULTS] = {[ELEVATION] = {"elevation, rms", "um", 0, 0},
                                                  [AXIAL] = {"axial power, rms", "D", 0, 0},
                                                  [SIMK] = {"SimK", "D", 0, 0},
                                                  [DEFOCUS] = {"z 2 0", "um", 2, 0},
                                                  [ASTIGMATISM] = {"z 2 2", "um", 2, 2},
                                                  [COMA] = {"z 3 -1", "um", 3, -1},
                                                  [SPHERICAL] = {"z 4 0", "um", 4, 0}};

static double simk_of(const placido_surface *surface) {
  static placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count;
  double simk = NAN;
  assert_int_equal(placido_indices_find(values, &count, surface, NULL, NULL), PLACIDO_OK);
  for (size_t i = 0; i < count; i++) {
    simk = strcmp(values[i].name, "simk_mean_D") == 0 ? values[i].value : simk;
  }
  assert_false(isnan(simk));
  return simk;
}

void seen_of(struct seen *seen, const placido_surface *surface, const placido_wavefront *front) {
  double terms[PLACIDO_WAVEFRONT_TERMS];
  zone_see(&seen->zone, surface, NULL);
  assert_int_equal(placido_wavefront_again(terms, front, surface, NULL), PLACIDO_OK);
  seen->numbers[SIMK] = simk_of(surface);
  for (int k = DEFOCUS; k < RESULTS; k++) {
    seen->numbers[k] = terms[placido_zernike_index(seen_results[k].n, seen_results[k].m)];
  }
}

double seen_change(const struct seen *a, const struct seen *b, int result) {
  return result == ELEVATION ? zone_difference(a->zone.height_um, b->zone.height_um)
         : result == AXIAL   ? zone_difference(a->zone.axial_D, b->zone.axial_D)
                             : fabs(a->numbers[result] - b->numbers[result]);
}
