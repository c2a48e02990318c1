/* Diffraction images of known pupils, for tests. Functions fail the test that calls them. */
#ifndef PLACIDO_TESTS_SIMULATE_DIFFRACTED_H
#define PLACIDO_TESTS_SIMULATE_DIFFRACTED_H

#include <placido/diffraction.h>
#include <stddef.h>

enum { SIDE = 257, MIDDLE = SIDE / 2 };

static const double pi = 3.14159265358979323846;
static const double arcmin_rad = 2.908882086657216e-4;
static const double green_nm = 555;

/* An aberrated eye, OSA terms in micrometres over whatever pupil is in use, and one without. */
extern const double eye_um[15], perfect_um[1];

placido_pupil pupil_of(double pupil_mm, const double *terms_um, int count);

/* The image in `window`, whose zeros are settled; to be freed. */
double *image_of(const placido_pupil *pupil, const placido_wave *waves, size_t count,
                 const placido_window *window, placido_diffraction_use *use);

/* The index of the bucket with the most light. */
size_t fullest(const double *values, int side);

#endif
