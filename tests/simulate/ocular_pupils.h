/* Pupils of light from any direction, for tests. */
#ifndef PLACIDO_TESTS_OCULAR_PUPILS_H
#define PLACIDO_TESTS_OCULAR_PUPILS_H

#include "simulate/ocular/ocular.h"

/* At 555 nm, reckoned to the chief ray; fails the test with the message where that fails. */
placido_pupil pupil_of(const placido_surface *surface, const placido_eye *eye,
                       const placido_ocular *ocular, const double field_deg[2], int samples,
                       int threads);

/* Whether a sample is inside the pupil. */
bool lit(const placido_pupil *pupil, int column, int row);

#endif
