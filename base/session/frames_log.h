/* frames.jsonl: what the device said of each frame. */
#ifndef PLACIDO_BASE_SESSION_FRAMES_LOG_H
#define PLACIDO_BASE_SESSION_FRAMES_LOG_H

#include <jansson.h>
#include <placido/notes.h>
#include <placido/session.h>
#include <placido/status.h>

/* The lines, sorted by index. */
typedef struct placido_frames_log {
  placido_frame_info *frames;
  size_t count;
  size_t bad; /* lines that were ignored */
} placido_frames_log;

/* Reads the file; one that is missing gives an empty log. Lines that are not valid, and a second
 * line of the same index, are ignored with a note. Free with placido_frames_log_free. */
int placido_frames_log_load(placido_frames_log *log, const char *path, placido_notes *notes,
                            placido_error *err);

/* The line of a frame, NULL where there is none. Borrowed from the log. */
const placido_frame_info *placido_frames_log_find(const placido_frames_log *log, int64_t index);

/* The first line from `index` on with this checksum, NULL where there is none. */
const placido_frame_info *placido_frames_log_find_checksum(const placido_frames_log *log,
                                                           int64_t index, uint32_t crc32);

void placido_frames_log_free(placido_frames_log *log);

/* A line as JSON: a new reference, NULL when memory is out. */
json_t *placido_frames_log_line(const placido_frame_info *frame);

#endif
