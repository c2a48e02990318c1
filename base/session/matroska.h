/* Whether a Matroska file has its end. */
#ifndef PLACIDO_BASE_SESSION_MATROSKA_H
#define PLACIDO_BASE_SESSION_MATROSKA_H

#include <placido/status.h>
#include <stdbool.h>

/* Compares the length that the file's segment claims with the file's own. A recording that was cut
 * off claims more than there is, or "unknown". PLACIDO_INPUT where the file is not Matroska. */
int placido_matroska_check_end(bool *finished, const char *path, placido_error *err);

#endif
