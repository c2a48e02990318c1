/* Transforms of real planes in place, with plans that are made once and run by any thread. */
#ifndef PLACIDO_SIMULATE_FFT_H
#define PLACIDO_SIMULATE_FFT_H

#include <placido/status.h>
#include <fftw3.h>
#include <stddef.h>

/* Planes of `rows` rows of `columns` real samples. In memory a row has `stride` samples, two or one
 * more, because in place its transform is columns / 2 + 1 complex numbers. */
typedef struct placido_fft {
  int columns, rows;
  size_t stride, plane; /* floats from row to row, and of a plane */
  fftwf_plan forward, backward;
} placido_fft;

/* The smallest even length of at least `length` whose only prime factors are 2, 3, 5 and 7. */
int placido_fft_good_length(int length);

/* The even length of at least `length` that is transformed in the least time: often a longer one
 * with more factors of 2, as 4096 instead of 4000. */
int placido_fft_fast_length(int length);

/* Plans for planes within `planes`, which planning leaves untouched: any plane that lies a whole
 * number of `plane` floats behind it may be transformed. fft->columns, rows, stride and plane come
 * from placido_fft_shape. Free with placido_fft_free. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_fft_new(placido_fft *fft, float *planes, placido_error *err);
void placido_fft_free(placido_fft *fft);

/* Sizes only, for at least columns × rows. */
placido_fft placido_fft_shape(int columns, int rows);

/* FFTW's planner, of either precision, is one for the whole process: who makes or destroys plans of
 * his own, or touches its wisdom, holds this. */
void placido_fft_lock(void);
void placido_fft_unlock(void);

/* In place; forward then backward multiplies by columns × rows. Any number of threads. */
void placido_fft_forward(const placido_fft *fft, float *plane);
void placido_fft_backward(const placido_fft *fft, float *plane);

#endif
