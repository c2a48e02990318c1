/* Pupils made of terms, and their images. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>

#include "diffracted.h"

const double eye_um[15] = {[3] = 0.03,  [4] = 0.10, [5] = -0.08, [6] = 0.06,
                                  [7] = 0.12, [8] = 0.05, [9] = -0.04, [12] = 0.07};
const double perfect_um[1] = {0};

placido_pupil pupil_of(double pupil_mm, const double *terms_um, int count) {
  placido_pupil pupil;
  placido_error err = {0};
  if (placido_pupil_of_terms(&pupil, pupil_mm, terms_um, count, 0, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return pupil;
}

double *image_of(const placido_pupil *pupil, const placido_wave *waves, size_t count,
                 const placido_window *window, placido_diffraction_use *use) {
  placido_error err = {0};
  int side = window->buckets ? window->buckets : SIDE;
  double *values = malloc((size_t)side * (size_t)side * sizeof *values);
  assert_non_null(values);
  if (placido_diffraction(values, use, pupil, waves, count, window, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return values;
}

size_t fullest(const double *values, int side) {
  size_t best = 0;
  for (size_t i = 0; i < (size_t)side * (size_t)side; i++) {
    best = values[i] > values[best] ? i : best;
  }
  return best;
}
