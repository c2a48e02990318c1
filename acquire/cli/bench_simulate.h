/* What `placido bench simulate` measures, part by part: a row of the table in bench_simulate.c and
 * a file of its own. */
#ifndef PLACIDO_CLI_BENCH_SIMULATE_H
#define PLACIDO_CLI_BENCH_SIMULATE_H

#include "acquire/cli/bench.h"

#include <placido/surface.h>
#include <stdbool.h>

/* Adds its figures, for light through the cornea `surface`, each against a tight loop or a bare
 * transform of the same run. Returns PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
typedef int bench_simulate_part(struct bench_report *report, const placido_surface *surface,
                                bool quick, placido_error *err);

/* Rays through the cornea to the point spread function. */
bench_simulate_part bench_rays;

/* A picture spread by it. */
bench_simulate_part bench_spread;

/* Waves through a pupil, and Zernike terms. */
bench_simulate_part bench_waves;

#endif
