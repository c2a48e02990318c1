/* `placido bench simulate`: the table of its parts. */
#include "acquire/cli/bench_simulate.h"

#include "acquire/cli/bench_focus.h"
#include "acquire/cli/bench_sight.h"

static bench_simulate_part *const parts[] = {bench_rays, bench_waves, bench_spread, bench_focus};

static int run(struct bench_run *bench, placido_error *err) {
  const struct bench_sight *sight;
  int status = bench_sight_get(&sight, bench, err);
  for (size_t i = 0; i < sizeof parts / sizeof *parts && status == PLACIDO_OK; i++) {
    status = parts[i](&bench->report, sight->surface, bench->settings->quick, err);
  }
  return status;
}

const struct bench bench_simulate = {
    .name = "simulate",
    .summary = "rays to the point spread function, its convolution and its search on one core",
    .run = run,
};
