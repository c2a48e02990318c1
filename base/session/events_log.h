/* events.jsonl, read. */
#ifndef PLACIDO_BASE_SESSION_EVENTS_LOG_H
#define PLACIDO_BASE_SESSION_EVENTS_LOG_H

#include <jansson.h>
#include <placido/status.h>
#include <stddef.h>

typedef struct placido_events_log {
  json_t *lines;    /* an array of the objects that are sound */
  size_t bad;       /* lines that are not */
  size_t first_bad; /* its number, from 1; 0: none */
} placido_events_log;

/* Reads the file; one that is missing gives an empty log. Free with placido_events_log_free. */
int placido_events_log_load(placido_events_log *log, const char *folder, placido_error *err);
void placido_events_log_free(placido_events_log *log);

#endif
