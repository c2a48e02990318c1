/* Pupils for tests. */
#include "ocular_pupils.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static const double no_offset[2] = {0, 0};

placido_pupil pupil_of(const placido_surface *surface, const placido_eye *eye,
                       const placido_ocular *ocular, const double field_deg[2], int samples,
                       int threads) {
  placido_pupil pupil;
  placido_error err = {0};
  if (placido_ocular_pupil(&pupil, surface, eye, ocular, field_deg, no_offset, 0, samples, threads,
                           &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return pupil;
}

bool lit(const placido_pupil *pupil, int column, int row) {
  double middle = 0.5 * (pupil->n - 1), radius = 0.5 * pupil->pupil_mm / pupil->spacing_mm;
  return hypot(column - middle, row - middle) <= radius;
}
