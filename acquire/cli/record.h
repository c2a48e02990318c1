/* An examination as JSON for machines and as a few lines for people. */
#ifndef PLACIDO_CLI_RECORD_H
#define PLACIDO_CLI_RECORD_H

#include "acquire/cli/examination.h"

/* The marker file: exam.json, reconstruction.json or simulation.json (docs/formats.md). */
int record_save(const struct examination *examination, const char *path, placido_error *err);

/* What --json prints: the same with the directory and the indices. NULL when memory is out. */
json_t *record_result(const struct examination *examination);

/* A JSON string of any bytes: what is not UTF-8 becomes '?'. */
json_t *record_text(const char *text);

/* The figures worth a look, on stdout. */
void summary_print(const struct examination *examination);

#endif
