/* How fast the machine is just now, by a fixed piece of work like the program's own: a Cholesky
 * factorisation as in a fit and a fast Fourier transform as in seeing. It is written out here, so
 * that no library's version or choice of kernels changes it. */
#include "acquire/cli/accuracy/table.h"

#include "base/memory.h"

#include <math.h>
#include <time.h>

#define ORDER 128      /* of the matrix: 130 kB, as the part of a fit that is worked on at a time */
#define SAMPLES 32768u /* of the transform, complex: 256 kB */
#define LAPS 4

static const double two_pi = 6.28318530717958647692;

struct probe_work {
  double matrix[ORDER][ORDER];
  float real[SAMPLES], imaginary[SAMPLES];
};

/* A symmetric matrix with a heavy diagonal, so that it has a factor. */
static void fill(struct probe_work *work) {
  for (int i = 0; i < ORDER; i++) {
    for (int k = 0; k <= i; k++) {
      work->matrix[i][k] = i == k ? ORDER : 1.0 / (1.0 + i + k);
    }
  }
  for (unsigned i = 0; i < SAMPLES; i++) {
    work->real[i] = (float)(i % 7u) - 3.0f;
    work->imaginary[i] = 0.0f;
  }
}

static void factorise(double matrix[ORDER][ORDER]) {
  for (int i = 0; i < ORDER; i++) {
    for (int k = 0; k <= i; k++) {
      double sum = matrix[i][k];
      for (int j = 0; j < k; j++) {
        sum -= matrix[i][j] * matrix[k][j];
      }
      matrix[i][k] = i == k ? sqrt(sum) : sum / matrix[k][k];
    }
  }
}

/* Radix 2, decimation in frequency; the result stays in bit-reversed order. */
static void transform(struct probe_work *work) {
  float *re = work->real, *im = work->imaginary;
  for (unsigned half = SAMPLES / 2; half > 0; half /= 2) {
    const double step = -two_pi / (2.0 * half);
    for (unsigned k = 0; k < half; k++) {
      const float c = (float)cos(step * k), s = (float)sin(step * k);
      for (unsigned a = k, b = k + half; b < SAMPLES; a += 2 * half, b += 2 * half) {
        const float x = re[a] - re[b], y = im[a] - im[b];
        re[a] += re[b];
        im[a] += im[b];
        re[b] = c * x - s * y;
        im[b] = c * y + s * x;
      }
    }
  }
}

static double processor_ms(void) {
  struct timespec time = {0};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

double accuracy_probe_ms(void) {
  struct probe_work *work = placido_memory_new(1, sizeof *work, NULL);
  volatile double kept; /* so that no compiler leaves the work out */
  double least_ms = NAN;
  for (int lap = 0; work && lap < LAPS; lap++) {
    fill(work);
    const double begun_ms = processor_ms();
    factorise(work->matrix);
    transform(work);
    const double lap_ms = processor_ms() - begun_ms;
    kept = work->matrix[ORDER - 1][0] + (double)work->real[lap];
    (void)kept;
    least_ms = lap > 0 ? fmin(least_ms, lap_ms) : lap_ms;
  }
  placido_memory_free(work);
  return least_ms;
}
