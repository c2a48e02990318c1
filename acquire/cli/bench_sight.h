/* What benchmarks look at: frames of a normal eye with sensor noise, and the time to read one. */
#ifndef PLACIDO_CLI_BENCH_SIGHT_H
#define PLACIDO_CLI_BENCH_SIGHT_H

#include "acquire/cli/bench.h"

#include <placido/instrument.h>
#include <placido/surface.h>

#define BENCH_FRAMES 16
#define BENCH_FRAME_BYTES (1280.0 * 1024.0)
#define BENCH_READING "reading the frame once"

struct bench_sight {
  placido_surface *surface;
  placido_instrument instrument;
  int count; /* frames: BENCH_FRAMES, or few where it has to be quick */
  placido_frame frames[BENCH_FRAMES]; /* 1280×1024 of 8 bits; in the first the eye is on the axis,
                                         in the others it has moved a little */
};

/* Renders them where this has not been done yet. Borrowed from the run. Returns PLACIDO_OK,
 * PLACIDO_MEMORY. */
int bench_sight_get(const struct bench_sight **sight, struct bench_run *run, placido_error *err);
void bench_sight_free(struct bench_sight *sight);

/* Reads every sample of a frame as one lap: what ratios are held against. Returns their sum, which
 * the caller has to use, so that no compiler leaves the reading out. */
unsigned long bench_sight_read(struct bench_laps *laps, const placido_frame *frame);

/* Adds the laps of reading to the report, and tells in a note where the samples were all black. */
int bench_sight_report(struct bench_run *run, const struct bench_laps *laps, unsigned long sum,
                       placido_error *err);

#endif
