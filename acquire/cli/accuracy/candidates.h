/* What there is to choose from: the settings of one stage, with what each leaves in every eye. */
#ifndef PLACIDO_CLI_ACCURACY_CANDIDATES_H
#define PLACIDO_CLI_ACCURACY_CANDIDATES_H

#include "acquire/cli/accuracy/table.h"

#include <stdbool.h>

#define ACCURACY_EYES_MAX 64

/* The times of the two eyes that take longest. */
struct slowest {
  double first_ms, second_ms;
  size_t eyes;
};

void slowest_add(struct slowest *slowest, double ms);

/* The longest; of what is seen, where there are enough eyes, the second: the window of one eye's
 * point spread function may have grown, which that of an examination does not. */
double slowest_ms(const struct slowest *slowest, enum accuracy_stage stage);

struct candidate {
  char setting[96];
  struct slowest slowest;
  double ms; /* that counts */
  bool measured[ACCURACY_EYES_MAX];
  double error[ACCURACY_EYES_MAX][ACCURACY_ERRORS]; /* 0 where it leaves none */
};

struct candidates {
  struct candidate *items;
  size_t count;
};

/* The largest error of elevation that leaves an eye measurable, micrometres. Where even the finest
 * settings are further from the truth the cornea folds the mires: an examination tells that, and
 * what is promised is for others. */
#define ACCURACY_MEASURABLE_UM 1.0

bool table_eye_measurable(const struct accuracy_table *table, const char *eye);

/* The names of the table's eyes that can be measured, borrowed. */
struct table_eyes {
  const char *names[ACCURACY_EYES_MAX];
  size_t count;
};

/* PLACIDO_QUALITY where there are more than ACCURACY_EYES_MAX, or none. */
int table_eyes_list(struct table_eyes *eyes, const struct accuracy_table *table,
                    placido_error *err);

/* The settings of a stage, every knob named, that agree with `fixed`, without those with which an
 * eye could not be examined that could with others, and those that another one beats at everything.
 * An eye that the whole stage was not measured in takes the largest error of the others. Free with candidates_free. Returns PLACIDO_OK, PLACIDO_QUALITY (none is left, and why),
 * PLACIDO_MEMORY. */
int candidates_new(struct candidates *candidates, const struct accuracy_table *table,
                   const struct table_eyes *eyes, enum accuracy_stage stage, const char *fixed,
                   placido_error *err);
void candidates_free(struct candidates *candidates);

#endif
