/* Which settings to take: the cheapest that are accurate enough, or the most accurate that are
 * quick enough, as an accuracy table tells it. */
#ifndef PLACIDO_CLI_ACCURACY_CHOOSE_H
#define PLACIDO_CLI_ACCURACY_CHOOSE_H

#include "acquire/cli/accuracy/table.h"

#include <stdbool.h>

struct accuracy_wish {
  double error[ACCURACY_ERRORS]; /* largest that may remain; INFINITY: any */
  double time_ms;                /* INFINITY: any */
  double extra_ms;               /* of the time, on this machine: what the table does not know */
  bool counts[ACCURACY_STAGES];  /* whether a stage runs */
  bool needed[ACCURACY_STAGES];  /* whether nothing can be promised without knowing of it */
  double runs[ACCURACY_STAGES];  /* how often its time does: a trace's once a pupil */
  const char *parts;             /* likewise of the parts of the rest: "maps=1 focus=3" */
  const char *fixed;             /* "knob=value" pairs that are not to be chosen */
  double speed; /* this machine's probe over the table's: times are multiplied by it */
};

struct accuracy_choice {
  char setting[ACCURACY_STAGES][96]; /* every knob named; empty where a stage does not count */
  double error[ACCURACY_ERRORS];     /* promised; NaN where the table does not tell */
  double time_ms;                    /* promised, on this machine; NaN likewise */
  double stage_ms[ACCURACY_STAGES];  /* of which, all its runs together */
};

/* One setting of each stage that counts. What a choice leaves of an error in an eye is at most the
 * sum of what its stages leave, each measured with the others at their finest, and of the floor
 * (triangle inequality); promised is the largest of the table's eyes. Likewise the time is the sum
 * of each stage's largest.
 *
 * With an error's limit: of the choices within all limits the cheapest. With none, the one that
 * remains nearest to the least errors within the time; a hundredth of them is worth no time. A fixed
 * knob that the table does not have takes the worse of the neighbours on either side of it. A stage
 * that is not needed and that the table does not tell of leaves the errors that it makes, and the
 * time, unknown.
 * Returns PLACIDO_OK; PLACIDO_QUALITY: nothing reaches it (the sentence says what can be reached and
 * what limits it), or the table does not tell; PLACIDO_MEMORY. */
int accuracy_choose(struct accuracy_choice *choice, const struct accuracy_table *table,
                    const struct accuracy_wish *wish, placido_error *err);

/* What a setting, written as in the table, takes on this machine (slowest_ms); 0 where the table
 * does not have it. */
double accuracy_setting_ms(const struct accuracy_table *table, enum accuracy_stage stage,
                           const char *setting, double speed);

#endif
