/* A file of JSON lines that grows while a recording runs. */
#ifndef PLACIDO_BASE_SESSION_LINES_H
#define PLACIDO_BASE_SESSION_LINES_H

#include <jansson.h>
#include <placido/status.h>
#include <stdio.h>

#include "base/file.h"

typedef struct placido_lines {
  FILE *stream;
  char path[PLACIDO_PATH_MAX];
} placido_lines;

int placido_lines_create(placido_lines *lines, const char *folder, const char *name,
                         placido_error *err);
/* Appends `object` (taken; NULL where it could not be made) as one line, handed to the system at
 * once, so that it survives the process. */
int placido_lines_append(placido_lines *lines, json_t *object, placido_error *err);
/* Puts what was appended on the disk, so that it survives a power cut. */
int placido_lines_sync(placido_lines *lines, placido_error *err);
/* Legal on a zeroed struct. */
int placido_lines_close(placido_lines *lines, placido_error *err);

#endif
