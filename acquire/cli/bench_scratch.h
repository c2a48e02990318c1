/* A place on the disk for what a benchmark writes, gone in every way out. */
#ifndef PLACIDO_CLI_BENCH_SCRATCH_H
#define PLACIDO_CLI_BENCH_SCRATCH_H

#include "acquire/cli/bench.h"
#include "base/file.h"

/* Makes a directory, scratch->temporary, in that of -o, of $TMPDIR, or in /tmp, where there is room
 * for `bytes`. One at a time. Returns PLACIDO_OK, PLACIDO_SYSTEM (too little room, or it cannot be
 * written), PLACIDO_INPUT (path too long). */
int bench_scratch_open(placido_directory *scratch, struct bench_run *run, double bytes,
                       placido_error *err);
/* Removes it; legal on a zeroed struct. */
void bench_scratch_close(placido_directory *scratch, struct bench_run *run);

/* Removes what stands at a path within it. */
void bench_scratch_remove(const char *path);

#endif
