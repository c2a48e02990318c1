/* A figure of a wavefront by its name, in tests that know which they want. */
#ifndef PLACIDO_TESTS_NAMED_FIGURE_H
#define PLACIDO_TESTS_NAMED_FIGURE_H

#include "tests/support/near.h"

#include <placido/wavefront.h>
#include <string.h>

/* Fails the test where there is none of that name. */
static inline double named_figure(const placido_wavefront *wavefront, const char *name) {
  size_t count;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(figures[i].name, name) == 0) {
      return figures[i].at(wavefront, wavefront->coefficients_um);
    }
  }
  fail_msg("there is no figure %s", name);
  return NAN;
}

#endif
