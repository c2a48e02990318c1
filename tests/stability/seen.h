/* What an examination sees of a cornea: shape, keratometry and wavefront. */
#ifndef PLACIDO_TESTS_STABILITY_SEEN_H
#define PLACIDO_TESTS_STABILITY_SEEN_H

#include "tests/stability/zone.h"

#include <placido/wavefront.h>

enum { ELEVATION, AXIAL, SIMK, DEFOCUS, ASTIGMATISM, COMA, SPHERICAL, RESULTS };

extern const struct seen_result {
  const char *name, *unit;
  int n, m; /* of a wavefront's term */
} seen_results[RESULTS];

struct seen {
  struct zone zone;
  double numbers[RESULTS]; /* from SIMK on */
};

/* `front`: its rays and its reference sphere are everybody's, as for the fit's error bars. */
void seen_of(struct seen *seen, const placido_surface *surface, const placido_wavefront *front);

/* What became different of a result. */
double seen_change(const struct seen *a, const struct seen *b, int result);

#endif
