/* How long something takes: laps of wall and processor time. */
#ifndef PLACIDO_CLI_BENCH_TIME_H
#define PLACIDO_CLI_BENCH_TIME_H

#include <stddef.h>

#define BENCH_LAPS_MAX 1024

/* Start with a zeroed struct. Laps beyond the limit are not kept. */
struct bench_laps {
  size_t count;
  double wall_s[BENCH_LAPS_MAX], processor_s[BENCH_LAPS_MAX];
  double wall_began_s, processor_began_s;
};

/* A monotonic clock; processor time of the whole process, all its threads together. */
double bench_wall_s(void);
double bench_processor_s(void);

void bench_lap_begin(struct bench_laps *laps);
void bench_lap_end(struct bench_laps *laps);

/* Of `count` numbers, at least one and at most BENCH_LAPS_MAX. */
double bench_median(const double *values, size_t count);
double bench_most(const double *values, size_t count);

/* Median processor time of `laps` over that of `reference`: others' work on the machine disturbs it
 * less than wall time. */
double bench_ratio(const struct bench_laps *laps, const struct bench_laps *reference);

#endif
