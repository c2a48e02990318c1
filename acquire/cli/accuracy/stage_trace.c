/* Rays: what fewer of them, other patterns and counting in place of spreading do to the image of a
 * point, against sixteen million. */
#include "acquire/cli/accuracy/differ.h"
#include "acquire/cli/accuracy/stage.h"
#include "base/memory.h"

#include <math.h>

#define SAMPLES 4000 /* the most that there may be */
#define QUICK_SAMPLES 400

static const char *const settings[] = {
    "samples=25", "samples=35", "samples=50", "samples=71", "samples=100", "samples=141",
    "samples=200", "samples=400", "samples=800", "samples=1600",
    "samples=25 light=counted", "samples=50 light=counted", "samples=100 light=counted",
    "samples=200 light=counted", "samples=400 light=counted", "samples=800 light=counted",
    "samples=1600 light=counted", "samples=50 pattern=equal-area light=counted",
    "samples=200 pattern=equal-area light=counted", "samples=800 pattern=equal-area light=counted",
    "samples=50 pattern=quasi-random light=counted",
    "samples=200 pattern=quasi-random light=counted",
    "samples=800 pattern=quasi-random light=counted", NULL};
static const char *const quick[] = {"samples=50", "samples=100", "samples=100 light=counted", NULL};

struct prepared {
  placido_psf psf;
  placido_image image;
  double logmar;
};

static void release(void *state) {
  struct prepared *prepared = state;
  if (prepared) {
    placido_image_free(&prepared->image);
    placido_psf_free(&prepared->psf);
    placido_memory_free(prepared);
  }
}

static int look(struct prepared *at, const struct accuracy_bench *bench, placido_error *err) {
  const int status = accuracy_chart_see(&at->image, &bench->chart, &at->psf, &bench->finest, err);
  return status == PLACIDO_OK
             ? accuracy_chart_read(&at->logmar, bench->chart.observer, &at->psf, err)
             : status;
}

static int prepare(void **state, const struct accuracy_bench *bench,
                   const struct accuracy_eye *eye, placido_error *err) {
  struct prepared *prepared = *state = placido_memory_new(1, sizeof *prepared, err);
  struct accuracy_knobs knobs = bench->finest;
  knobs.samples = bench->quick ? QUICK_SAMPLES : SAMPLES;
  const int status =
      prepared ? accuracy_sight_trace(&prepared->psf, &eye->seen, &knobs, err) : PLACIDO_MEMORY;
  return status == PLACIDO_OK ? look(prepared, bench, err) : status;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  const struct prepared *reference = trial->prepared;
  struct prepared found = {.logmar = NAN};
  struct accuracy_watch watch = {0};
  int status;
  do {
    placido_psf_free(&found.psf);
    accuracy_watch_begin(&watch);
    status = accuracy_sight_trace(&found.psf, &trial->eye->seen, &trial->knobs, err);
    accuracy_watch_end(&watch);
  } while (status == PLACIDO_OK && accuracy_watch_again(&watch, trial->bench));
  row->ms = watch.least_ms;
  if (status == PLACIDO_OK) {
    status = look(&found, trial->bench, err);
  }
  if (status == PLACIDO_OK) {
    row->error[ACCURACY_IMAGE] = accuracy_differ_images(&found.image, &reference->image);
    row->error[ACCURACY_LOGMAR] = fabs(found.logmar - reference->logmar);
    status = accuracy_differ_psfs(&row->error[ACCURACY_PSF_OTF], &found.psf, &reference->psf, err);
  }
  placido_image_free(&found.image);
  placido_psf_free(&found.psf);
  return status;
}

const struct accuracy_measure accuracy_measure_trace = {.stage = ACCURACY_TRACE,
                                                        .settings = settings,
                                                        .quick = quick,
                                                        .prepare = prepare,
                                                        .run = run,
                                                        .release = release};
