/* Ctrl-C and its kin: what was begun is removed before the program ends. */
#ifndef PLACIDO_CLI_INTERRUPT_H
#define PLACIDO_CLI_INTERRUPT_H

#include "base/file.h"

#include <stdbool.h>

struct interrupt;

/* From here on SIGINT, SIGTERM and SIGHUP (less those that the caller of the program had ignored)
 * end the program by way of a thread of its own, which first removes the directory being written.
 * Call before any other thread is made. NULL where that cannot be had: then they end it at once. */
struct interrupt *interrupt_start(const char *command);

/* Between hold and release no signal ends the program: for steps that must happen together.
 * release takes note of the directory to remove from now on; one without a temporary name (it is
 * committed, or could not be made): nothing. All three accept NULL for `interrupt`. */
void interrupt_hold(struct interrupt *interrupt);
void interrupt_release(struct interrupt *interrupt, const placido_directory *directory);
void interrupt_stop(struct interrupt *interrupt);

/* For what ends in an orderly way when it is asked to: from here on signals end nothing, and
 * interrupt_is_asked says whether one has come. Both accept NULL. */
void interrupt_defer(struct interrupt *interrupt);
bool interrupt_is_asked(struct interrupt *interrupt);

#endif
