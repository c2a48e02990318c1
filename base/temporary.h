/* Names that files and directories have while they are being written. */
#ifndef PLACIDO_BASE_TEMPORARY_H
#define PLACIDO_BASE_TEMPORARY_H

#include <placido/status.h>

/* How many names are tried where another run of the same process id left its own behind. */
#define PLACIDO_TEMPORARY_ATTEMPTS 100

/* "PATH.PID-ATTEMPT.ENDING" into `out` of PLACIDO_PATH_MAX bytes; PLACIDO_INPUT where too long. */
int placido_temporary_name(char *out, const char *path, int attempt, const char *ending,
                           placido_error *err);

/* Takes the temporary part out of every such name of this process in a message: what a person reads
 * is the name that was asked for. */
void placido_temporary_hide(char *text);

#endif
