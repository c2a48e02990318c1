/* A session being checked. */
#ifndef PLACIDO_BASE_SESSION_CHECK_H
#define PLACIDO_BASE_SESSION_CHECK_H

#include "base/session/archive.h"
#include "base/session/reader.h"

/* What is being looked at, and what was found. */
typedef struct placido_check {
  placido_findings *findings;
  placido_session_survey *survey;
  const char *path;
  placido_session_reader *reader;   /* NULL: no frame can be read */
  placido_ranges damaged, unlisted; /* frames that are not whole; that have no line */
  placido_clock clock;
  int64_t flagged;  /* frames that the camera called truncated or corrupt */
  int64_t unsummed; /* frames without a checksum in their line */
} placido_check;

/* Adds a finding. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
void placido_check_find(placido_check *check, enum placido_finding_state state, const char *part,
                        const char *format, ...);

/* Makes a finding of a failure that is damage, which is what a check looks for; any other one is
 * returned, and ends it. */
int placido_check_settle(placido_check *check, const char *part, int status,
                         const placido_error *reason, placido_error *err);

/* frames.mkv, frames.jsonl, and what the times and counters in them tell. */
int placido_check_frames(placido_check *check, placido_error *err);

#endif
