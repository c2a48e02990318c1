/* An id that tells nothing of whose it is. */
#ifndef PLACIDO_CLI_SUBJECT_ID_H
#define PLACIDO_CLI_SUBJECT_ID_H

#include "acquire/cli/options.h"

#include <placido/status.h>

#define SUBJECT_ID_MAX 32

/* STATUS_USAGE, with the reason, for what is not 1 to 32 letters, digits, - and _, and for what
 * looks like a date of birth. */
int subject_id_check(const char *id, placido_error *err);

/* Options that say which eye it is (OD or OS), and whose (an id that passes the check). */
int parse_eye(void *field, const struct option_row *row, const char *text, placido_error *err);
int parse_subject(void *field, const struct option_row *row, const char *text, placido_error *err);

#endif
