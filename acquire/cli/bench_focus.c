/* How long a trial of the correction takes, against reading the rays' columns once, and how many
 * trials a search has. */
#include "acquire/cli/bench_focus.h"

#include "simulate/focus.h"
#include "simulate/pencil.h"

#include <stdio.h>

#define REPEATS 15
#define QUICK_REPEATS 2
#define TRIALS 200 /* a lap */
#define PUPIL_MM 6.0
#define READING "200 readings of a trial's columns"

struct laps {
  struct bench_laps reading, trials, search;
};

struct work {
  placido_eye eye;
  placido_apex apex;
  placido_optics optics;
  placido_rays sparse, dense;
  placido_focus focus;
  placido_pencil pencil;
};

static int prepare(struct work *work, const placido_surface *surface, placido_error *err) {
  const placido_eye eye = {.pupil_mm = PUPIL_MM, .correct = PLACIDO_CORRECT_FULL};
  const placido_optics optics = {.samples = 0};
  int status = placido_eye_settle(&work->eye, &eye, err);
  if (status == PLACIDO_OK) {
    status = placido_optics_settle(&work->optics, &optics, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_apex_find(&work->apex, surface, &work->eye, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_rays_new(&work->sparse, surface, &work->apex, &work->eye,
                              PLACIDO_FOCUS_SEARCH_SAMPLES, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_rays_new(&work->dense, surface, &work->apex, &work->eye,
                              PLACIDO_FOCUS_SETTLE_SAMPLES, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_pencil_new(&work->pencil, work->sparse.count, err);
  }
  if (status == PLACIDO_OK) {
    work->focus = (placido_focus){&work->sparse, &work->dense, &work->apex, &work->optics};
    placido_pencil_trace(&work->pencil, &work->sparse, &work->eye);
  }
  return status;
}

static void free_work(struct work *work) {
  placido_pencil_free(&work->pencil);
  placido_rays_free(&work->dense);
  placido_rays_free(&work->sparse);
}

/* The eight columns that a trial reads, added up. */
static float read_columns(const placido_pencil *pencil) {
  float sum = 0;
#pragma omp simd reduction(+ : sum)
  for (size_t i = 0; i < pencil->padded; i++) {
    float across = pencil->change_x[0][i] + pencil->change_x[1][i] + pencil->change_x[2][i];
    float up = pencil->change_y[0][i] + pencil->change_y[1][i] + pencil->change_y[2][i];
    sum += pencil->slope_x[i] + pencil->slope_y[i] + across + up;
  }
  return sum;
}

static int repeat(struct laps *laps, struct work *work, long *trials, placido_error *err) {
  placido_aim aim = {.power_D = {43}};
  double sum = 0;
  bench_lap_begin(&laps->reading);
  for (int i = 0; i < TRIALS; i++) {
    work->pencil.slope_x[0] += 1e-9f; /* so that no compiler reads them only once */
    sum += (double)read_columns(&work->pencil);
  }
  bench_lap_end(&laps->reading);
  bench_lap_begin(&laps->trials);
  for (int i = 0; i < TRIALS; i++) {
    aim.power_D[0] = 43 + 1e-3 * i;
    sum += placido_pencil_gather(&work->pencil, &aim, 1e-4);
  }
  bench_lap_end(&laps->trials);
  placido_eye found = work->eye;
  placido_focus_found figures;
  bench_lap_begin(&laps->search);
  int status = placido_focus_find(&work->focus, &found, &figures, err);
  bench_lap_end(&laps->search);
  *trials = figures.trials;
  return status == PLACIDO_OK && !(sum > 0)
             ? placido_error_set(err, PLACIDO_QUALITY, "the pupil gathers no light")
             : status;
}

static int tell(struct bench_report *report, const struct laps *laps, long trials,
                placido_error *err) {
  char name[80];
  snprintf(name, sizeof name, "search of %ld trials", trials);
  int status = bench_report_laps(report, READING, &laps->reading, NULL, NULL, err);
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, "200 trials of a correction", &laps->trials,
                               &laps->reading, READING, err);
  }
  return status == PLACIDO_OK ? bench_report_laps(report, name, &laps->search, &laps->trials,
                                                  "200 trials", err)
                              : status;
}

int bench_focus(struct bench_report *report, const placido_surface *surface, bool quick,
                placido_error *err) {
  struct work work = {0};
  struct laps laps = {0};
  long trials = 0;
  int status = prepare(&work, surface, err);
  for (int i = 0; status == PLACIDO_OK && i < (quick ? QUICK_REPEATS : REPEATS); i++) {
    status = repeat(&laps, &work, &trials, err);
  }
  if (status == PLACIDO_OK) {
    status = tell(report, &laps, trials, err);
  }
  free_work(&work);
  return status;
}
