/* Processor time, of which the least of a few laps says most: everything else on the machine can
 * only add to it. */
#include "acquire/cli/accuracy/stage.h"
#include "acquire/cli/bench_time.h"

#include <math.h>

static const double enough_ms = 400;

void accuracy_watch_begin(struct accuracy_watch *watch) {
  watch->begun_s = bench_processor_s();
}

void accuracy_watch_end(struct accuracy_watch *watch) {
  const double ms = 1e3 * (bench_processor_s() - watch->begun_s);
  watch->least_ms = watch->laps > 0 ? fmin(watch->least_ms, ms) : ms;
  watch->all_ms += ms;
  watch->laps++;
}

bool accuracy_watch_again(const struct accuracy_watch *watch, const struct accuracy_bench *bench) {
  return watch->laps < bench->repeats && watch->all_ms < enough_ms;
}
