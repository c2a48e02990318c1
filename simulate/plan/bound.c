/* How much of a picture two transfer functions can make differ, from what is known of it.
 *
 * Derived. D is the difference of the transfer functions, f the frequency. A straight edge of
 * height h differs by at most h / pi times the integral of |D| / f over f: it is an integral of the
 * line spread, whose transform is D. A grating of period 1 / f between two lights h apart differs
 * by 2 h / pi times |D(f)|, its first harmonic. A point of light h above what is around it, one
 * sample wide, differs by h times its area times the integral of |D| 2 pi f over f. |D| is less by
 * what the picture's buckets average. Of edges and gratings the worst direction counts, of points
 * their mean.
 * Lights change no more than by the largest step from sample to sample, over half a period by that
 * times its samples, and never by more than their range: so high is h for f.
 *
 * Measured. Pictures are more than one edge: a thin line is two, letters have several side by side,
 * and their errors add up. Edges therefore count `crowding` times. With two, what left out makes a
 * picture differ was 0.2 to 1 times the bound over charts, letters on a screen and houses through
 * pupils of 2 to 7 mm; with one and a half it was up to 1.3 times. */
#include "simulate/plan/sketch.h"

#include <math.h>

static const double pi = 3.14159265358979323846;
static const double half_octave = 0.34657359027997264; /* ln 2 / 2 */
static const double crowding = 2;

/* How differently two transfer functions carry one plane of a picture. */
typedef struct difference {
  double of[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_FREQUENCIES];
} difference;

/* What is left of a frequency when light is averaged over a bucket, in any direction at least. */
static double averaged(double cpd, double bucket_deg) {
  double turns = pi * cpd * bucket_deg;
  return turns < pi ? sin(turns) / turns : 0;
}

static void find_difference(difference *d, const placido_sketch_otf *one,
                            const placido_sketch_otf *other, int plane, double bucket_deg) {
  int a = plane < one->lights ? plane : 0, b = plane < other->lights ? plane : 0;
  for (int direction = 0; direction < PLACIDO_SKETCH_DIRECTIONS; direction++) {
    for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
      double re = (double)one->re[a][direction][k] - (double)other->re[b][direction][k];
      double im = (double)one->im[a][direction][k] - (double)other->im[b][direction][k];
      d->of[direction][k] =
        sqrt(re * re + im * im) * averaged(placido_sketch_frequency_cpd(k), bucket_deg);
    }
  }
}

/* What a plane's lights may do. */
typedef struct relief {
  double range, step;
  double samples_per_degree;
} relief;

/* By how much light may rise and fall again within a period. */
static double height(const relief *plane, double cpd) {
  double samples = fmax(0.5 * plane->samples_per_degree / cpd, 1);
  return fmin(plane->range, plane->step * samples);
}

/* Trapezoidal rule over the logarithm of frequency. */
static double share(int k) {
  return k == 0 || k == PLACIDO_SKETCH_FREQUENCIES - 1 ? half_octave / 2 : half_octave;
}

/* Below the first frequency |D| falls with f. */
static double edge(const double *d, const relief *plane) {
  double sum = d[0] * height(plane, placido_sketch_frequency_cpd(0));
  for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
    sum += share(k) * d[k] * height(plane, placido_sketch_frequency_cpd(k));
  }
  return sum / pi;
}

static double grating(const double *d, const relief *plane) {
  double most = 0;
  for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
    most = fmax(most, 2 / pi * d[k] * height(plane, placido_sketch_frequency_cpd(k)));
  }
  return most;
}

static double point(const double *d, const relief *plane, double bucket_deg) {
  double sum = 0, sample_deg = fmax(1 / plane->samples_per_degree, bucket_deg);
  for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
    double cpd = placido_sketch_frequency_cpd(k);
    sum += share(k) * d[k] * 2 * pi * cpd * cpd;
  }
  return fmin(sum * sample_deg * sample_deg, 1) * plane->step;
}

static double plane_bound(const difference *d, const relief *plane, double bucket_deg) {
  double most = 0, points = 0;
  for (int direction = 0; direction < PLACIDO_SKETCH_DIRECTIONS; direction++) {
    const double *of = d->of[direction];
    most = fmax(most, fmax(crowding * edge(of, plane), grating(of, plane)));
    points += point(of, plane, bucket_deg) / PLACIDO_SKETCH_DIRECTIONS;
  }
  return fmin(fmax(most, points), plane->range);
}

double placido_sketch_bound(const placido_sketch_otf *one, const placido_sketch_otf *other,
                            const placido_facts *facts, const placido_sketch_scale *scale) {
  const int lights = one->lights > other->lights ? one->lights : other->lights;
  difference d;
  double most = 0;
  for (int plane = 0; plane < facts->planes || plane < lights; plane++) {
    int colour = plane < facts->planes ? plane : 0;
    const relief of = {.range = facts->brightest[colour] - facts->darkest[colour],
                       .step = facts->step[colour],
                       .samples_per_degree = 60 / scale->sample_arcmin};
    if (plane == 0 || plane < lights) {
      find_difference(&d, one, other, plane, scale->bucket_arcmin / 60);
    }
    most = fmax(most, plane_bound(&d, &of, scale->bucket_arcmin / 60));
  }
  return fmin(most, 1);
}
