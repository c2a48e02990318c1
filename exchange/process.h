/* Another program, run to its end. */
#ifndef PLACIDO_EXCHANGE_PROCESS_H
#define PLACIDO_EXCHANGE_PROCESS_H

#include <placido/status.h>

/* Runs arguments[0], found on PATH, in a folder; what it says goes to the file `said` there.
 * PLACIDO_UNSUPPORTED where there is no such program, PLACIDO_SYSTEM where it fails: the message
 * ends with the first line that it said. */
int placido_process_run(const char *const *arguments, const char *folder, const char *said,
                        placido_error *err);

#endif
