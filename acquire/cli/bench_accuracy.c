/* `placido bench accuracy`: what accuracy costs in time on this machine. */
#include "acquire/cli/accuracy/sweep.h"
#include "acquire/cli/bench.h"
#include "base/file.h"

static int keep(const struct accuracy_table *table, const struct bench_run *bench,
                placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = PLACIDO_OK;
  if (bench->settings->output) {
    status = placido_path_join(path, bench->settings->output, "accuracy.csv", err);
    if (status == PLACIDO_OK) {
      status = accuracy_table_save(table, path, err);
    }
  }
  return status;
}

static int run(struct bench_run *bench, placido_error *err) {
  struct accuracy_table table;
  int status = accuracy_sweep(&table, bench->settings, bench->settings->quick,
                              &bench->outcome->stages, err);
  if (status == PLACIDO_OK) {
    status = keep(&table, bench, err);
  }
  accuracy_table_free(&table);
  return status;
}

const struct bench bench_accuracy = {
    .name = "accuracy",
    .summary = "error against time of every stage and of whole examinations, on eyes easy to hard",
    .by_name = true,
    .run = run,
};
