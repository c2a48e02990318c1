/* A stage whose accuracy and time are measured: a row of the table in sweep.c and a file of its
 * own. */
#ifndef PLACIDO_CLI_ACCURACY_STAGE_H
#define PLACIDO_CLI_ACCURACY_STAGE_H

#include "acquire/cli/accuracy/eyes.h"

/* One setting on one eye. */
struct accuracy_trial {
  const struct accuracy_bench *bench;
  const struct accuracy_eye *eye;
  const char *setting;
  struct accuracy_knobs knobs; /* the setting, all others at their finest */
  void *prepared;              /* what the stage prepared for this eye */
};

struct accuracy_measure {
  enum accuracy_stage stage;
  const char *const *settings; /* NULL-terminated, of each knob from coarse to fine */
  const char *const *quick;    /* the few that show that it works */
  bool words;                  /* settings are names of parts, not knobs */
  bool defaults;               /* knobs that a setting does not name are at their default */
  /* What all settings are measured against, once an eye. NULL: nothing. */
  int (*prepare)(void **prepared, const struct accuracy_bench *bench,
                 const struct accuracy_eye *eye, placido_error *err);
  /* Fills the row's errors, which are NaN, and time. PLACIDO_QUALITY: this eye cannot be examined
   * with this setting; then there is no row. */
  int (*run)(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err);
  void (*release)(void *prepared); /* legal with NULL */
};

extern const struct accuracy_measure accuracy_measure_mires, accuracy_measure_fit,
    accuracy_measure_trace, accuracy_measure_psf, accuracy_measure_convolution,
    accuracy_measure_acuity, accuracy_measure_rest, accuracy_measure_floor, accuracy_measure_exam;

/* Processor time of laps, the least of them. Start with a zeroed struct. */
struct accuracy_watch {
  int laps;
  double least_ms, all_ms;
  double begun_s;
};

void accuracy_watch_begin(struct accuracy_watch *watch);
void accuracy_watch_end(struct accuracy_watch *watch);

/* Whether another lap is worth its time: what takes long is measured well enough by fewer. */
bool accuracy_watch_again(const struct accuracy_watch *watch, const struct accuracy_bench *bench);

#endif
