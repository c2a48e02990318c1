/* The fit: what wider knots, another degree and an earlier end do to the surface. The mires are the
 * usual ones, of 360 meridians, as the time depends on how many points there are. A knot_mm of 0 is
 * what residuals ask for; all is measured against knots that are finer still. */
#include "acquire/cli/accuracy/stage.h"
#include "base/memory.h"

#include <string.h>

#define FINER 0.8 /* of the knots that residuals ask for */

static const char *const settings[] = {
    "knot_mm=2 degree=5 tolerance=0",     "knot_mm=1.5 degree=5 tolerance=0",
    "knot_mm=1 degree=5 tolerance=0",     "knot_mm=0.75 degree=5 tolerance=0",
    "knot_mm=0.5 degree=5 tolerance=0",   "knot_mm=0.35 degree=5 tolerance=0",
    "knot_mm=0.25 degree=5 tolerance=0",  "knot_mm=0 degree=5 tolerance=0",
    "knot_mm=1.5 degree=3 tolerance=0",   "knot_mm=1 degree=3 tolerance=0",
    "knot_mm=0.75 degree=3 tolerance=0",  "knot_mm=0.5 degree=3 tolerance=0",
    "knot_mm=0.35 degree=3 tolerance=0",  "knot_mm=0.25 degree=3 tolerance=0",
    "knot_mm=0 degree=3 tolerance=0",     "knot_mm=0 degree=5 tolerance=1",
    "knot_mm=0 degree=5 tolerance=0.1",   "knot_mm=0 degree=5 tolerance=0.01",
    "knot_mm=0 degree=5 tolerance=0.001", "knot_mm=0 degree=5 tolerance=1e-6",
    "knot_mm=1 degree=3 tolerance=1",     "knot_mm=0.75 degree=3 tolerance=0.1",
    "knot_mm=0.5 degree=5 tolerance=0.1", NULL};
static const char *const quick[] = {"knot_mm=1 degree=5 tolerance=0",
                                    "knot_mm=0 degree=5 tolerance=0", NULL};

struct prepared {
  placido_mires mires;
  placido_fit *fit;
  struct accuracy_sight sight;
};

static void release(void *state) {
  struct prepared *prepared = state;
  if (prepared) {
    accuracy_sight_free(&prepared->sight);
    placido_fit_free(prepared->fit);
    placido_mires_free(&prepared->mires);
    placido_memory_free(prepared);
  }
}

/* A fit marks its mires: each gets its own. */
static int copy_mires(placido_mires *copy, const placido_mires *mires, placido_error *err) {
  const size_t size = sizeof *mires->points;
  *copy = *mires;
  copy->points = placido_memory_new(mires->count, size, err);
  copy->doubtful = placido_memory_new(mires->doubtful_count, size, err);
  if (!copy->points || !copy->doubtful) {
    placido_mires_free(copy);
    return PLACIDO_MEMORY;
  }
  memcpy(copy->points, mires->points, mires->count * size);
  if (mires->doubtful_count > 0) {
    memcpy(copy->doubtful, mires->doubtful, mires->doubtful_count * size);
  }
  return PLACIDO_OK;
}

static int fit_lap(placido_fit **fit, struct accuracy_watch *watch, const placido_mires *mires,
                   const struct accuracy_eye *eye, const struct accuracy_knobs *knobs,
                   placido_error *err) {
  placido_mires own = {0};
  *fit = NULL;
  int status = copy_mires(&own, mires, err);
  if (status == PLACIDO_OK) {
    accuracy_watch_begin(watch);
    status = accuracy_eye_fit(fit, &own, eye, knobs, err);
    accuracy_watch_end(watch);
  }
  placido_mires_free(&own);
  return status;
}

static int prepare(void **state, const struct accuracy_bench *bench,
                   const struct accuracy_eye *eye, placido_error *err) {
  struct prepared *prepared = *state = placido_memory_new(1, sizeof *prepared, err);
  struct accuracy_knobs usual = {.meridians = 0};
  struct accuracy_knobs finer = bench->finest;
  struct accuracy_watch watch = {0};
  finer.knot_mm = FINER * placido_fit_summary_get(eye->fit).knot_mm;
  int status = prepared ? accuracy_eye_mires(&prepared->mires, eye, &usual, err) : PLACIDO_MEMORY;
  if (status == PLACIDO_OK) {
    status = fit_lap(&prepared->fit, &watch, &prepared->mires, eye, &finer, err);
  }
  return status == PLACIDO_OK
             ? accuracy_sight_new(&prepared->sight, placido_fit_surface(prepared->fit),
                                  &bench->chart, &bench->finest, err)
             : status;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  const struct accuracy_bench *bench = trial->bench;
  const struct prepared *prepared = trial->prepared;
  struct accuracy_watch watch = {0};
  struct accuracy_sight sight = {0};
  placido_fit *fit = NULL;
  int status;
  do {
    placido_fit_free(fit);
    status = fit_lap(&fit, &watch, &prepared->mires, trial->eye, &trial->knobs, err);
  } while (status == PLACIDO_OK && accuracy_watch_again(&watch, bench));
  row->ms = watch.least_ms;
  if (status == PLACIDO_OK) {
    status = accuracy_sight_new(&sight, placido_fit_surface(fit), &bench->chart, &bench->finest,
                                err);
  }
  if (status == PLACIDO_OK) {
    status = accuracy_sights_differ(row->error, &sight, &prepared->sight, err);
  }
  accuracy_sight_free(&sight);
  placido_fit_free(fit);
  return status;
}

const struct accuracy_measure accuracy_measure_fit = {.stage = ACCURACY_FIT,
                                                      .settings = settings,
                                                      .quick = quick,
                                                      .prepare = prepare,
                                                      .run = run,
                                                      .release = release};
