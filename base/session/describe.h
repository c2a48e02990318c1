/* session.json to struct and back. */
#ifndef PLACIDO_BASE_SESSION_DESCRIBE_H
#define PLACIDO_BASE_SESSION_DESCRIBE_H

#include <placido/notes.h>
#include <placido/session.h>
#include <placido/status.h>

/* Reads session.json. Every field but "format" may be missing: numbers are then NaN, `bits` 0 (the
 * video tells), strings empty. Wrong types and impossible values are refused with their line. */
int placido_session_describe_load(placido_session_info *info, const char *path,
                                  placido_notes *notes, placido_error *err);

/* Writes session.json; fields that are not recorded are left out. */
int placido_session_describe_save(const placido_session_info *info, const char *path,
                                  placido_error *err);

#endif
