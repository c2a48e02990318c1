/* The stages of a diffraction image: a wavefront made whole, the field on the transform's own grid,
 * the transform. */
#ifndef PLACIDO_SIMULATE_PSF_DIFFRACTION_H
#define PLACIDO_SIMULATE_PSF_DIFFRACTION_H

#include <placido/diffraction.h>

#include <fftw3.h>

/* Copies a window with its defaults filled in. PLACIDO_OK or PLACIDO_INPUT. */
int placido_window_settle(placido_window *settled, const placido_window *window,
                          placido_error *err);

/* PLACIDO_OK, or PLACIDO_INPUT naming what is out of range. */
int placido_waves_check(const placido_wave *waves, size_t count, placido_error *err);

/* A pupil whose wavefront goes on beyond the light's edge, so that it can be interpolated there. */
typedef struct placido_front {
  int n;
  double spacing_mm, pupil_mm;
  double *opd_um;
  double *amplitude;  /* 0 where no light comes; NULL: 1 everywhere */
  double slope_max;   /* of the path difference within the pupil, micrometres per millimetre */
} placido_front;

/* Free with placido_front_free. PLACIDO_OK, PLACIDO_INPUT, PLACIDO_QUALITY (no light, or a grid
 * that cannot follow its wavefront to `tolerance_um`), PLACIDO_MEMORY. */
int placido_front_new(placido_front *front, const placido_pupil *pupil, double tolerance_um,
                      placido_error *err);
void placido_front_free(placido_front *front);

/* The field of one wavelength on n * n cells of spacing_mm about the pupil's centre: a cell that
 * the rim crosses counts by its area inside. Rows of `stride` complex numbers (real, imaginary);
 * cells outside stay 0. `work` has room for placido_field_work(front, n) numbers. Returns the
 * light: the sum over the cells of area times the square of the amplitude. */
double placido_field_fill(float *field, size_t stride, int n, double spacing_mm,
                          const placido_front *front, const placido_wave *wave, double *work);
size_t placido_field_work(const placido_front *front, int n);

/* Field to image: `samples` a side to `period` buckets a side. */
typedef struct placido_spread {
  int samples, padded, period;
  size_t field_stride, image_stride; /* complex numbers from row to row */
  size_t field_size, image_size;     /* complex numbers, room to work included */
  fftwf_plan rows, columns, real_rows, real_columns, image;
} placido_spread;

/* Free with placido_spread_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_spread_new(placido_spread *spread, int samples, int period, placido_error *err);
void placido_spread_free(placido_spread *spread);

/* `field`, 0 outside its `samples` rows and columns, is used up; both at multiples of 64 bytes. The
 * bucket at angle (column, row), counted modulo the period, is `image` at column + 2 image_stride
 * row: the integral over it of the light, or the value in its middle times its area; of a field
 * without phase all sum to padded² period² times the sum of its squares. */
void placido_spread_run(const placido_spread *spread, float *field, float *image, bool points);

#endif
