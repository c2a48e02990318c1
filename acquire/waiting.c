/* Two lists of what waits to be written, and one of spare room for frames. */
#include "acquire/waiting.h"

#include "base/memory.h"

#include <string.h>

size_t placido_waiting_bytes(const placido_frame *frame) {
  return (size_t)frame->height_px * frame->stride_bytes;
}

/* Borrowed samples into the item's own block. */
static int copy_samples(placido_frame *own, const placido_frame *frame, placido_error *err) {
  const int status =
      placido_frame_resize(own, frame->width_px, frame->height_px, frame->format, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int y = 0; y < frame->height_px; y++) {
    memcpy(own->data + (size_t)y * own->stride_bytes,
           frame->data + (size_t)y * frame->stride_bytes, own->stride_bytes);
  }
  own->bits = frame->bits;
  own->t_ns = frame->t_ns;
  own->seq = frame->seq;
  own->flags = frame->flags;
  return PLACIDO_OK;
}

static int move_samples(placido_frame *own, placido_frame *frame, placido_error *err) {
  if (frame->capacity == 0) {
    return copy_samples(own, frame, err);
  }
  const placido_frame spare = *own;
  *own = *frame;
  *frame = spare;
  return PLACIDO_OK;
}

static placido_waiting_frame *get_item(placido_waiting *waiting, placido_error *err) {
  placido_waiting_frame *item = waiting->spare;
  if (item) {
    waiting->spare = item->next;
    return item;
  }
  return placido_memory_new(1, sizeof *item, err);
}

static void keep_spare(placido_waiting *waiting, placido_waiting_frame *item) {
  item->next = waiting->spare;
  waiting->spare = item;
}

int placido_waiting_frame_add(placido_waiting *waiting, placido_frame *frame,
                              const placido_frame_info *info, placido_error *err) {
  placido_waiting_frame *item = get_item(waiting, err);
  if (!item) {
    return PLACIDO_MEMORY;
  }
  const int status = move_samples(&item->frame, frame, err);
  if (status != PLACIDO_OK) {
    keep_spare(waiting, item);
    return status;
  }
  item->has_info = info != NULL;
  if (info) {
    item->info = *info;
  }
  item->next = NULL;
  if (waiting->first) {
    waiting->last->next = item;
  } else {
    waiting->first = item;
  }
  waiting->last = item;
  waiting->count++;
  waiting->held_bytes += placido_waiting_bytes(&item->frame);
  return PLACIDO_OK;
}

placido_waiting_frame *placido_waiting_frame_take(placido_waiting *waiting) {
  placido_waiting_frame *item = waiting->first;
  waiting->first = item->next;
  waiting->count--;
  return item;
}

void placido_waiting_frame_give_back(placido_waiting *waiting, placido_waiting_frame *item) {
  waiting->held_bytes -= placido_waiting_bytes(&item->frame);
  keep_spare(waiting, item);
}

int placido_waiting_event_add(placido_waiting *waiting, int64_t t_ns, const char *name,
                              const char *text, placido_error *err) {
  placido_waiting_event *event = placido_memory_new(1, sizeof *event, err);
  if (!event) {
    return PLACIDO_MEMORY;
  }
  event->t_ns = t_ns;
  event->name = placido_memory_string(name, err);
  event->text = text ? placido_memory_string(text, err) : NULL;
  if (!event->name || (text && !event->text)) {
    placido_waiting_event_free(event);
    return PLACIDO_MEMORY;
  }
  if (waiting->first_event) {
    waiting->last_event->next = event;
  } else {
    waiting->first_event = event;
  }
  waiting->last_event = event;
  return PLACIDO_OK;
}

placido_waiting_event *placido_waiting_event_take(placido_waiting *waiting) {
  placido_waiting_event *event = waiting->first_event;
  waiting->first_event = event->next;
  return event;
}

void placido_waiting_event_free(placido_waiting_event *event) {
  if (event) {
    placido_memory_free(event->name);
    placido_memory_free(event->text);
    placido_memory_free(event);
  }
}

static void free_frames(placido_waiting_frame *item) {
  while (item) {
    placido_waiting_frame *next = item->next;
    placido_frame_free(&item->frame);
    placido_memory_free(item);
    item = next;
  }
}

void placido_waiting_free(placido_waiting *waiting) {
  free_frames(waiting->first);
  free_frames(waiting->spare);
  while (waiting->first_event) {
    placido_waiting_event_free(placido_waiting_event_take(waiting));
  }
  *waiting = (placido_waiting){0};
}
