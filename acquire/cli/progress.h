/* What is going on, on a terminal, for whatever takes longer than a second. */
#ifndef PLACIDO_CLI_PROGRESS_H
#define PLACIDO_CLI_PROGRESS_H

#include <stdbool.h>

struct progress;

/* Starts watching; NULL where standard error is no terminal, `wanted` is false or there is no
 * thread to be had. Every function here accepts NULL. End with progress_stop. */
struct progress *progress_start(const char *command, bool wanted);

/* Names what is being done now; the text is copied. */
void progress_say(struct progress *progress, const char *text);

/* Clears the line and ends. */
void progress_stop(struct progress *progress);

#endif
