/* Between the settings of the command line and those of an accuracy table. */
#ifndef PLACIDO_CLI_PROMISE_KNOBS_H
#define PLACIDO_CLI_PROMISE_KNOBS_H

#include "acquire/cli/accuracy/choose.h"
#include "acquire/cli/settings.h"

/* Which stages' knobs are chosen; those of the others stay as they are. */
struct choosable {
  bool stages[ACCURACY_STAGES];
};

/* What the limits ask for: an error concerns the stages that make it, a time all of them, a name
 * none. */
struct choosable promise_choosable(const struct accuracy_settings *asked);

/* "knob=value" of everything that is not chosen: what stands on the command line, else what its
 * name (or standard) says. */
void promise_fix(char *fixed, size_t size, const struct settings *settings,
                 const struct choosable *choosable);

/* Sets what was chosen, or named, where the command line does not. */
void promise_apply(struct settings *settings, const struct accuracy_choice *choice,
                   const struct choosable *choosable);

/* Calls `each` with the name and value of every knob of a choice that is not at its default. */
void promise_each_knob(const struct accuracy_choice *choice,
                       void (*each)(void *user, const char *name, const char *value), void *user);

#endif
