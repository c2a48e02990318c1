/* Pictures and the page, where the build can draw: figures.c with cairo, figures_none.c without. */
#ifndef PLACIDO_CLI_FIGURES_H
#define PLACIDO_CLI_FIGURES_H

#include "acquire/cli/ball.h"
#include "acquire/cli/iso_check.h"
#include "acquire/cli/save.h"

bool figures_available(void);

/* Adds a job for every figure of the examination. */
void figures_add(struct jobs *jobs, const struct examination *examination);

/* Writes report.html into the directory, when all pictures are there. */
int figures_report(const struct examination *examination, placido_error *err);

/* Draws how the daily checks went. */
int figures_drift(const struct ball_record *records, size_t count, const char *path,
                  placido_notes *notes, placido_error *err);

/* Draws the accuracy test and writes iso-check.html into `folder`. */
int figures_iso(const placido_iso_result *results, size_t count, const char *instrument,
                const char *created, const char *folder, placido_notes *notes, placido_error *err);

#endif
