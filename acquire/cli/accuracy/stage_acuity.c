/* Acuity: what chance leaves of it with fewer trials. An error is the root mean square over a few
 * seeds, as one alone may happen to be right. */
#include "acquire/cli/accuracy/stage.h"
#include "base/memory.h"

#include <math.h>

#define TRIALS 262144
#define QUICK_TRIALS 4096
#define SEEDS 4

static const char *const settings[] = {"trials=256",   "trials=512",  "trials=1024",
                                       "trials=2048",  "trials=4096", "trials=8192",
                                       "trials=16384", "trials=65536", NULL};
static const char *const quick[] = {"trials=256", "trials=1024", NULL};

static void release(void *prepared) { placido_memory_free(prepared); }

/* With so many trials, those of one seed. */
static int read_chart(double *logmar, const struct accuracy_eye *eye, int trials, uint64_t seed,
                      struct accuracy_watch *watch, placido_error *err) {
  const placido_acuity_options options = {.trials = trials, .seed = seed};
  placido_observer *observer;
  int status = placido_observer_new(&observer, placido_acuity_test_find("e"), &options, err);
  if (status == PLACIDO_OK) {
    accuracy_watch_begin(watch);
    status = accuracy_chart_read(logmar, observer, &eye->seen.psf, err);
    accuracy_watch_end(watch);
  }
  placido_observer_free(observer);
  return status;
}

static int prepare(void **state, const struct accuracy_bench *bench,
                   const struct accuracy_eye *eye, placido_error *err) {
  double *logmar = *state = placido_memory_new(1, sizeof *logmar, err);
  struct accuracy_watch watch = {0};
  return logmar ? read_chart(logmar, eye, bench->quick ? QUICK_TRIALS : TRIALS, 0, &watch, err)
                : PLACIDO_MEMORY;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  const double *expected = trial->prepared;
  struct accuracy_watch watch = {0};
  double sum = 0;
  int status = PLACIDO_OK;
  for (uint64_t seed = 1; seed <= SEEDS && status == PLACIDO_OK; seed++) {
    double logmar = NAN;
    status = read_chart(&logmar, trial->eye, trial->knobs.trials, seed, &watch, err);
    sum += (logmar - *expected) * (logmar - *expected);
  }
  row->error[ACCURACY_LOGMAR] = sqrt(sum / SEEDS);
  row->ms = watch.least_ms;
  return status;
}

const struct accuracy_measure accuracy_measure_acuity = {.stage = ACCURACY_ACUITY,
                                                         .settings = settings,
                                                         .quick = quick,
                                                         .prepare = prepare,
                                                         .run = run,
                                                         .release = release};
