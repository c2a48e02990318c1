/* What benchmarks found, as a table for people and as JSON for machines. */
#ifndef PLACIDO_CLI_BENCH_REPORT_H
#define PLACIDO_CLI_BENCH_REPORT_H

#include "acquire/cli/bench_time.h"

#include <jansson.h>
#include <placido/status.h>
#include <stddef.h>

/* NaN and NULL where there is none. */
struct bench_figure {
  char what[64];
  const char *unit;
  double value;
  double worst, processor; /* of times: the longest lap; processor time of the median one */
  double ratio;
  const char *against; /* what `ratio` is to */
};

/* The figures of one benchmark after the other. */
struct bench_section {
  const char *name, *summary;
  struct bench_figure *figures;
  size_t count;
  char **lines; /* what no number says */
  size_t line_count;
};

struct bench_report {
  struct bench_section *sections;
  size_t count;
  double load; /* of the last minute, before anything was measured; NaN where unknown */
  long processors;
};

/* What is added from here on belongs to it; both texts are borrowed. */
int bench_report_begin(struct bench_report *report, const char *name, const char *summary,
                       placido_error *err);

/* `figure` is copied, its constants borrowed. */
int bench_report_add(struct bench_report *report, const struct bench_figure *figure,
                     placido_error *err);

/* A plain number; ratio NaN and against NULL where there is nothing to hold it against. */
int bench_report_number(struct bench_report *report, const char *what, double value,
                        const char *unit, double ratio, const char *against, placido_error *err);

/* Laps in milliseconds, and their processor time as a ratio to that of the laps `reference`, called
 * `against` (both may be NULL). */
int bench_report_laps(struct bench_report *report, const char *what, const struct bench_laps *laps,
                      const struct bench_laps *reference, const char *against,
                      placido_error *err);

/* A sentence behind the figures. */
int bench_report_say(struct bench_report *report, placido_error *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

void bench_report_print(const struct bench_report *report);

/* A new reference; NULL when memory is out. */
json_t *bench_report_json(const struct bench_report *report);

void bench_report_free(struct bench_report *report);

#endif
