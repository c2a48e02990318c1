/* The search of the correction, as rows of `placido bench simulate`. */
#ifndef PLACIDO_CLI_BENCH_FOCUS_H
#define PLACIDO_CLI_BENCH_FOCUS_H

#include "acquire/cli/bench.h"

#include <placido/surface.h>

/* Adds to the report: summing up the sparse rays, a trial over them, and a whole search. Returns
 * PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int bench_focus(struct bench_report *report, const placido_surface *surface, bool quick,
                placido_error *err);

#endif
