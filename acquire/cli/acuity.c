/* The step that predicts acuity and looks for ghosts through every pupil, and tells how sure the
 * image is. */
#include "acquire/cli/acuity.h"

#include "acquire/cli/examination.h"
#include "base/memory.h"

#include <math.h>

/* Corneas drawn from what the measurement leaves open: at the best focus, where every change makes
 * the image worse, the steps of the fit's variants would not add up. */
#define DRAWS 16
#define DRAW_SAMPLES 100 /* rays a side, spread: an acuity needs no more */

static const char *const default_tests[] = {"e"}; /* as the chart that is shown by default */

/* What other corneas that the measurement leaves open see. */
struct others {
  size_t count; /* 0: nothing is known of them */
  placido_psf psfs[DRAWS + 1]; /* the last one is the fitted cornea's, by as few rays */
  placido_acuity_variant variants[DRAWS];
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

static int see_other(placido_psf *psf, const struct examination *examination,
                     const struct view *view, int number, placido_error *err) {
  const placido_optics optics = {.samples = DRAW_SAMPLES,
                                 .buckets = view->psf.n,
                                 .bucket_arcmin = view->psf.bucket_arcmin,
                                 .wavelength_nm = view->psf.wavelength_nm,
                                 .grow = 1,
                                 .cwhatuc = examination->settings->cwhatuc,
                                 .threads = 1};
  placido_surface *drawn = NULL;
  int status =
      number < DRAWS ? placido_fit_draw(&drawn, examination->fit, number, err) : PLACIDO_OK;
  if (status == PLACIDO_OK) {
    status = placido_psf_new(psf, NULL, drawn ? drawn : examination->surface, &view->eye, &optics,
                             NULL, err);
  }
  placido_surface_free(drawn);
  return status;
}

static void free_others(struct others *others) {
  for (size_t i = 0; i <= DRAWS; i++) {
    placido_psf_free(&others->psfs[i]);
  }
  others->count = 0;
}

/* None where one of them cannot be seen through: then nothing is known of that sigma. */
static void see_others(struct others *others, const struct examination *examination,
                       const struct view *view) {
  bool whole = true;
  others->count = DRAWS;
  for (size_t i = 0; i < DRAWS; i++) {
    others->variants[i] =
        (placido_acuity_variant){.psf = &others->psfs[i], .weight = 1.0 / DRAWS};
  }
#pragma omp parallel for schedule(dynamic) reduction(&& : whole)
  for (int i = 0; i <= DRAWS; i++) {
    whole = see_other(&others->psfs[i], examination, view, i, NULL) == PLACIDO_OK && whole;
  }
  if (!whole) {
    free_others(others);
  }
}

/* The root mean square of what the draws change of the Strehl ratio. */
static double strehl_sigma(const struct others *others) {
  double squares = 0;
  for (size_t i = 0; i < others->count; i++) {
    const double change = others->psfs[i].strehl_g - others->psfs[DRAWS].strehl_g;
    squares += change * change;
  }
  return others->count > 0 ? sqrt(squares / (double)others->count) : (double)NAN;
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
  int status = PLACIDO_OK;
  stages_next(stages, "acuity %.3g mm", view->psf.pupil_mm);
  struct others *others = placido_memory_new(1, sizeof *others, err);
  if (!others) {
    return PLACIDO_MEMORY;
  }
  if (examination->fit) {
    see_others(others, examination, view);
  }
  view->strehl_g_sigma = strehl_sigma(others);
  if (count > 0) {
    status = read_charts(&view->acuity, observers, count, &view->psf, others, err);
  }
  if (count > 0 && status == PLACIDO_OK) {
    status = find_ghosts(&view->acuity, &view->psf, err);
  }
  free_others(others);
  placido_memory_free(others);
  view->acuity.seconds = stages_elapsed(stages);
  return status;
}

int step_acuity(struct examination *examination, placido_error *err) {
  const struct acuity_wish wish = wish_of(examination->settings);
  struct views *views = &examination->views;
  const placido_acuity_options options = {.trials = examination->settings->trials};
  placido_observer *observers[ACUITY_TESTS_MAX] = {0};
  int status = PLACIDO_OK;
  for (size_t i = 0; i < wish.count && views->count > 0 && status == PLACIDO_OK; i++) {
    status = placido_observer_new(&observers[i], wish.tests[i], &options, err);
  }
  const bool any = wish.count > 0 || examination->fit;
  for (size_t i = 0; i < views->count && any && status == PLACIDO_OK; i++) {
    status = predict(examination, &views->items[i], observers, wish.count, err);
  }
  for (size_t i = 0; i < wish.count; i++) {
    placido_observer_free(observers[i]);
  }
  return status;
}
