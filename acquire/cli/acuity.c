/* The step that predicts acuity and looks for ghosts through every pupil. */
#include "acquire/cli/acuity.h"

#include "acquire/cli/examination.h"
#include "base/memory.h"

#include <math.h>

/* Of the fit's variants a handful: all are alike draws of the noise, and the geometry's come in the
 * order of what they do. */
#define NOISE_TAKEN 6
#define GEOMETRY_TAKEN 4
#define VARIANTS_MAX (NOISE_TAKEN + GEOMETRY_TAKEN + 1)
#define VARIANT_SAMPLES 100 /* rays a side, spread: an acuity needs no more */

static const char *const default_tests[] = {"e"}; /* as the chart that is shown by default */

/* Other corneas that the measurement leaves open, and what each sees. */
struct others {
  size_t count;
  int numbers[VARIANTS_MAX];
  placido_psf psfs[VARIANTS_MAX];
  placido_acuity_variant variants[VARIANTS_MAX];
};

static struct acuity_wish wish_of(const struct settings *settings) {
  struct acuity_wish wish = settings->acuity;
  if (!wish.none && wish.count == 0) {
    for (size_t i = 0; i < sizeof default_tests / sizeof *default_tests; i++) {
      wish.tests[wish.count++] = placido_acuity_test_find(default_tests[i]);
    }
  }
  return wish;
}

static void choose(struct others *others, const placido_fit *fit) {
  static const int most[PLACIDO_SIGMA_SOURCES] = {[PLACIDO_SIGMA_NOISE] = NOISE_TAKEN,
                                                  [PLACIDO_SIGMA_DISTANCE] = 1,
                                                  [PLACIDO_SIGMA_GEOMETRY] = GEOMETRY_TAKEN};
  int taken[PLACIDO_SIGMA_SOURCES] = {0};
  for (int k = 0; k < placido_fit_variant_count(fit); k++) {
    const enum placido_sigma_source source = placido_fit_variant_source(fit, k);
    if (taken[source]++ < most[source]) {
      const double share = (double)PLACIDO_NOISE_VARIANTS / NOISE_TAKEN;
      others->numbers[others->count] = k;
      others->variants[others->count] =
          (placido_acuity_variant){.psf = &others->psfs[others->count],
                                   .weight = source == PLACIDO_SIGMA_NOISE ? share : 1};
      others->count++;
    }
  }
}

static int see_other(placido_psf *psf, const struct examination *examination,
                     const struct view *view, int number, placido_error *err) {
  const placido_optics optics = {.samples = VARIANT_SAMPLES,
                                 .buckets = view->psf.n,
                                 .bucket_arcmin = view->psf.bucket_arcmin,
                                 .wavelength_nm = view->psf.wavelength_nm,
                                 .grow = 1,
                                 .cwhatuc = examination->settings->cwhatuc,
                                 .threads = 1};
  placido_surface *surface;
  int status = placido_fit_variant(&surface, examination->fit, number, err);
  if (status == PLACIDO_OK) {
    status = placido_psf_new(psf, NULL, surface, &view->eye, &optics, NULL, err);
  }
  placido_surface_free(surface);
  return status;
}

/* None where one of them cannot be seen through: then nothing is known of that sigma. */
static void see_others(struct others *others, const struct examination *examination,
                       const struct view *view) {
  bool whole = true;
  choose(others, examination->fit);
#pragma omp parallel for schedule(dynamic) reduction(&& : whole)
  for (size_t i = 0; i < others->count; i++) {
    const int number = others->numbers[i];
    whole = see_other(&others->psfs[i], examination, view, number, NULL) == PLACIDO_OK && whole;
  }
  if (!whole) {
    for (size_t i = 0; i < others->count; i++) {
      placido_psf_free(&others->psfs[i]);
    }
    others->count = 0;
  }
}

static int read_charts(struct acuity_view *acuity, placido_observer *const *observers, size_t count,
                       const placido_psf *psf, const struct others *others, placido_error *err) {
  int status = PLACIDO_OK;
  size_t failed = count;
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < count; i++) {
    placido_error reason = {0};
    const int ended = placido_acuity_find(&acuity->items[i], observers[i], psf, others->variants,
                                          others->count, &reason);
#pragma omp critical(placido_cli_acuity)
    if (ended != PLACIDO_OK && i < failed) {
      failed = i;
      status = placido_error_set(err, ended, "%s", reason.text);
    }
  }
  acuity->count = count;
  return status;
}

/* Images that lie closer than the stroke of the smallest letter read are one. */
static int find_ghosts(struct acuity_view *acuity, const placido_psf *psf, placido_error *err) {
  const placido_acuity *first = &acuity->items[0];
  const double logmar = isfinite(first->logmar) ? first->logmar : first->bound_logmar;
  const double widest = psf->n * psf->bucket_arcmin / 4;
  const double scale = fmin(fmax(pow(10, logmar), 1), widest);
  return placido_ghosts_find(&acuity->ghosts, psf, scale, err);
}

static int predict(struct examination *examination, struct view *view,
                   placido_observer *const *observers, size_t count, placido_error *err) {
  struct stages *stages = &examination->outcome->stages;
  stages_next(stages, "acuity %.3g mm", view->psf.pupil_mm);
  struct others *others = placido_memory_new(1, sizeof *others, err);
  if (!others) {
    return PLACIDO_MEMORY;
  }
  if (examination->fit) {
    see_others(others, examination, view);
  }
  int status = read_charts(&view->acuity, observers, count, &view->psf, others, err);
  if (status == PLACIDO_OK) {
    status = find_ghosts(&view->acuity, &view->psf, err);
  }
  for (size_t i = 0; i < others->count; i++) {
    placido_psf_free(&others->psfs[i]);
  }
  placido_memory_free(others);
  view->acuity.seconds = stages_elapsed(stages);
  return status;
}

int step_acuity(struct examination *examination, placido_error *err) {
  const struct acuity_wish wish = wish_of(examination->settings);
  struct views *views = &examination->views;
  placido_observer *observers[ACUITY_TESTS_MAX] = {0};
  int status = PLACIDO_OK;
  for (size_t i = 0; i < wish.count && views->count > 0 && status == PLACIDO_OK; i++) {
    status = placido_observer_new(&observers[i], wish.tests[i], NULL, err);
  }
  for (size_t i = 0; i < views->count && wish.count > 0 && status == PLACIDO_OK; i++) {
    status = predict(examination, &views->items[i], observers, wish.count, err);
  }
  for (size_t i = 0; i < wish.count; i++) {
    placido_observer_free(observers[i]);
  }
  return status;
}
