/* A stopwatch with a name for every lap. */
#include "acquire/cli/stages.h"

#include <stdarg.h>
#include <stdio.h>
#include <time.h>

static double read_clock(clockid_t clock) {
  struct timespec time = {0};
  clock_gettime(clock, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static double now(void) { return read_clock(CLOCK_MONOTONIC); }

static double processor_now(void) { return read_clock(CLOCK_PROCESS_CPUTIME_ID); }

void stages_start(struct stages *stages, const char *command, bool progress) {
  *stages = (struct stages){.started = now(), .processor_started_s = processor_now()};
  stages->stage_started = stages->started;
  stages->progress = progress_start(command, progress);
}

static void close_lap(struct stages *stages) {
  const double time = now(), processor_s = processor_now();
  if (stages->count > 0) {
    struct stage *stage = &stages->items[stages->count - 1];
    stage->seconds = time - stages->stage_started;
    stage->processor_s = processor_s - stages->processor_started_s;
  }
  stages->stage_started = time;
  stages->processor_started_s = processor_s;
  stages->total = time - stages->started;
}

void stages_next(struct stages *stages, const char *format, ...) {
  close_lap(stages);
  if (stages->count == STAGES_MAX) {
    stages->count--; /* the last row then holds the last lap: the total stays right */
  }
  struct stage *stage = &stages->items[stages->count++];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(stage->name, sizeof stage->name, format, arguments);
  va_end(arguments);
  stage->seconds = stage->processor_s = 0.0;
  progress_say(stages->progress, stage->name);
}

void stages_end(struct stages *stages) {
  if (stages->ended) {
    return;
  }
  close_lap(stages);
  progress_stop(stages->progress);
  stages->progress = NULL;
  stages->ended = true;
}

void stages_print(const struct stages *stages) {
  double processor_s = 0;
  printf("%-24s %9s %12s\n", "stage", "ms", "processor ms");
  for (size_t i = 0; i < stages->count; i++) {
    const struct stage *stage = &stages->items[i];
    processor_s += stage->processor_s;
    printf("%-24s %9.1f %12.1f\n", stage->name, 1e3 * stage->seconds, 1e3 * stage->processor_s);
  }
  printf("%-24s %9.1f %12.1f\n", "total", 1e3 * stages->total, 1e3 * processor_s);
}

double stages_elapsed(const struct stages *stages) {
  return now() - stages->stage_started;
}
