/* This build cannot draw (PLACIDO_FIGURES is off). */
#include "acquire/cli/accuracy/page.h"

int accuracy_page_write(const struct accuracy_table *table, const char *folder,
                        placido_error *err) {
  (void)table;
  return placido_error_set(err, PLACIDO_UNSUPPORTED,
                           "%s: this build draws no figures: accuracy.csv stands without plots and "
                           "page (PLACIDO_FIGURES)", folder);
}
