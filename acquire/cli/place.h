/* Where a result goes. */
#ifndef PLACIDO_CLI_PLACE_H
#define PLACIDO_CLI_PLACE_H

#include <placido/status.h>

/* PLACIDO_SYSTEM where `path` is a directory with an earlier result in it (a file called `marker`)
 * and with anything that no result has: a person's own file must not go with the old result. */
int place_check(const char *path, const char *marker, placido_error *err);

#endif
