/* A benchmark of `placido bench`: a row of the table in bench.c and a file of its own. */
#ifndef PLACIDO_CLI_BENCH_H
#define PLACIDO_CLI_BENCH_H

#include "acquire/cli/bench_report.h"
#include "acquire/cli/command.h"

struct bench_sight;

/* What a benchmark works with. */
struct bench_run {
  const struct settings *settings; /* quick: as little as shows that everything works */
  struct outcome *outcome;
  struct bench_report report;
  struct bench_sight *sight; /* bench_sight_get makes it when it is first wanted */
};

struct bench {
  const char *name, *summary; /* what it measures */
  bool by_name;               /* takes minutes: runs only where it is named */
  /* Adds its figures to run->report. Every claim of speed is a ratio to something measured in the
   * same run. PLACIDO_UNSUPPORTED: this build cannot do it. */
  int (*run)(struct bench_run *run, placido_error *err);
};

extern const struct bench bench_live, bench_reconstruct, bench_record, bench_simulate,
    bench_effects, bench_accuracy;

#endif
