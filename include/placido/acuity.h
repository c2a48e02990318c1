/* Predicted visual acuity: how small a letter an ideal observer with human contrast sensitivity
 * tells apart from the others of its chart, seen through a point spread function.
 *
 * The model is that of A. B. Watson and A. J. Ahumada, Journal of Vision 8(4):17 (2008): letters
 * pass the optics and a neural filter, white noise is added, and the observer, who knows what every
 * letter looks like through these very optics, names the one that fits best. Two things are added.
 * Noise that grows with the letter's own contrast energy, as in the perceptual template model
 * (Z.-L. Lu, B. A. Dosher, JOSA A 16:764 (1999)): without it small differences between large blurs
 * would be told apart as people cannot. And the PSF of rays has the diffraction of its pupil put
 * in, by the product of the two transfer functions. */
#ifndef PLACIDO_ACUITY_H
#define PLACIDO_ACUITY_H

#include <placido/psf.h>
#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

/* One way to test acuity. */
typedef struct placido_acuity_test {
  const char *name;  /* e, c, c8, sloan */
  const char *title; /* tumbling E ... */
  int choices;
  double criterion;  /* share of right answers that counts as read */
} placido_acuity_test;

/* The tests that this build knows, `*count` rows; and the one called `name`, NULL: none. */
const placido_acuity_test *placido_acuity_tests(size_t *count);
const placido_acuity_test *placido_acuity_test_find(const char *name);

/* How it is computed; zero means the default in brackets. */
typedef struct placido_acuity_options {
  double criterion;          /* share of right answers, between chance and 1 [the test's] */
  double noise;              /* of the observer, in units of contrast times degree times the neural
                                filter's gain [such that mean eyes of 3 to 4 mm have -0.1] */
  double proportional_noise; /* for each unit of the letter's own, up to that of a letter of some
                                minutes; negative: none, Watson and Ahumada's own model [0.16] */
  double observer_spread;    /* standard deviation of the noise among people, decades [0.1] */
  double smallest_logmar, largest_logmar; /* of the chart, -1 to 2.5 [-0.5, 1.7 where both are 0] */
  int trials;  /* 64 to 1,000,000 [4096]; the error that they leave is reported */
  uint64_t seed;
} placido_acuity_options;

/* An observer before a chart: what all PSFs share. Immutable; any number of threads. */
typedef struct placido_observer placido_observer;

/* Free with placido_observer_free. Returns PLACIDO_OK, PLACIDO_INPUT (an option out of range),
 * PLACIDO_MEMORY. `options` may be NULL. */
int placido_observer_new(placido_observer **observer, const placido_acuity_test *test,
                         const placido_acuity_options *options, placido_error *err);
void placido_observer_free(placido_observer *observer);

enum placido_acuity_verdict {
  PLACIDO_ACUITY_FOUND,
  PLACIDO_ACUITY_BEYOND_CHART,  /* worse than bound_logmar, the largest size of the chart */
  PLACIDO_ACUITY_BEYOND_WINDOW, /* worse than bound_logmar: light is lost from the PSF's window,
                                   which does not tell how larger letters look */
  PLACIDO_ACUITY_ALL_READ       /* bound_logmar, the smallest size, is read too */
};

/* Decimal logarithm of the stroke in minutes of arc at which the criterion is met: the least size
 * above which every size, in steps of a tenth, is read. */
typedef struct placido_acuity {
  const placido_acuity_test *test;
  enum placido_acuity_verdict verdict;
  double logmar;         /* NaN unless found, as all that follows */
  double bound_logmar;   /* NaN where it is found */
  double low_logmar, high_logmar; /* 95 % confidence, from `sigma` */
  double sigma;          /* one standard deviation: root of the squares of those known */
  double sigma_trials;   /* what the finite number of trials leaves */
  double sigma_observer; /* observer_spread: people of equal optics differ */
  double sigma_optics;   /* what the variants of the PSF make of it; NaN: none were given */
} placido_acuity;

/* A PSF moved by one independent standard deviation. */
typedef struct placido_acuity_variant {
  const placido_psf *psf;
  double weight; /* of the square of its change: how many of its kind it stands for, 1 or more */
} placido_acuity_variant;

/* The acuity through `psf`, of any bucket: of rays (its pupil's diffraction at 555 nm is
 * put in) or diffraction. The changes that the `count`
 * `variants` (may be NULL) make give sigma_optics: their squares add up to its square.
 * A PSF with buckets of more than a minute of arc cannot tell good acuities apart.
 * The same for every machine and number of threads.
 * Returns PLACIDO_OK (look at the verdict), PLACIDO_INPUT (not a PSF), PLACIDO_MEMORY. */
int placido_acuity_find(placido_acuity *acuity, const placido_observer *observer,
                        const placido_psf *psf, const placido_acuity_variant *variants,
                        size_t count, placido_error *err);

/* Share of right answers at a size: the psychometric function. */
int placido_acuity_score(double *score, const placido_observer *observer, const placido_psf *psf,
                         double logmar, placido_error *err);

/* The denominator of the Snellen fraction 20/x (20) or 6/x (6) of an acuity. */
double placido_acuity_snellen(double logmar, double distance);

/* "logMAR 0.12 ± 0.04 (20/26)", "worse than logMAR 1.70 (20/1002)": at most `size` bytes. */
void placido_acuity_write(char *text, size_t size, const placido_acuity *acuity);

#endif
