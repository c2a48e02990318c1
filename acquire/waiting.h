/* What waits to be written: frames and events in the order in which they came, and the room of
 * frames that have been written, for the next ones. No lock of its own. */
#ifndef PLACIDO_ACQUIRE_WAITING_H
#define PLACIDO_ACQUIRE_WAITING_H

#include <placido/frame.h>
#include <placido/session.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A frame that waits; or, among the spares, room for one. */
typedef struct placido_waiting_frame {
  placido_frame frame;
  placido_frame_info info;
  bool has_info;
  struct placido_waiting_frame *next;
} placido_waiting_frame;

typedef struct placido_waiting_event {
  int64_t t_ns;
  char *name, *text; /* text may be NULL */
  struct placido_waiting_event *next;
} placido_waiting_event;

/* Starts zeroed; first and first_event are NULL where none waits. */
typedef struct placido_waiting {
  placido_waiting_frame *first, *last, *spare;
  placido_waiting_event *first_event, *last_event;
  int count;         /* frames that wait */
  size_t held_bytes; /* of frames that wait, or were taken and not given back */
} placido_waiting;

/* Bytes of a frame's samples. */
size_t placido_waiting_bytes(const placido_frame *frame);

/* The samples change hands: `frame` gets a spare block, or none. Samples that are borrowed are
 * copied. `info` is copied, and may be NULL. PLACIDO_OK, PLACIDO_MEMORY. */
int placido_waiting_frame_add(placido_waiting *waiting, placido_frame *frame,
                              const placido_frame_info *info, placido_error *err);
/* The longest waiting; there must be one. Its samples stay held until it is given back. */
placido_waiting_frame *placido_waiting_frame_take(placido_waiting *waiting);
void placido_waiting_frame_give_back(placido_waiting *waiting, placido_waiting_frame *item);

/* Copies the texts. PLACIDO_OK, PLACIDO_MEMORY. */
int placido_waiting_event_add(placido_waiting *waiting, int64_t t_ns, const char *name,
                              const char *text, placido_error *err);
/* The longest waiting; there must be one. Free with placido_waiting_event_free. */
placido_waiting_event *placido_waiting_event_take(placido_waiting *waiting);
void placido_waiting_event_free(placido_waiting_event *event);

void placido_waiting_free(placido_waiting *waiting);

#endif
