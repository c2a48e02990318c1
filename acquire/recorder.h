/* Writes a session beside the taking of frames: a thread of its own behind a bounded queue, so that
 * the camera never waits for the disk. What does not fit is dropped, and never silently. */
#ifndef PLACIDO_ACQUIRE_RECORDER_H
#define PLACIDO_ACQUIRE_RECORDER_H

#include <placido/frame.h>
#include <placido/session.h>
#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

typedef struct placido_recorder placido_recorder;

typedef struct placido_recorder_summary {
  int64_t written, dropped; /* frames; dropped: the queue was full, or the writer had failed */
  int64_t missing;          /* by the device's counter, before they came here */
  int64_t damaged;          /* flagged truncated or corrupt, written all the same */
  int64_t bytes;            /* of frames.mkv */
  double seconds;           /* from the first frame's time to the last's */
  int queue_most;           /* frames that waited at the worst moment */
} placido_recorder_summary;

/* Creates the session (which must not exist) and starts the thread. `queue_bytes` bounds the
 * frames that wait or are being written [256 MiB where 0]; one of any size is always taken. Returns
 * what placido_session_writer_create returns, and PLACIDO_SYSTEM (no thread). End with
 * placido_recorder_close. The other functions are for one thread, that which opened it. */
int placido_recorder_open(placido_recorder **recorder, const char *path,
                          const placido_session_info *info, const char *instrument_path,
                          size_t queue_bytes, placido_error *err);

/* Hands a frame over. The samples change hands without a copy: `frame` gets another block (or none)
 * in return. `frame_info` as in placido_session_writer_append, may be NULL. Full queue: the frame
 * is dropped, counted and written into events.jsonl (one event a run of them); PLACIDO_OK. A
 * failure of the writer (disk full) comes back here from then on, and at close. PLACIDO_MEMORY. */
int placido_recorder_put(placido_recorder *recorder, placido_frame *frame,
                         const placido_frame_info *frame_info, placido_error *err);

/* Tells of a frame that is not to be recorded, so that it does not count as missing. */
void placido_recorder_pass(placido_recorder *recorder, const placido_frame *frame);

/* Waits until there is room for such a frame: for sources that can wait, which cameras cannot. */
void placido_recorder_wait(placido_recorder *recorder, const placido_frame *frame);

/* The index in the session of the next frame that is taken. */
int64_t placido_recorder_index(placido_recorder *recorder);

/* Appends to events.jsonl; the texts are copied, `text` may be NULL. */
int placido_recorder_event(placido_recorder *recorder, int64_t t_ns, const char *name,
                           const char *text, placido_error *err);

/* So far. */
void placido_recorder_summary_get(placido_recorder *recorder, placido_recorder_summary *summary);

/* Writes what waits, ends the files. The recorder is gone whatever the status. `summary` may be
 * NULL; written and dropped together are then the frames that were put. Legal on NULL. */
int placido_recorder_close(placido_recorder *recorder, placido_recorder_summary *summary,
                           placido_error *err);

#endif
