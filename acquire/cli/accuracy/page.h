/* Plots and page of an accuracy table. */
#ifndef PLACIDO_CLI_ACCURACY_PAGE_H
#define PLACIDO_CLI_ACCURACY_PAGE_H

#include "acquire/cli/accuracy/table.h"

/* Writes accuracy.html and, for every stage and error that the table tells, accuracy-STAGE-ERROR.png
 * and .svg into a folder. PLACIDO_OK, PLACIDO_UNSUPPORTED (this build draws no figures),
 * PLACIDO_SYSTEM, PLACIDO_MEMORY. */
int accuracy_page_write(const struct accuracy_table *table, const char *folder,
                        placido_error *err);

#endif
