/* Takes a device's frames one by one and keeps the best. */
#include "acquire/acquire.h"

#include <limits.h>
#include <stdbool.h>

#define ENDLESS_FRAMES 48 /* one to three seconds of a camera, between two blinks */
#define FRAME_TIMEOUT_MS 5000

/* The search: `taken` is the best frame so far, `next` the one being looked at. */
struct search {
  placido_choice choice;
  placido_frame taken, next;
  bool found, taken_damaged;
};

static bool is_damaged(const placido_frame *frame) {
  return (frame->flags & (PLACIDO_FRAME_TRUNCATED | PLACIDO_FRAME_CORRUPT)) != 0;
}

/* A whole frame beats a damaged one; between equals the score decides, and then the earlier. */
static bool is_better(const struct search *search, double score, bool damaged) {
  if (!search->found || damaged != search->taken_damaged) {
    return !search->found || !damaged;
  }
  return score > search->choice.score;
}

static int consider(struct search *search, long wanted, placido_error *err) {
  const long index = search->choice.frames - 1;
  const bool damaged = is_damaged(&search->next);
  search->choice.damaged += damaged;
  if (wanted >= 0 && index != wanted) {
    return PLACIDO_OK;
  }
  double score;
  const int status = placido_frame_score(&score, &search->next, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (is_better(search, score, damaged)) {
    const placido_frame spare = search->taken;
    search->taken = search->next;
    search->next = spare;
    search->choice.index = index;
    search->choice.score = score;
    search->taken_damaged = damaged;
    search->found = true;
  }
  return PLACIDO_OK;
}

/* Looks at every frame, of a device that never ends at ENDLESS_FRAMES of them or as far as the one
 * wanted; one that cannot be decoded is counted and passed over. */
static int look_through(struct search *search, placido_device *device, long wanted,
                        placido_error *err) {
  const long most = placido_device_info_get(device)->endless
                        ? (wanted >= 0 ? wanted + 1 : ENDLESS_FRAMES)
                        : LONG_MAX;
  while (search->choice.frames < most) {
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
    search->choice.frames++;
    if (status == PLACIDO_INPUT) {
      search->choice.damaged++;
      continue;
    }
    status = consider(search, wanted, err);
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static int conclude(const struct search *search, const char *uri, long wanted,
                    placido_notes *notes, placido_error *err) {
  const placido_choice *choice = &search->choice;
  if (!search->found && wanted >= choice->frames && choice->frames > 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s has no frame %ld: it has %ld, counted from 0", uri, wanted,
                             choice->frames);
  }
  if (!search->found && wanted >= 0 && choice->frames > 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: frame %ld is damaged and cannot be decoded",
                             uri, wanted);
  }
  if (!search->found) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s: holds no frame that can be read (%ld are damaged)", uri,
                             choice->damaged);
  }
  if (choice->damaged > 0) {
    placido_notes_add(notes, "%ld of %ld frames are damaged%s", choice->damaged, choice->frames,
                      search->taken_damaged ? ", the one examined among them" : "");
  }
  return PLACIDO_OK;
}

int placido_frame_choose(placido_frame *frame, placido_choice *choice, placido_device *device,
                         long wanted, placido_notes *notes, placido_error *err) {
  struct search search = {.choice = {.index = -1}};
  *choice = search.choice;
  int status = placido_device_start(device, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = look_through(&search, device, wanted, err);
  if (status == PLACIDO_OK) {
    status = conclude(&search, placido_device_info_get(device)->uri, wanted, notes, err);
  }
  placido_device_statistics counts;
  placido_device_statistics_get(device, &counts);
  if (counts.replugs > 0) {
    placido_notes_add(notes, "the device was unplugged and came back, %llu time%s",
                      (unsigned long long)counts.replugs, counts.replugs == 1 ? "" : "s");
  }
  const int stopped = placido_device_stop(device, status == PLACIDO_OK ? err : NULL);
  status = status == PLACIDO_OK ? stopped : status;
  if (status == PLACIDO_OK) {
    placido_frame_free(frame);
    *frame = search.taken;
    search.taken = (placido_frame){0};
    *choice = search.choice;
  }
  placido_frame_free(&search.taken);
  placido_frame_free(&search.next);
  return status;
}
