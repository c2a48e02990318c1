/* What an accuracy table says in plain English: what an error costs, and from where on more time
 * buys nothing. Every number is computed from the table. */
#ifndef PLACIDO_CLI_ACCURACY_SENTENCES_H
#define PLACIDO_CLI_ACCURACY_SENTENCES_H

#include "acquire/cli/accuracy/table.h"

#include <stddef.h>

#define ACCURACY_SENTENCES_MAX 32
#define ACCURACY_SENTENCE_SIZE 480

struct accuracy_sentence {
  enum accuracy_stage stage;
  char text[ACCURACY_SENTENCE_SIZE]; /* UTF-8 */
};

struct accuracy_sentences {
  size_t count;
  struct accuracy_sentence items[ACCURACY_SENTENCES_MAX]; /* ordered by stage */
};

/* Two errors of a stage at most: that which it is judged by, and for examinations another one. A
 * setting counts by the largest error and time of all eyes, and not at all where some eye has no
 * row. A stage without such a setting has no sentence. */
void accuracy_sentences_find(struct accuracy_sentences *sentences,
                             const struct accuracy_table *table);

/* The error that a stage is judged by; ACCURACY_ERRORS: none (rest, floor). */
enum accuracy_error accuracy_stage_error(enum accuracy_stage stage);

/* One setting of a stage, over all eyes. */
struct accuracy_point {
  const char *setting; /* borrowed from the table */
  double error, ms;    /* the largest */
};

/* The stage's settings that every eye of the table has a finite `error` for, in the table's order;
 * at most `most` of them. Returns how many. For plots, too. */
size_t accuracy_points_find(struct accuracy_point *points, size_t most,
                            const struct accuracy_table *table, enum accuracy_stage stage,
                            enum accuracy_error error);

/* What is left with everything at its finest, in the hardest eye; NaN: not known. */
double accuracy_floor_find(const struct accuracy_table *table, enum accuracy_error error);

/* "360 meridians, filter of 2 px" of "meridians=360 filter_px=2". */
void accuracy_setting_say(char *text, size_t size, const char *setting);

/* "0.012 µm", "0.034" of the transfer function: an error with its unit. */
void accuracy_error_say(char *text, size_t size, enum accuracy_error error, double value);

#endif
