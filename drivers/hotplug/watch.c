/* Devices that come and go: an alarm only says when to look again, and what has changed is the
 * difference between two looks. So no driver has a second way to tell of its devices. */
#include "drivers/hotplug/watch.h"

#include "base/memory.h"

#include <placido/device.h>

#include <stdio.h>
#include <string.h>

#define MS 1000000ll
/* One plug makes a burst of alarms; the look is when they are over, or have gone on for long. */
#define QUIET_NS (200 * MS)
#define BURST_NS (1000 * MS)
/* Permissions and names may be settled a moment after the last alarm, so there is a second look;
 * without an alarm each is as long after the other. */
#define AGAIN_NS (1000 * MS)

struct list {
  size_t count;
  placido_change *items;
};

struct placido_watch {
  placido_alarm alarm;
  placido_look *look;
  const placido_clock *clock;
  struct list told, there; /* to the caller; at the last look */
  int64_t due_ns;          /* of the next look */
  int64_t burst_ns;        /* when the alarms began that were not looked after; 0: there are none */
};

static bool is_same(const placido_change *a, const placido_change *b) {
  return strcmp(a->uri, b->uri) == 0 && strcmp(a->description, b->description) == 0;
}

static bool has(const struct list *list, const placido_change *item) {
  for (size_t i = 0; i < list->count; i++) {
    if (is_same(&list->items[i], item)) {
      return true;
    }
  }
  return false;
}

static int append(struct list *list, const placido_change *item, placido_error *err) {
  placido_change *grown =
      placido_memory_grow(list->items, list->count + 1, sizeof *list->items, err);
  if (!grown) {
    return PLACIDO_MEMORY;
  }
  list->items = grown;
  list->items[list->count++] = *item;
  return PLACIDO_OK;
}

int placido_watch_open_with(placido_watch **watch, placido_alarm alarm, placido_look *look,
                            const placido_clock *clock, placido_error *err) {
  *watch = placido_memory_new(1, sizeof **watch, err);
  if (!*watch) {
    if (alarm.close) {
      alarm.close(alarm.state);
    }
    return PLACIDO_MEMORY;
  }
  **watch = (placido_watch){
      .alarm = alarm, .look = look, .clock = clock, .due_ns = clock->now_ns()};
  return PLACIDO_OK;
}

int placido_watch_open(placido_watch **watch, placido_error *err) {
  return placido_watch_open_with(watch, placido_alarm_open(), placido_device_scan,
                                 &placido_clock_monotonic, err);
}

void placido_watch_close(placido_watch *watch) {
  if (!watch) {
    return;
  }
  if (watch->alarm.close) {
    watch->alarm.close(watch->alarm.state);
  }
  placido_memory_free(watch->told.items);
  placido_memory_free(watch->there.items);
  placido_memory_free(watch);
}

/* A look under way. */
struct sight {
  struct list list;
  placido_error *err;
};

static int see(void *user, const char *uri, const char *description) {
  struct sight *sight = user;
  placido_change seen = {.is_added = true};
  snprintf(seen.uri, sizeof seen.uri, "%s", uri);
  snprintf(seen.description, sizeof seen.description, "%s", description);
  return has(&sight->list, &seen) ? PLACIDO_OK : append(&sight->list, &seen, sight->err);
}

static int look(placido_watch *watch, placido_error *err) {
  struct sight sight = {.err = err};
  const bool after_alarm = watch->burst_ns != 0;
  const int status = watch->look(NULL, see, &sight, err);
  watch->burst_ns = 0;
  watch->due_ns = after_alarm || status || !watch->alarm.wait
                      ? watch->clock->now_ns() + AGAIN_NS
                      : INT64_MAX;
  if (status) {
    placido_memory_free(sight.list.items);
    return status;
  }
  placido_memory_free(watch->there.items);
  watch->there = sight.list;
  return PLACIDO_OK;
}

/* What went before what came: a device with another name is not there twice. False where all has
 * been told. */
static bool tell(placido_watch *watch, placido_change *change, int *status, placido_error *err) {
  struct list *told = &watch->told;
  for (size_t i = 0; i < told->count; i++) {
    if (!has(&watch->there, &told->items[i])) {
      *change = told->items[i];
      change->is_added = false;
      told->items[i] = told->items[--told->count];
      *status = PLACIDO_OK;
      return true;
    }
  }
  for (size_t i = 0; i < watch->there.count; i++) {
    if (!has(told, &watch->there.items[i])) {
      *change = watch->there.items[i];
      *status = append(told, change, err);
      return true;
    }
  }
  return false;
}

static void ring(placido_watch *watch) {
  const int64_t now_ns = watch->clock->now_ns();
  watch->burst_ns = watch->burst_ns ? watch->burst_ns : now_ns;
  const int64_t latest_ns = watch->burst_ns + BURST_NS;
  watch->due_ns = now_ns + QUIET_NS < latest_ns ? now_ns + QUIET_NS : latest_ns;
}

static void wait_until(placido_watch *watch, int64_t now_ns, int64_t until_ns) {
  const int64_t wake_ns = until_ns < watch->due_ns ? until_ns : watch->due_ns;
  const int duration_ms = (int)((wake_ns - now_ns + MS - 1) / MS);
  if (!watch->alarm.wait) {
    watch->clock->sleep_ms(duration_ms);
  } else if (watch->alarm.wait(watch->alarm.state, duration_ms)) {
    ring(watch);
  }
}

int placido_watch_next(placido_watch *watch, placido_change *change, int timeout_ms,
                       placido_error *err) {
  *change = (placido_change){0};
  const int64_t until_ns = watch->clock->now_ns() + (timeout_ms > 0 ? timeout_ms : 0) * MS;
  for (;;) {
    int status;
    if (tell(watch, change, &status, err)) {
      return status;
    }
    const int64_t now_ns = watch->clock->now_ns();
    if (now_ns >= watch->due_ns) {
      status = look(watch, err);
      if (status) {
        return status;
      }
    } else if (now_ns >= until_ns) {
      return placido_error_set(err, PLACIDO_TIMEOUT, "no device came or went within %d ms",
                               timeout_ms);
    } else {
      wait_until(watch, now_ns, until_ns);
    }
  }
}
