/* Real-to-complex transforms by FFTW in single precision.
 *
 * Plans are estimated: measuring takes seconds and gives another plan, and so other rounding, each
 * time. Good lengths matter more. FFTW's planner keeps state of its own for the whole process and
 * is not thread-safe, running a plan is; hence the lock: it guards that state and none of ours. */
#include "simulate/fft.h"

#include <pthread.h>

static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

void placido_fft_lock(void) {
  pthread_mutex_lock(&planner);
}

void placido_fft_unlock(void) {
  pthread_mutex_unlock(&planner);
}

int placido_fft_good_length(int length) {
  const int primes[] = {2, 3, 5, 7};
  for (int good = length + length % 2;; good += 2) {
    int rest = good;
    for (size_t i = 0; i < sizeof primes / sizeof *primes; i++) {
      while (rest % primes[i] == 0 && rest > 1) {
        rest /= primes[i];
      }
    }
    if (rest == 1) {
      return good;
    }
  }
}

placido_fft placido_fft_shape(int columns, int rows) {
  placido_fft fft = {.columns = placido_fft_good_length(columns),
                     .rows = placido_fft_good_length(rows)};
  fft.stride = 2 * ((size_t)fft.columns / 2 + 1);
  fft.plane = fft.stride * (size_t)fft.rows;
  fft.plane += (16 - fft.plane % 16) % 16; /* planes alike aligned, as the plans expect */
  return fft;
}

int placido_fft_new(placido_fft *fft, float *planes, placido_error *err) {
  fftwf_complex *spectrum = (fftwf_complex *)(void *)planes;
  pthread_mutex_lock(&planner);
  fft->forward = fftwf_plan_dft_r2c_2d(fft->rows, fft->columns, planes, spectrum, FFTW_ESTIMATE);
  fft->backward = fftwf_plan_dft_c2r_2d(fft->rows, fft->columns, spectrum, planes, FFTW_ESTIMATE);
  pthread_mutex_unlock(&planner);
  if (fft->forward == NULL || fft->backward == NULL) {
    placido_fft_free(fft);
    return placido_error_set(err, PLACIDO_MEMORY, "no transform of %d by %d samples could be made",
                             fft->columns, fft->rows);
  }
  return PLACIDO_OK;
}

void placido_fft_free(placido_fft *fft) {
  if (fft == NULL) {
    return;
  }
  pthread_mutex_lock(&planner);
  if (fft->forward != NULL) {
    fftwf_destroy_plan(fft->forward);
  }
  if (fft->backward != NULL) {
    fftwf_destroy_plan(fft->backward);
  }
  pthread_mutex_unlock(&planner);
  fft->forward = fft->backward = NULL;
}

void placido_fft_forward(const placido_fft *fft, float *plane) {
  fftwf_execute_dft_r2c(fft->forward, plane, (fftwf_complex *)(void *)plane);
}

void placido_fft_backward(const placido_fft *fft, float *plane) {
  fftwf_execute_dft_c2r(fft->backward, (fftwf_complex *)(void *)plane, plane);
}
