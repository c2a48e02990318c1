/* The size at which the share of right answers meets the criterion, and how sure it is. */
#include "base/memory.h"
#include "simulate/acuity/observer.h"

#include <math.h>
#include <stdio.h>

static const double coarse_step = 0.1;     /* from size to size on the way down, logMAR */
static const double tolerance = 5e-4;      /* of the size */
static const double slope_step = 0.02;     /* either way */
static const double noise_step = 0.05;     /* decades either way */
static const double lost_told = 0.02;      /* share of light beyond which the window limits */
static const double confidence_95 = 1.959964;

/* One PSF before one observer. */
typedef struct viewing {
  const placido_observer *observer;
  placido_lags lags;
  placido_sight *sight;
} viewing;

static int view(viewing *v, const placido_observer *observer, const placido_psf *psf,
                placido_error *err) {
  *v = (viewing){.observer = observer};
  v->sight = placido_memory_new(1, sizeof *v->sight, err);
  return v->sight == NULL ? PLACIDO_MEMORY : placido_lags_new(&v->lags, psf, err);
}

static void view_end(viewing *v) {
  placido_memory_free(v->sight);
  placido_lags_free(&v->lags);
}

static double score(const viewing *v, double logmar, double noise_factor, double *sigma) {
  placido_gram gram;
  placido_observer_look(&gram, v->observer, &v->lags, pow(10, logmar), v->sight);
  return placido_observer_score(v->observer, &gram, noise_factor, sigma);
}

static double excess(const viewing *v, double logmar) {
  return score(v, logmar, 1, NULL) - v->observer->options.criterion;
}

/* A letter may be half as high as a window that light is lost from: what falls outside then lies
 * beyond the letter and takes from its contrast only. */
static double largest_size(const viewing *v, enum placido_acuity_verdict *beyond) {
  double chart = v->observer->options.largest_logmar;
  double window = log10(v->lags.window_arcmin / 10);
  bool limits = v->lags.lost > lost_told && window < chart;
  *beyond = limits ? PLACIDO_ACUITY_BEYOND_WINDOW : PLACIDO_ACUITY_BEYOND_CHART;
  return limits ? fmax(window, v->observer->options.smallest_logmar) : chart;
}

/* Between an unread and a read size: regula falsi with halving (Illinois), Dowell and Jarratt, BIT
 * 11 (1971) 168. */
static double close_in(const viewing *v, double low, double at_low, double high, double at_high) {
  int side = 0;
  while (high - low > tolerance) {
    double middle = (low * at_high - high * at_low) / (at_high - at_low);
    middle = fmin(fmax(middle, low + 0.1 * tolerance), high - 0.1 * tolerance);
    double at = excess(v, middle);
    if (fabs(at) < 0.1 * tolerance) {
      return middle;
    }
    if (at < 0) {
      low = middle;
      at_low = at;
      at_high *= side < 0 ? 0.5 : 1;
      side = -1;
    } else {
      high = middle;
      at_high = at;
      at_low *= side > 0 ? 0.5 : 1;
      side = 1;
    }
  }
  return (low + high) / 2;
}

static enum placido_acuity_verdict search(const viewing *v, double *logmar) {
  enum placido_acuity_verdict beyond;
  double smallest = v->observer->options.smallest_logmar;
  double high = largest_size(v, &beyond), at_high = excess(v, high);
  *logmar = high;
  if (at_high < 0) {
    return beyond;
  }
  while (high > smallest) {
    double low = fmax(high - coarse_step, smallest), at_low = excess(v, low);
    if (at_low < 0) {
      *logmar = close_in(v, low, at_low, high, at_high);
      return PLACIDO_ACUITY_FOUND;
    }
    high = low;
    at_high = at_low;
  }
  *logmar = smallest;
  return PLACIDO_ACUITY_ALL_READ;
}

/* Errors of the score and of the noise, by the slope of the score, are errors of the size. */
static void find_sigmas(placido_acuity *acuity, const viewing *v) {
  double sigma, per_logmar, per_decade;
  double at = acuity->logmar;
  score(v, at, 1, &sigma);
  per_logmar = (score(v, at + slope_step, 1, NULL) - score(v, at - slope_step, 1, NULL)) /
               (2 * slope_step);
  double quiet = pow(10, -noise_step), loud = pow(10, noise_step);
  per_decade = (score(v, at, quiet, NULL) - score(v, at, loud, NULL)) / (2 * noise_step);
  per_logmar = fmax(per_logmar, 0.1); /* next to a plateau the slope says nothing */
  acuity->sigma_trials = sigma / per_logmar;
  acuity->sigma_observer = v->observer->options.observer_spread * fabs(per_decade) / per_logmar;
}

