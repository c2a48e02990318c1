/* The sweep: every stage, every setting, every eye into an accuracy table. */
#ifndef PLACIDO_CLI_ACCURACY_SWEEP_H
#define PLACIDO_CLI_ACCURACY_SWEEP_H

#include "acquire/cli/accuracy/table.h"
#include "acquire/cli/settings.h"
#include "acquire/cli/stages.h"

/* Measures in one thread, some six minutes; `quick`: in seconds, two eyes, as little as shows that
 * everything works. A setting with which an eye cannot be examined has no row. `progress` (may be
 * NULL) gets a stage for each eye and stage. Free the table with accuracy_table_free, whatever the
 * status: PLACIDO_OK, PLACIDO_QUALITY (an eye that cannot be examined with every knob at its
 * finest), PLACIDO_MEMORY. */
int accuracy_sweep(struct accuracy_table *table, const struct settings *settings, bool quick,
                   struct stages *progress, placido_error *err);

#endif
