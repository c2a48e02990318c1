/* `placido bench live`: what judging every frame costs while a person aligns the instrument. */
#include "acquire/cli/bench_sight.h"
#include "acquire/guide.h"

#define LOOKS 128
#define QUICK_LOOKS 4

/* Looks at frame after frame, as they come, and reads each as well. */
static int look(struct bench_laps *looks, struct bench_laps *readings, unsigned long *sum,
                placido_guide *guide, const struct bench_sight *sight, int count,
                placido_error *err) {
  for (int i = 0; i < count; i++) {
    placido_guidance guidance;
    placido_frame frame = sight->frames[i % sight->count];
    frame.t_ns = (int64_t)i * 33333333;
    frame.seq = (uint64_t)i;
    *sum += bench_sight_read(readings, &frame);
    bench_lap_begin(looks);
    const int status = placido_guide_look(guide, &frame, &guidance, err);
    bench_lap_end(looks);
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static int run(struct bench_run *bench, placido_error *err) {
  const struct bench_sight *sight;
  placido_guide *guide = NULL;
  struct bench_laps looks = {0}, readings = {0};
  unsigned long sum = 0;
  int status = bench_sight_get(&sight, bench, err);
  if (status == PLACIDO_OK) {
    status = placido_guide_new(&guide, &sight->instrument, err);
  }
  if (status == PLACIDO_OK) {
    status = look(&looks, &readings, &sum, guide, sight,
                  bench->settings->quick ? QUICK_LOOKS : LOOKS, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_sight_report(bench, &readings, sum, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(&bench->report, "guidance of a frame", &looks, &readings,
                               BENCH_READING, err);
  }
  placido_guide_free(guide);
  return status;
}

const struct bench bench_live = {
    .name = "live",
    .summary = "guidance while aligning, 1280×1024 on one core",
    .run = run,
};
