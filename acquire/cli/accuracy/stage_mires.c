/* Mires: what fewer meridians and another filter do to the surface that is fitted to them, with as
 * fine a fit as there is. */
#include "acquire/cli/accuracy/stage.h"

static const char *const settings[] = {
    "meridians=45 filter_px=1",    "meridians=60 filter_px=1",    "meridians=90 filter_px=1",
    "meridians=120 filter_px=1",   "meridians=180 filter_px=1",   "meridians=360 filter_px=1",
    "meridians=720 filter_px=1",   "meridians=360 filter_px=4",   "meridians=360 filter_px=2.8",
    "meridians=360 filter_px=2",   "meridians=360 filter_px=1.4", "meridians=360 filter_px=0.8",
    "meridians=360 filter_px=0.6", "meridians=90 filter_px=1.4",  "meridians=180 filter_px=1.4",
    "meridians=720 filter_px=1.4", "meridians=720 filter_px=0.6", NULL};
static const char *const quick[] = {"meridians=90 filter_px=1", "meridians=180 filter_px=1", NULL};

static int find(struct accuracy_row *row, placido_mires *mires,
                const struct accuracy_trial *trial, placido_error *err) {
  struct accuracy_watch watch = {0};
  int status;
  do {
    placido_mires_free(mires);
    accuracy_watch_begin(&watch);
    status = accuracy_eye_mires(mires, trial->eye, &trial->knobs, err);
    accuracy_watch_end(&watch);
  } while (status == PLACIDO_OK && accuracy_watch_again(&watch, trial->bench));
  row->ms = watch.least_ms;
  return status;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  const struct accuracy_bench *bench = trial->bench;
  placido_mires mires = {0};
  placido_fit *fit = NULL;
  struct accuracy_sight sight = {0};
  int status = find(row, &mires, trial, err);
  if (status == PLACIDO_OK) {
    status = accuracy_eye_fit(&fit, &mires, trial->eye, &bench->finest, err);
  }
  if (status == PLACIDO_OK) {
    status = accuracy_sight_new(&sight, placido_fit_surface(fit), &bench->chart, &bench->finest,
                                err);
  }
  if (status == PLACIDO_OK) {
    status = accuracy_sights_differ(row->error, &sight, &trial->eye->seen, err);
  }
  accuracy_sight_free(&sight);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  return status;
}

const struct accuracy_measure accuracy_measure_mires = {
    .stage = ACCURACY_MIRES, .settings = settings, .quick = quick, .run = run};
