/* The stages of a run and the time of each: by the clock, and of all processors together. */
#ifndef PLACIDO_CLI_STAGES_H
#define PLACIDO_CLI_STAGES_H

#include "acquire/cli/progress.h"

#include <stddef.h>

#define STAGES_MAX 192 /* of every pupil, given or not, its five, and the examination's own */

struct stage {
  char name[32];
  double seconds, processor_s;
};

struct stages {
  size_t count; /* the last one is running until stages_end */
  struct stage items[STAGES_MAX];
  double started, stage_started; /* monotonic seconds */
  double processor_started_s;
  double total;
  bool ended;
  struct progress *progress; /* NULL where nothing is shown */
};

/* Starts the clock of a command's whole run, and shows on a terminal what it is doing where
 * `progress` is wanted. End with stages_end. */
void stages_start(struct stages *stages, const char *command, bool progress);

/* Ends the running stage and begins the next, named like printf does. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void stages_next(struct stages *stages, const char *format, ...);

/* Ends the running stage and the showing; `total` is then the whole run's time. A second call does
 * nothing. */
void stages_end(struct stages *stages);

/* Prints a table to stdout. */
void stages_print(const struct stages *stages);

/* Seconds since the running stage began. */
double stages_elapsed(const struct stages *stages);

#endif
