/* Takes a device's frames one by one and keeps the best few. */
#include "acquire/acquire.h"

#include <limits.h>
#include <stdbool.h>
#include <string.h>

#define ENDLESS_FRAMES 48 /* one to three seconds of a camera, between two blinks */
#define FRAME_TIMEOUT_MS 5000

/* The search: `taken` are the best frames so far, the best first; `next` is the one being looked
 * at. */
struct search {
  placido_choice *taken;
  placido_frame *frames; /* of `taken` */
  size_t most, count;
  placido_frame next;
  long seen, damaged;
  long wanted; /* the only frame that counts; -1: any */
};

static bool is_damaged(const placido_frame *frame) {
  return (frame->flags & (PLACIDO_FRAME_TRUNCATED | PLACIDO_FRAME_CORRUPT)) != 0;
}

/* A whole frame beats a damaged one; between equals the score decides, and then the earlier. */
static bool is_better(double score, bool damaged, const placido_choice *taken,
                      const placido_frame *frame) {
  return damaged != is_damaged(frame) ? !damaged : score > taken->score;
}

/* Puts the next frame in its place among the best, if it has one there; the one that falls out
 * lends its memory to the next. */
static void place_next(struct search *search, double score) {
  const bool damaged = is_damaged(&search->next);
  size_t place = search->count;
  while (place > 0 &&
         is_better(score, damaged, &search->taken[place - 1], &search->frames[place - 1])) {
    place--;
  }
  if (place == search->most) {
    return;
  }
  search->count += search->count < search->most;
  const size_t last = search->count - 1;
  const placido_frame spare = search->frames[last];
  memmove(&search->taken[place + 1], &search->taken[place], (last - place) * sizeof *search->taken);
  memmove(&search->frames[place + 1], &search->frames[place],
          (last - place) * sizeof *search->frames);
  search->taken[place] = (placido_choice){.index = search->seen - 1, .score = score};
  search->frames[place] = search->next;
  search->next = spare;
}

static int consider(struct search *search, placido_error *err) {
  search->damaged += is_damaged(&search->next);
  if (search->wanted >= 0 && search->seen - 1 != search->wanted) {
    return PLACIDO_OK;
  }
  double score;
  const int status = placido_frame_score(&score, &search->next, err);
  if (status == PLACIDO_OK) {
    place_next(search, score);
  }
  return status;
}

/* Looks at every frame, of a device that never ends at ENDLESS_FRAMES of them or as far as the one
 * wanted; one that cannot be decoded is counted and passed over. */
static int look_through(struct search *search, placido_device *device, placido_error *err) {
  const long most = placido_device_info_get(device)->endless
                        ? (search->wanted >= 0 ? search->wanted + 1 : ENDLESS_FRAMES)
                        : LONG_MAX;
  while (search->seen < most) {
    int status = placido_device_next(device, &search->next, FRAME_TIMEOUT_MS, err);
    if (status == PLACIDO_END) {
      return PLACIDO_OK;
    }
    if (status == PLACIDO_TIMEOUT && placido_device_is_waiting(device)) {
      continue; /* unplugged: its patience ends by itself */
    }
    if (status != PLACIDO_OK && status != PLACIDO_INPUT) {
      return status;
    }
    search->seen++;
    if (status == PLACIDO_INPUT) {
      search->damaged++;
      continue;
    }
    status = consider(search, err);
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static int refuse_nothing(const struct search *search, const char *uri, placido_error *err) {
  if (search->wanted >= search->seen && search->seen > 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s has no frame %ld: it has %ld, counted from 0",
                             uri, search->wanted, search->seen);
  }
  if (search->wanted >= 0 && search->seen > 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: frame %ld is damaged and cannot be decoded",
                             uri, search->wanted);
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "%s: holds no frame that can be read (%ld are damaged)", uri,
                           search->damaged);
}

/* Of frames that are to go together only whole ones count, unless there are none: then the best of
 * the damaged ones does. */
static void leave_damaged(struct search *search) {
  while (search->count > 1 && is_damaged(&search->frames[search->count - 1])) {
    placido_frame_free(&search->frames[--search->count]);
  }
}

static int conclude(struct search *search, const char *uri, placido_notes *notes,
                    placido_error *err) {
  if (search->count == 0) {
    return refuse_nothing(search, uri, err);
  }
  leave_damaged(search);
  if (search->damaged > 0) {
    placido_notes_add(notes, "%ld of %ld frames are damaged%s", search->damaged, search->seen,
                      is_damaged(&search->frames[0]) ? ", the one examined among them" : "");
  }
  for (size_t i = 0; i < search->count; i++) {
    search->taken[i].frames = search->seen;
    search->taken[i].damaged = search->damaged;
  }
  return PLACIDO_OK;
}

static void tell_replugs(const placido_device *device, placido_notes *notes) {
  placido_device_statistics counts;
  placido_device_statistics_get(device, &counts);
  if (counts.replugs > 0) {
    placido_notes_add(notes, "the device was unplugged and came back, %llu time%s",
                      (unsigned long long)counts.replugs, counts.replugs == 1 ? "" : "s");
  }
}

/* A recording that is only looked through need not take the time that it took, unless its address
 * says so. */
static void hurry(placido_device *device) {
  if (!strstr(placido_device_info_get(device)->uri, "speed=")) {
    placido_device_set(device, "speed", 0, NULL); /* a camera has no such control */
  }
}

static int search_device(struct search *search, placido_device *device, placido_notes *notes,
                         placido_error *err) {
  hurry(device);
  int status = placido_device_start(device, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = look_through(search, device, err);
  if (status == PLACIDO_OK) {
    status = conclude(search, placido_device_info_get(device)->uri, notes, err);
  }
  tell_replugs(device, notes);
  const int stopped = placido_device_stop(device, status == PLACIDO_OK ? err : NULL);
  placido_frame_free(&search->next);
  return status == PLACIDO_OK ? stopped : status;
}

/* The search into the caller's arrays, which a failure leaves without frames. */
static int choose(struct search *search, placido_device *device, placido_notes *notes,
                  placido_error *err) {
  for (size_t i = 0; i < search->most; i++) {
    search->taken[i] = (placido_choice){.index = -1};
    search->frames[i] = (placido_frame){0};
  }
  const int status = search_device(search, device, notes, err);
  for (size_t i = 0; i < search->count && status != PLACIDO_OK; i++) {
    placido_frame_free(&search->frames[i]);
    search->taken[i] = (placido_choice){.index = -1};
  }
  return status;
}

int placido_frame_choose(placido_frame *frame, placido_choice *choice, placido_device *device,
                         long wanted, placido_notes *notes, placido_error *err) {
  placido_frame taken;
  struct search search = {.taken = choice, .frames = &taken, .most = 1, .wanted = wanted};
  const int status = choose(&search, device, notes, err);
  if (status == PLACIDO_OK) {
    placido_frame_free(frame);
    *frame = taken;
  }
  return status;
}

int placido_frames_choose(placido_frame *frames, placido_choice *choices, size_t most,
                          size_t *count, placido_device *device, placido_notes *notes,
                          placido_error *err) {
  struct search search = {.taken = choices, .frames = frames, .most = most, .wanted = -1};
  *count = 0;
  const int status = choose(&search, device, notes, err);
  if (status == PLACIDO_OK) {
    *count = search.count;
  }
  return status;
}