/* A variant's size is next to the one that is known, nearly always. */
static enum placido_acuity_verdict search_near(const viewing *v, double known, double *logmar) {
  double low = known - coarse_step / 2, high = known + coarse_step / 2;
  double at_low = excess(v, low), at_high = excess(v, high);
  if (at_low < 0 && at_high >= 0) {
    *logmar = close_in(v, low, at_low, high, at_high);
    return PLACIDO_ACUITY_FOUND;
  }
  return search(v, logmar);
}

static int vary(double *change, const placido_acuity *acuity, const placido_observer *observer,
                const placido_psf *variant, placido_error *err) {
  viewing v;
  double logmar;
  *change = NAN;
  int status = view(&v, observer, variant, err);
  if (status == PLACIDO_OK && search_near(&v, acuity->logmar, &logmar) == PLACIDO_ACUITY_FOUND) {
    *change = logmar - acuity->logmar;
  }
  view_end(&v);
  return status;
}

static void finish(placido_acuity *acuity) {
  double optics = isnan(acuity->sigma_optics) ? 0 : acuity->sigma_optics;
  acuity->sigma = sqrt(acuity->sigma_trials * acuity->sigma_trials +
                       acuity->sigma_observer * acuity->sigma_observer + optics * optics);
  acuity->low_logmar = acuity->logmar - confidence_95 * acuity->sigma;
  acuity->high_logmar = acuity->logmar + confidence_95 * acuity->sigma;
}

static const placido_acuity unknown = {.logmar = NAN, .bound_logmar = NAN, .low_logmar = NAN,
                                       .high_logmar = NAN, .sigma = NAN, .sigma_trials = NAN,
                                       .sigma_observer = NAN, .sigma_optics = NAN};

static int find(placido_acuity *acuity, const viewing *v, const placido_acuity_variant *variants,
                size_t count, placido_error *err) {
  double logmar, squares = 0;
  acuity->verdict = search(v, &logmar);
  if (acuity->verdict != PLACIDO_ACUITY_FOUND) {
    acuity->bound_logmar = logmar;
    return PLACIDO_OK;
  }
  acuity->logmar = logmar;
  find_sigmas(acuity, v);
  for (size_t i = 0; i < count; i++) {
    double change;
    int status = vary(&change, acuity, v->observer, variants[i].psf, err);
    if (status != PLACIDO_OK) {
      return status;
    }
    squares += variants[i].weight * change * change;
  }
  acuity->sigma_optics = count > 0 ? sqrt(squares) : (double)NAN;
  finish(acuity);
  return PLACIDO_OK;
}

int placido_acuity_find(placido_acuity *acuity, const placido_observer *observer,
                        const placido_psf *psf, const placido_acuity_variant *variants,
                        size_t count, placido_error *err) {
  viewing v;
  *acuity = unknown;
  acuity->test = observer->test;
  int status = view(&v, observer, psf, err);
  if (status == PLACIDO_OK) {
    status = find(acuity, &v, variants, count, err);
  }
  view_end(&v);
  if (status != PLACIDO_OK) {
    *acuity = unknown;
    acuity->test = observer->test;
  }
  return status;
}

int placido_acuity_score(double *share, const placido_observer *observer, const placido_psf *psf,
                         double logmar, placido_error *err) {
  viewing v;
  *share = NAN;
  if (!(logmar >= -1 && logmar <= 2.5)) {
    return placido_error_set(err, PLACIDO_INPUT, "acuity: size logMAR %g is not within -1 to 2.5",
                             logmar);
  }
  int status = view(&v, observer, psf, err);
  if (status == PLACIDO_OK) {
    *share = score(&v, logmar, 1, NULL);
  }
  view_end(&v);
  return status;
}

double placido_acuity_snellen(double logmar, double distance) {
  return distance * pow(10, logmar);
}

void placido_acuity_write(char *text, size_t size, const placido_acuity *acuity) {
  double bound = placido_acuity_snellen(acuity->bound_logmar, 20);
  switch (acuity->verdict) {
    case PLACIDO_ACUITY_FOUND:
      snprintf(text, size, "logMAR %.2f ± %.2f (20/%.0f)", acuity->logmar, acuity->sigma,
               placido_acuity_snellen(acuity->logmar, 20));
      return;
    case PLACIDO_ACUITY_BEYOND_CHART:
      snprintf(text, size, "worse than logMAR %.2f (20/%.0f), the chart's largest",
               acuity->bound_logmar, bound);
      return;
    case PLACIDO_ACUITY_BEYOND_WINDOW:
      snprintf(text, size, "worse than logMAR %.2f (20/%.0f), all that the PSF's window can tell",
               acuity->bound_logmar, bound);
      return;
    case PLACIDO_ACUITY_ALL_READ:
      snprintf(text, size, "better than logMAR %.2f (20/%.0f), the chart's smallest",
               acuity->bound_logmar, bound);
      return;
  }
}
