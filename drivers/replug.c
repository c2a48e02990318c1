/* A session over a replug: an unplugged device is waited for and started again, and numbers and
 * times grow over the gap. */
#include "drivers/replug.h"

#include <string.h>

/* Long enough for the kernel and udev to do their part between two looks, short enough that nobody
 * notices. */
#define TRY_EVERY_NS 150000000

static int64_t least(int64_t a, int64_t b) {
  return a < b ? a : b;
}

bool placido_replug_await(placido_replug *replug) {
  if (replug->plug != PLACIDO_PLUGGED || replug->patience_s <= 0) {
    return false;
  }
  if (replug->driver->stop) {
    replug->driver->stop(replug->state, NULL); /* nothing can go wrong that matters now */
  }
  const int64_t now_ns = replug->clock->now_ns();
  replug->plug = PLACIDO_AWAITED;
  replug->deadline_ns = now_ns + (int64_t)(replug->patience_s * 1e9);
  replug->next_try_ns = now_ns + TRY_EVERY_NS;
  return true;
}

/* One try to start. Any failure may be that udev has not settled the permissions yet, or that the
 * camera is still waking up. */
static int try_start(placido_replug *replug, placido_error *why) {
  const int status = replug->driver->start(replug->state, why);
  if (status) {
    replug->next_try_ns = replug->clock->now_ns() + TRY_EVERY_NS;
    return status;
  }
  replug->plug = PLACIDO_PLUGGED;
  replug->count++;
  replug->frames.is_anew = replug->events.is_anew = true;
  return PLACIDO_OK;
}

static int give_up(placido_replug *replug, const placido_error *why, placido_error *err) {
  replug->plug = PLACIDO_GIVEN_UP;
  return placido_error_set(err, PLACIDO_GONE, "%s; waited %g s for it to come back",
                           why->text[0] ? why->text : "the device is gone", replug->patience_s);
}

int placido_replug_wait(placido_replug *replug, int64_t until_ns, placido_error *err) {
  placido_error why = {0};
  while (replug->plug == PLACIDO_AWAITED) {
    int64_t now_ns = replug->clock->now_ns();
    if (now_ns >= replug->next_try_ns || now_ns >= replug->deadline_ns) {
      const bool is_last = now_ns >= replug->deadline_ns;
      const int status = try_start(replug, &why);
      if (status == PLACIDO_MEMORY) {
        return placido_error_set(err, status, "%s", why.text);
      }
      if (status && is_last) {
        return give_up(replug, &why, err);
      }
      now_ns = replug->clock->now_ns();
    }
    if (replug->plug == PLACIDO_AWAITED && now_ns >= until_ns) {
      return placido_error_set(err, PLACIDO_TIMEOUT,
                               "waiting for the %s device to be plugged in again",
                               replug->driver->scheme);
    }
    if (replug->plug == PLACIDO_AWAITED) {
      const int64_t wake_ns = least(least(replug->next_try_ns, replug->deadline_ns), until_ns);
      replug->clock->sleep_ms((int)((wake_ns - now_ns) / 1000000 + 1));
    }
  }
  return replug->plug == PLACIDO_PLUGGED
             ? PLACIDO_OK
             : placido_error_set(err, PLACIDO_GONE, "the %s device did not come back within %g s",
                                 replug->driver->scheme, replug->patience_s);
}

void placido_replug_order(placido_order *order, uint64_t replugs, uint64_t *seq, int64_t *t_ns) {
  if (order->is_anew && order->any && *seq + order->shift_seq <= order->last_seq) {
    order->shift_seq = order->last_seq + 1 - *seq;
  }
  *seq += order->shift_seq;
  if (replugs > 0 && *t_ns != 0 && *t_ns < order->last_t_ns) {
    *t_ns = order->last_t_ns;
  }
  order->is_anew = false;
  order->any = true;
  order->last_seq = *seq;
  order->last_t_ns = *t_ns > order->last_t_ns ? *t_ns : order->last_t_ns;
}
