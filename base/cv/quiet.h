/* Keeps what C libraries print to standard error from the person, and hands it to the caller. */
#ifndef PLACIDO_BASE_CV_QUIET_H
#define PLACIDO_BASE_CV_QUIET_H

#include <stddef.h>

typedef struct placido_quiet {
  int standard_error, reading; /* descriptors; -1: nothing was changed */
} placido_quiet;

/* From begin to end, standard error goes nowhere; of its first bytes `said` (of `size` bytes) gets
 * as many as fit. It is the whole process's, so callers hold a lock. Where the system refuses,
 * nothing changes and `said` is empty. */
void placido_quiet_begin(placido_quiet *quiet);
void placido_quiet_end(placido_quiet *quiet, char *said, size_t size);

#endif
