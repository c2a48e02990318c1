/* How long something takes: the median, which a single disturbance does not move, and the worst. */
#include "acquire/cli/bench_time.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static double clock_s(clockid_t clock) {
  struct timespec time = {0};
  clock_gettime(clock, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

double bench_wall_s(void) {
  return clock_s(CLOCK_MONOTONIC);
}

double bench_processor_s(void) {
  return clock_s(CLOCK_PROCESS_CPUTIME_ID);
}

void bench_lap_begin(struct bench_laps *laps) {
  laps->processor_began_s = bench_processor_s();
  laps->wall_began_s = bench_wall_s();
}

void bench_lap_end(struct bench_laps *laps) {
  const double wall_s = bench_wall_s() - laps->wall_began_s;
  const double processor_s = bench_processor_s() - laps->processor_began_s;
  if (laps->count < BENCH_LAPS_MAX) {
    laps->wall_s[laps->count] = wall_s;
    laps->processor_s[laps->count++] = processor_s;
  }
}

static int compare(const void *left, const void *right) {
  const double a = *(const double *)left, b = *(const double *)right;
  return (a > b) - (a < b);
}

double bench_median(const double *values, size_t count) {
  double sorted[BENCH_LAPS_MAX];
  memcpy(sorted, values, count * sizeof *values);
  qsort(sorted, count, sizeof *sorted, compare);
  return 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

double bench_most(const double *values, size_t count) {
  double most = values[0];
  for (size_t i = 1; i < count; i++) {
    most = values[i] > most ? values[i] : most;
  }
  return most;
}

double bench_ratio(const struct bench_laps *laps, const struct bench_laps *reference) {
  return bench_median(laps->processor_s, laps->count) /
         bench_median(reference->processor_s, reference->count);
}
