/* `placido bench reconstruct`: from one frame to mires, from mires to the surface, and both for the
 * frames of a moving eye. */
#include "acquire/cli/bench_sight.h"
#include "acquire/cli/live_topography.h"
#include "base/memory.h"
#include "reconstruct/solve/engine/conic.h"

#include <math.h>
#include <placido/reconstruct.h>
#include <string.h>

#define REPEATS 24
#define QUICK_REPEATS 2
#define LIVE_FRAMES 150
#define QUICK_LIVE_FRAMES 4
#define KNOT_MM 0.5
#define EVALUATION "one evaluation of residuals"

/* Everything is measured in turn, so that all of it sees the same machine. */
struct laps {
  struct bench_laps reading, evaluation, mires, cold, warm;
  unsigned long sum;
};

/* What one evaluation of the residuals of all points needs: rays that meet the shape already, and a
 * spline on the conicoid that fits them. */
struct evaluation {
  placido_sample *samples;
  placido_sightlines rays;
  placido_grid grid;
  double *coefficients;
  placido_target target;
};

static void evaluation_free(struct evaluation *e) {
  placido_sightlines_free(&e->rays);
  placido_memory_free(e->samples);
  placido_memory_free(e->coefficients);
}

static int evaluation_new(struct evaluation *e, const placido_mires *mires,
                          const struct bench_sight *sight, placido_error *err) {
  const double axis_z_mm = placido_surface_vertex_z_mm(sight->surface);
  *e = (struct evaluation){.grid = placido_grid_covering(5, KNOT_MM, PLACIDO_SPLINE_DEGREE)};
  e->coefficients = placido_memory_new((size_t)e->grid.side * (size_t)e->grid.side,
                                       sizeof *e->coefficients, err);
  int status = e->coefficients ? placido_samples_new(&e->samples, mires, &sight->instrument,
                                                     axis_z_mm, err)
                               : PLACIDO_MEMORY;
  if (status == PLACIDO_OK) {
    status = placido_sightlines_new(&e->rays, e->samples, mires->count, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_sightlines_fit_grid(&e->rays, &e->grid, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_conic_fit(&e->target.base, &e->rays, axis_z_mm, 1, err);
    e->target.grid = &e->grid;
    e->target.coefficients = e->coefficients;
  }
  return status;
}

static int evaluate(struct bench_laps *laps, const placido_mires *mires,
                    const struct bench_sight *sight, placido_error *err) {
  struct evaluation evaluation;
  const int status = evaluation_new(&evaluation, mires, sight, err);
  if (status == PLACIDO_OK) {
    placido_sightlines_trace(&evaluation.rays, &evaluation.target, 1);
    bench_lap_begin(laps);
    placido_sightlines_trace(&evaluation.rays, &evaluation.target, 1);
    bench_lap_end(laps);
  }
  evaluation_free(&evaluation);
  return status;
}

/* One frame's mires and its fit from the beginning, and the one after another's. */
static int repeat(struct laps *laps, const struct bench_sight *sight, int frame,
                  placido_fit **previous, placido_error *err) {
  const placido_mires_options finding = {.threads = 1};
  placido_fit_options fitting = {.axis_z_mm = placido_surface_vertex_z_mm(sight->surface),
                                 .threads = 1};
  placido_mires mires = {0};
  placido_fit *cold = NULL, *warm = NULL;
  laps->sum += bench_sight_read(&laps->reading, &sight->frames[frame]);
  bench_lap_begin(&laps->mires);
  int status = placido_mires_find(&mires, &sight->frames[frame], &sight->instrument, &finding,
                                  NULL, err);
  bench_lap_end(&laps->mires);
  if (status == PLACIDO_OK) {
    status = evaluate(&laps->evaluation, &mires, sight, err);
  }
  if (status == PLACIDO_OK) {
    bench_lap_begin(&laps->cold);
    status = placido_fit_new(&cold, &mires, &sight->instrument, &fitting, NULL, err);
    bench_lap_end(&laps->cold);
  }
  if (status == PLACIDO_OK && *previous) {
    fitting.start = *previous;
    bench_lap_begin(&laps->warm);
    status = placido_fit_new(&warm, &mires, &sight->instrument, &fitting, NULL, err);
    bench_lap_end(&laps->warm);
  }
  placido_fit_free(warm);
  placido_fit_free(*previous);
  *previous = cold;
  placido_mires_free(&mires);
  return status;
}

/* A stage's time, against both yardsticks. */
static int tell_stage(struct bench_run *bench, const char *what, const struct bench_laps *laps,
                      const struct laps *all, placido_error *err) {
  const int status = bench_report_laps(&bench->report, what, laps, &all->reading, BENCH_READING,
                                       err);
  return status == PLACIDO_OK ? bench_report_laps(&bench->report, what, laps, &all->evaluation,
                                                  EVALUATION, err)
                              : status;
}

static int tell(struct bench_run *bench, const struct laps *laps, placido_error *err) {
  int status = bench_sight_report(bench, &laps->reading, laps->sum, err);
  if (status == PLACIDO_OK) {
    status = bench_report_laps(&bench->report, EVALUATION, &laps->evaluation, &laps->reading,
                               BENCH_READING, err);
  }
  if (status == PLACIDO_OK) {
    status = tell_stage(bench, "mires of a frame", &laps->mires, laps, err);
  }
  if (status == PLACIDO_OK) {
    status = tell_stage(bench, "surface with its error bars", &laps->cold, laps, err);
  }
  return status == PLACIDO_OK
             ? tell_stage(bench, "surface from the frame before", &laps->warm, laps, err)
             : status;
}

/* Frame after frame as fast as they are taken, each with the eye elsewhere: two threads, one for
 * the mires and one for the surface. */
static int watch(struct bench_run *bench, const struct bench_sight *sight, placido_error *err) {
  const int frames = bench->settings->quick ? QUICK_LIVE_FRAMES : LIVE_FRAMES;
  struct live_topography *topography;
  struct live_cornea cornea = {0};
  int status = live_topography_open(&topography, &sight->instrument,
                                    placido_surface_vertex_z_mm(sight->surface), err);
  const double began_s = bench_wall_s(), began_processor_s = bench_processor_s();
  for (int i = 0; i < frames && status == PLACIDO_OK; i++) {
    status = live_topography_give(topography, &sight->frames[i % sight->count], err);
    live_topography_wait_taken(topography);
  }
  if (status != PLACIDO_OK) {
    live_topography_close(topography);
    return status;
  }
  live_topography_wait_measured(topography);
  const double wall_s = bench_wall_s() - began_s;
  const double busy = (bench_processor_s() - began_processor_s) / wall_s;
  live_topography_latest(topography, &cornea);
  live_topography_close(topography);
  status = bench_report_number(&bench->report, "live topography", (double)cornea.corneas / wall_s,
                               "frames/s", (double)cornea.corneas / wall_s / 30, "30 frames/s",
                               err);
  return status == PLACIDO_OK ? bench_report_number(&bench->report, "live topography: cores busy",
                                                    busy, "", (double)NAN, NULL, err)
                              : status;
}

static int run(struct bench_run *bench, placido_error *err) {
  const struct bench_sight *sight;
  struct laps *laps = placido_memory_new(1, sizeof *laps, err);
  placido_fit *previous = NULL;
  const int repeats = bench->settings->quick ? QUICK_REPEATS : REPEATS;
  int status = laps ? bench_sight_get(&sight, bench, err) : PLACIDO_MEMORY;
  for (int i = 0; status == PLACIDO_OK && i < repeats; i++) {
    status = repeat(laps, sight, i % sight->count, &previous, err);
  }
  placido_fit_free(previous);
  if (status == PLACIDO_OK) {
    status = tell(bench, laps, err);
  }
  if (status == PLACIDO_OK) {
    status = watch(bench, sight, err);
  }
  placido_memory_free(laps);
  return status;
}

const struct bench bench_reconstruct = {
    .name = "reconstruct",
    .summary = "mires and surface of 1280×1024 frames on one core, live on two",
    .run = run,
};
