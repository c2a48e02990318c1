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

/* Time a sample relative to a power of two by the odd factor that is left, as measured with FFTW
 * 3.3.10 for real and complex transforms of 256 to 5184 samples. */
static double cost_of(int length) {
  static const struct {
    int odd;
    double cost;
  } costs[] = {{1, 1}, {5, 1.05}, {3, 1.2}, {15, 1.3}, {25, 1.3}, {9, 1.45}};
  const double other = 1.5, barely_even = 2.2; /* vectors need a factor of 4 */
  if (length % 4 != 0 && length > 2) {
    return barely_even;
  }
  while (length % 2 == 0) {
    length /= 2;
  }
  for (size_t i = 0; i < sizeof costs / sizeof *costs; i++) {
    if (length == costs[i].odd) {
      return costs[i].cost;
    }
  }
  return other;
}

int placido_fft_fast_length(int length) {
  int best = placido_fft_good_length(length);
  double least = best * cost_of(best);
  for (int next = best + 2; next < least; next += 2) {
    next = placido_fft_good_length(next);
    double cost = next * cost_of(next);
    if (cost < least) {
      least = cost;
      best = next;
    }
  }
  return best;
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
