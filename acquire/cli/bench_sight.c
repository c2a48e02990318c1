/* Frames for benchmarks, rendered once: noise is what makes a frame hard to compress and slow to
 * measure, so they have as much as a camera gives in little light. */
#include "acquire/cli/bench_sight.h"

#include "base/memory.h"

#include <placido/phantom.h>

#define QUICK_FRAMES 2
#define NOISE 2.0 /* grey levels: a small sensor at a short exposure */
#define BLUR_PX 0.8
#define STEP_MM 0.01 /* from frame to frame: a steady eye at 30 frames a second */
#define FRAME_NS 33333333

/* Back and forth within 0.03 mm, the first in the middle. */
static double drift_mm(int frame) {
  const int phase = (frame + 3) % 12;
  return STEP_MM * (phase < 6 ? phase - 3 : 9 - phase);
}

static int render(struct bench_sight *sight, int threads, placido_error *err) {
  for (int i = 0; i < sight->count; i++) {
    const placido_disturbance disturbance = {.seed = 1 + (uint64_t)i,
                                             .subsamples = 2,
                                             .blur_px = BLUR_PX,
                                             .noise = NOISE,
                                             .shift_mm = {drift_mm(i), 0.5 * drift_mm(i), 0.0}};
    const int status = placido_phantom_render(&sight->frames[i], sight->surface,
                                              &sight->instrument, &disturbance, threads, err);
    if (status != PLACIDO_OK) {
      return status;
    }
    sight->frames[i].t_ns = (int64_t)i * FRAME_NS;
    sight->frames[i].seq = (uint64_t)i;
  }
  return PLACIDO_OK;
}

int bench_sight_get(const struct bench_sight **sight, struct bench_run *run, placido_error *err) {
  *sight = run->sight;
  if (run->sight) {
    return PLACIDO_OK;
  }
  struct bench_sight *made = placido_memory_new(1, sizeof *made, err);
  if (!made) {
    return PLACIDO_MEMORY;
  }
  made->count = run->settings->quick ? QUICK_FRAMES : BENCH_FRAMES;
  int status = placido_phantom_eye(&made->surface, "normal", err);
  if (status == PLACIDO_OK) {
    status = placido_phantom_instrument(&made->instrument, "cone24", err);
  }
  if (status == PLACIDO_OK) {
    status = render(made, settings_use_threads(run->settings), err);
  }
  if (status != PLACIDO_OK) {
    bench_sight_free(made);
    return status;
  }
  *sight = run->sight = made;
  return PLACIDO_OK;
}

void bench_sight_free(struct bench_sight *sight) {
  if (!sight) {
    return;
  }
  for (int i = 0; i < BENCH_FRAMES; i++) {
    placido_frame_free(&sight->frames[i]);
  }
  placido_surface_free(sight->surface);
  placido_memory_free(sight);
}

unsigned long bench_sight_read(struct bench_laps *laps, const placido_frame *frame) {
  unsigned long sum = 0;
  bench_lap_begin(laps);
  for (int row = 0; row < frame->height_px; row++) {
    const uint8_t *samples = &frame->data[(size_t)row * frame->stride_bytes];
    unsigned row_sum = 0;
#pragma omp simd reduction(+ : row_sum)
    for (int column = 0; column < frame->width_px; column++) {
      row_sum += samples[column];
    }
    sum += row_sum;
  }
  bench_lap_end(laps);
  return sum;
}

int bench_sight_report(struct bench_run *run, const struct bench_laps *laps, unsigned long sum,
                       placido_error *err) {
  if (sum == 0) {
    placido_notes_add(&run->outcome->notes, "the frames are black: times say nothing");
  }
  return bench_report_laps(&run->report, BENCH_READING, laps, NULL, NULL, err);
}
