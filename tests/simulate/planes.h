/* Planes, point spread functions and their convolution summed up, for tests. */
#ifndef PLACIDO_TESTS_SIMULATE_PLANES_H
#define PLACIDO_TESTS_SIMULATE_PLANES_H

#include <placido/convolution.h>

/* Samples in 0..1 that look random; free with free(). */
float *noise_plane(int width, int height, unsigned seed);

/* Buckets in 0..1 that look random and sum to 1, in `values`, n * n. */
placido_psf noise_psf(double *values, int n, unsigned seed);

/* The convolution at one place, summed in double precision. */
double direct_sum(const float *source, int width, int height, const placido_psf *psf, int x, int y);

/* Everything done for one plane: free with free(). Fails the test where a call fails. */
float *convolved_plane(const float *source, int width, int height, const placido_psf *psf,
                       const placido_convolution *how);

/* What rounding may leave in the result, as the root of the sum of its squares: unit roundoff
 * `epsilon` times log2 of the padded samples for each of three transforms (Higham, Accuracy and
 * Stability of Numerical Algorithms, theorem 24.2; its constant is 7 where all errors conspire, and
 * 1 is taken, as they do not). Two of them carry the source's squares at the PSF's gain, at most
 * the sum of its buckets' sizes; one carries the PSF's squares at the source's. */
double rounding_bound(const float *source, int width, int height, const placido_psf *psf,
                      double epsilon);

#endif
