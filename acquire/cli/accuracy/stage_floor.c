/* The floor: what measuring itself costs. Everything at its finest against the true eye; no knob
 * buys more than this. */
#include "acquire/cli/accuracy/stage.h"

static const char *const settings[] = {"knobs=finest", NULL};

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  const struct accuracy_eye *eye = trial->eye;
  struct accuracy_watch watch = {0};
  placido_mires mires = {0};
  placido_fit *fit = NULL;
  accuracy_watch_begin(&watch);
  int status = accuracy_eye_mires(&mires, eye, &trial->bench->finest, err);
  if (status == PLACIDO_OK) {
    status = accuracy_eye_fit(&fit, &mires, eye, &trial->bench->finest, err);
  }
  accuracy_watch_end(&watch);
  placido_fit_free(fit);
  placido_mires_free(&mires);
  row->ms = watch.least_ms;
  return status == PLACIDO_OK
             ? accuracy_sights_differ(row->error, &eye->seen, &eye->true_seen, err)
             : status;
}

const struct accuracy_measure accuracy_measure_floor = {
    .stage = ACCURACY_FLOOR, .settings = settings, .quick = settings, .words = true, .run = run};
