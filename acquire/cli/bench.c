/* `placido bench`: how fast this machine does what has to keep up with a camera or a person. */
#include "acquire/cli/bench.h"

#include "acquire/cli/bench_sight.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct bench *const benches[] = {&bench_record, &bench_live, &bench_reconstruct,
                                              &bench_simulate, &bench_effects, &bench_accuracy};
#define BENCH_COUNT (sizeof benches / sizeof benches[0])

/* Marks the benchmark of that name. */
static int choose(bool chosen[BENCH_COUNT], const char *name, placido_error *err) {
  for (size_t i = 0; i < BENCH_COUNT; i++) {
    if (strcmp(benches[i]->name, name) == 0) {
      chosen[i] = true;
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, STATUS_USAGE,
                           "there is no benchmark \"%.100s\" (placido help bench lists them)",
                           name);
}

/* Those that were named, or all that do not take minutes. */
static int choose_all(bool chosen[BENCH_COUNT], const struct settings *settings,
                      placido_error *err) {
  for (size_t i = 0; i < BENCH_COUNT; i++) {
    chosen[i] = !settings->input && !benches[i]->by_name;
  }
  int status = settings->input ? choose(chosen, settings->input, err) : PLACIDO_OK;
  for (size_t i = 0; status == PLACIDO_OK && i < settings->more.count; i++) {
    status = choose(chosen, settings->more.values[i], err);
  }
  return status;
}

/* Who shares the processors with others measures them as well. */
static void look_at_machine(struct bench_run *run) {
  struct bench_report *report = &run->report;
  report->processors = sysconf(_SC_NPROCESSORS_ONLN);
  if (getloadavg(&report->load, 1) != 1) {
    report->load = NAN;
  }
  if (report->load > 0.5 * (double)report->processors && !run->settings->quick) {
    placido_notes_add(&run->outcome->notes,
                      "the machine is busy (load %.1f on %ld processors): the figures are worth "
                      "little",
                      report->load, report->processors);
  }
}

/* What this build cannot do fails the run only where it was asked for by name. */
static int run_one(struct bench_run *run, const struct bench *bench, placido_error *err) {
  stages_next(&run->outcome->stages, "%s", bench->name);
  int status = bench_report_begin(&run->report, bench->name, bench->summary, err);
  if (status == PLACIDO_OK) {
    status = bench->run(run, err);
  }
  if (status == PLACIDO_UNSUPPORTED && !run->settings->input) {
    placido_notes_add(&run->outcome->notes, "%s is left out: %s", bench->name, err->text);
    status = PLACIDO_OK;
  }
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  bool chosen[BENCH_COUNT];
  struct bench_run run = {.settings = settings, .outcome = outcome};
  int status = choose_all(chosen, settings, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  look_at_machine(&run);
  for (size_t i = 0; status == PLACIDO_OK && i < BENCH_COUNT; i++) {
    if (chosen[i]) {
      status = run_one(&run, benches[i], err);
    }
  }
  stages_end(&outcome->stages);
  if (status == PLACIDO_OK) {
    outcome->result = bench_report_json(&run.report);
  }
  if (status == PLACIDO_OK && !settings->quiet && !settings->json) {
    bench_report_print(&run.report);
  }
  bench_sight_free(run.sight);
  bench_report_free(&run.report);
  return status;
}

static void list_benches(void) {
  puts("\nBenchmarks");
  for (size_t i = 0; i < BENCH_COUNT; i++) {
    printf("  %-12s %s\n", benches[i]->name, benches[i]->summary);
  }
}

#define FIELD(name) offsetof(struct settings, name)

static const struct option_row rows[] = {
    {"quick", 0, NULL, "As little as shows that everything works; the figures are worth nothing.",
     FIELD(quick), parse_switch, 0, 0},
    {"for", 0, "SECONDS", "record: how long in each codec (default 10).", FIELD(for_s),
     parse_number, 0.1, 3600},
    {"output", 'o', "DIR", "record: the directory in which it writes, and removes what it wrote: "
     "the disk to be measured (default: $TMPDIR, else /tmp). effects: an existing "
     "directory for its table. accuracy: the directory of its table, plots and page.",
     FIELD(output), parse_text, 0, 0},
};

static const struct option_group options_bench = {"Benchmarks", rows,
                                                  sizeof rows / sizeof rows[0]};
static const struct option_group *const groups[] = {&options_bench, &options_general, NULL};

const struct command command_bench = {
    .name = "bench",
    .summary = "Measure how fast this machine records, guides, measures and simulates.",
    .usage = "[NAME...] [OPTION...]",
    .examples = "  placido bench\n"
                "      all benchmarks but accuracy, about a minute\n"
                "  placido bench record --for 60 -o /data\n"
                "      a minute at 60 frames/s in each codec, on the disk of /data\n"
                "  placido bench live reconstruct --json\n"
                "  placido bench accuracy\n"
                "      minutes: what accuracy costs here, for exam --max-error to choose by\n",
    .groups = groups,
    .list = list_benches,
    .may_have_word = true,
    .may_have_more = true,
    .run = run,
};
