/* A stopwatch with a name for every lap. */
#include "acquire/cli/stages.h"

#include <stdarg.h>
#include <stdio.h>
#include <time.h>

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void stages_start(struct stages *stages, const char *command, bool progress) {
  *stages = (struct stages){.started = now()};
  stages->stage_started = stages->started;
  stages->progress = progress_start(command, progress);
}

static void close_lap(struct stages *stages) {
  const double time = now();
  if (stages->count > 0) {
    stages->items[stages->count - 1].seconds = time - stages->stage_started;
  }
  stages->stage_started = time;
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
  stage->seconds = 0.0;
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
  printf("%-24s %9s\n", "stage", "ms");
  for (size_t i = 0; i < stages->count; i++) {
    printf("%-24s %9.1f\n", stages->items[i].name, 1e3 * stages->items[i].seconds);
  }
  printf("%-24s %9.1f\n", "total", 1e3 * stages->total);
}

double stages_elapsed(const struct stages *stages) {
  return now() - stages->stage_started;
}
