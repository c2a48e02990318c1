/* `placido bench reconstruct`: from one frame to mires, and from mires to the surface. */
#include "acquire/cli/bench_sight.h"

#include <placido/reconstruct.h>

#define REPEATS 15
#define QUICK_REPEATS 2

struct laps {
  struct bench_laps reading, mires, fit;
  unsigned long sum;
};

/* Finds and fits once; the frame is read in between, so that all three see the same machine. */
static int repeat(struct laps *laps, const struct bench_sight *sight, placido_error *err) {
  const placido_frame *frame = &sight->frames[0];
  const placido_mires_options finding = {.threads = 1};
  const placido_fit_options fitting = {
      .axis_z_mm = placido_surface_vertex_z_mm(sight->surface), .threads = 1};
  placido_mires mires = {0};
  placido_fit *fit = NULL;
  laps->sum += bench_sight_read(&laps->reading, frame);
  bench_lap_begin(&laps->mires);
  int status = placido_mires_find(&mires, frame, &sight->instrument, &finding, NULL, err);
  bench_lap_end(&laps->mires);
  if (status == PLACIDO_OK) {
    bench_lap_begin(&laps->fit);
    status = placido_fit_new(&fit, &mires, &sight->instrument, &fitting, NULL, err);
    bench_lap_end(&laps->fit);
  }
  placido_fit_free(fit);
  placido_mires_free(&mires);
  return status;
}

static int tell(struct bench_run *bench, const struct laps *laps, placido_error *err) {
  int status = bench_sight_report(bench, &laps->reading, laps->sum, err);
  if (status == PLACIDO_OK) {
    status = bench_report_laps(&bench->report, "mires of a frame", &laps->mires, &laps->reading,
                               BENCH_READING, err);
  }
  return status == PLACIDO_OK
             ? bench_report_laps(&bench->report, "surface with its error bars", &laps->fit,
                                 &laps->reading, BENCH_READING, err)
             : status;
}

static int run(struct bench_run *bench, placido_error *err) {
  const struct bench_sight *sight;
  struct laps laps = {0};
  const int repeats = bench->settings->quick ? QUICK_REPEATS : REPEATS;
  int status = bench_sight_get(&sight, bench, err);
  for (int i = 0; status == PLACIDO_OK && i < repeats; i++) {
    status = repeat(&laps, sight, err);
  }
  return status == PLACIDO_OK ? tell(bench, &laps, err) : status;
}

const struct bench bench_reconstruct = {
    .name = "reconstruct",
    .summary = "mires and surface of one 1280×1024 frame on one core",
    .run = run,
};
