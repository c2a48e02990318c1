/* How often an ideal observer in white noise names the right letter.
 *
 * The picture of letter i and noise n lies nearest to template i, of all, where for every other j
 * <n, t_j - t_i> < |t_j - t_i|² / 2. The products <n, t_j> are normal numbers whose covariance is
 * the templates' Gram matrix: L times independent ones, L its Cholesky factor. The same draws serve
 * every letter, size and PSF, so that scores are comparable to far better than they are known. */
#include "simulate/acuity/observer.h"

#include <math.h>
#include <stdbool.h>

static const double rounding = 1e-10; /* of the largest inner product */

/* The energy at which proportional noise has risen half way, as gain control saturates: a letter
 * that is large and sharp is always read. Chosen with the observer's other two numbers. */
static const double energy_half = 800;

/* Lower factor of a matrix without negative eigenvalues; a letter that is the sum of others gives a
 * row that needs no draw of its own. */
static placido_gram factor(const placido_gram *gram, int count) {
  placido_gram l = {0};
  double largest = 0;
  for (int i = 0; i < count; i++) {
    largest = fmax(largest, gram->values[i][i]);
  }
  for (int j = 0; j < count; j++) {
    double left = gram->values[j][j];
    for (int k = 0; k < j; k++) {
      left -= l.values[j][k] * l.values[j][k];
    }
    if (left <= rounding * largest) {
      continue;
    }
    l.values[j][j] = sqrt(left);
    for (int i = j + 1; i < count; i++) {
      double sum = gram->values[i][j];
      for (int k = 0; k < j; k++) {
        sum -= l.values[i][k] * l.values[j][k];
      }
      l.values[i][j] = sum / l.values[j][j];
    }
  }
  return l;
}

/* Half the squared distances of the letters' pictures. */
static placido_gram distances(const placido_gram *gram, int count) {
  placido_gram d = {0};
  for (int i = 0; i < count; i++) {
    for (int j = 0; j < count; j++) {
      d.values[i][j] =
        0.5 * (gram->values[i][i] + gram->values[j][j]) - gram->values[i][j];
    }
  }
  return d;
}

static bool is_right(const double *noise, const double *half_distance, int i, int count) {
  bool right = true;
  for (int j = 0; j < count; j++) {
    right = right && (j == i || noise[j] - noise[i] < half_distance[j]);
  }
  return right;
}

static int count_right(const double *draws, const placido_gram *l, const placido_gram *half,
                       double noise, int count) {
  double products[PLACIDO_CHOICES_MAX];
  int right = 0;
  for (int i = 0; i < count; i++) {
    double sum = 0;
    for (int k = 0; k <= i; k++) {
      sum += l->values[i][k] * draws[k];
    }
    products[i] = noise * sum;
  }
  for (int i = 0; i < count; i++) {
    right += is_right(products, half->values[i], i, count);
  }
  return right;
}

/* Noise of its own, and noise in proportion to the mean letter's energy. */
static double noise_of(const placido_observer *observer, const placido_gram *gram) {
  const placido_acuity_options *o = &observer->options;
  double energy = 0;
  for (int i = 0; i < observer->choices; i++) {
    energy += gram->values[i][i] / observer->choices;
  }
  double counted = energy / (1 + energy / energy_half);
  return sqrt(o->noise * o->noise + o->proportional_noise * o->proportional_noise * counted);
}

double placido_observer_score(const placido_observer *observer, const placido_gram *gram,
                              double noise_factor, double *sigma) {
  const int count = observer->choices, trials = observer->options.trials;
  const placido_gram l = factor(gram, count), half = distances(gram, count);
  double noise = noise_factor * noise_of(observer, gram);
  long sum = 0, squares = 0;
  for (int trial = 0; trial < trials; trial++) {
    const double *draws = &observer->draws[(size_t)trial * (size_t)count];
    int right = count_right(draws, &l, &half, noise, count);
    sum += right;
    squares += (long)right * right;
  }
  double mean = (double)sum / trials;
  if (sigma != NULL) {
    *sigma = sqrt(fmax((double)squares / trials - mean * mean, 0) / trials) / count;
  }
  return mean / count;
}
