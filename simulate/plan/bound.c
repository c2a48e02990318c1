/* How much of a picture two transfer functions can make differ, from what is known of it.
 *
 * Derived. D is the difference of the transfer functions, f the frequency. Beside a straight edge of
 * height h light differs by e(x) = h / pi times the integral of
 * (Re D sin(2 pi f x) + Im D cos(2 pi f x)) / f over f: an integral of the line spread, whose
 * transform is D. A bar has two edges, which differ by no more than the largest e less the least. A
 * grating of period 1 / f between two lights h apart differs by 2 h / pi times |D(f)|, its first
 * harmonic. A point of light h above what is around it, one sample wide, differs by h times its area
 * times the integral of |D| 2 pi f over f. D is less by what the picture's buckets average. Of edges
 * and gratings the worst direction counts, of points their mean.
 * Lights change no more than by the largest step from sample to sample, over half a period by that
 * times its samples, and never by more than their range: so high is h for f.
 *
 * Measured. Pictures are more than one bar: letters have several side by side, and errors add up;
 * and a sketch of a hundred rays knows no more of an irregular eye. Bars therefore count `crowding`
 * times (tests/simulate/test_effects_grid.c, docs/effects.md). */
#include "simulate/plan/sketch.h"

#include <math.h>

static const double pi = 3.14159265358979323846;
static const double half_octave = 0.34657359027997264; /* ln 2 / 2 */
static const double crowding = 1.5;

/* Integrals over the logarithm of frequency, an eighth of an octave at a time, at places a quarter
 * of an octave apart: so phases are as many steps along one row. Beyond some turns the sine's mean
 * counts, which is 0. */
enum {
  FINER = 4,
  STEPS = FINER * (PLACIDO_SKETCH_FREQUENCIES - 1) + 1,
  PLACES = 40,
  APART = 2,
  PHASES = STEPS + APART * PLACES
};
static const double first_phase = 0.002, last_phase = 20;

/* How differently two transfer functions carry one plane of a picture. */
typedef struct difference {
  double re[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_FREQUENCIES];
  double im[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_FREQUENCIES];
  double of[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_FREQUENCIES]; /* their moduli */
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
      double left = averaged(placido_sketch_frequency_cpd(k), bucket_deg);
      d->re[direction][k] = re * left;
      d->im[direction][k] = im * left;
      d->of[direction][k] = sqrt(re * re + im * im) * left;
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

/* Sines and cosines of rising phases. */
typedef struct phases {
  double sine[PHASES], cosine[PHASES];
} phases;

static void find_phases(phases *p) {
  for (int i = 0; i < PHASES; i++) {
    double phase = first_phase * exp2(0.5 / FINER * i);
    p->sine[i] = phase < last_phase ? sin(phase) : 0;
    p->cosine[i] = phase < last_phase ? cos(phase) : 0;
  }
}

/* D between its frequencies, with the edge's height and the step of the integral. */
static void refine(double fine[STEPS], const double *d, const relief *plane) {
  for (int i = 0; i < STEPS; i++) {
    int k = i / FINER < PLACIDO_SKETCH_FREQUENCIES - 1 ? i / FINER : PLACIDO_SKETCH_FREQUENCIES - 2;
    double part = (double)i / FINER - k;
    double cpd = placido_sketch_frequency_cpd(k) * exp2(0.5 * part);
    double step = i == 0 || i == STEPS - 1 ? 0.5 : 1;
    fine[i] = step * half_octave / FINER * height(plane, cpd) / pi * (d[k] + part * (d[k + 1] - d[k]));
  }
}

/* The bar whose edges are worst: on one side of an edge sines count, on the other they count
 * against. */
static double bar(const double *re, const double *im, const relief *plane, const phases *p) {
  double even[STEPS], odd[STEPS], most = 0, least = 0;
  refine(even, re, plane);
  refine(odd, im, plane);
  for (int place = 0; place < PLACES; place++) {
    double sines = 0, cosines = 0;
    for (int i = 0; i < STEPS; i++) {
      sines += even[i] * p->sine[i + APART * place];
      cosines += odd[i] * p->cosine[i + APART * place];
    }
    most = fmax(most, cosines + fabs(sines));
    least = fmin(least, cosines - fabs(sines));
  }
  return most - least;
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

static double plane_bound(const difference *d, const relief *plane, const phases *p,
                          double bucket_deg) {
  double most = 0, points = 0;
  for (int direction = 0; direction < PLACIDO_SKETCH_DIRECTIONS; direction++) {
    const double *of = d->of[direction];
    double bars = bar(d->re[direction], d->im[direction], plane, p);
    most = fmax(most, fmax(crowding * bars, grating(of, plane)));
    points += point(of, plane, bucket_deg) / PLACIDO_SKETCH_DIRECTIONS;
  }
  return fmin(fmax(most, points), plane->range);
}

double placido_sketch_bound(const placido_sketch_otf *one, const placido_sketch_otf *other,
                            const placido_facts *facts, const placido_sketch_scale *scale) {
  const int lights = one->lights > other->lights ? one->lights : other->lights;
  difference d;
  phases p;
  double most = 0;
  find_phases(&p);
  for (int plane = 0; plane < facts->planes || plane < lights; plane++) {
    int colour = plane < facts->planes ? plane : 0;
    const relief of = {.range = facts->brightest[colour] - facts->darkest[colour],
                       .step = facts->step[colour],
                       .samples_per_degree = 60 / scale->sample_arcmin};
    if (plane == 0 || plane < lights) {
      find_difference(&d, one, other, plane, scale->bucket_arcmin / 60);
    }
    most = fmax(most, plane_bound(&d, &of, &p, scale->bucket_arcmin / 60));
  }
  return fmin(most, 1);
}
