/* A session over a replug: an unplugged device is waited for and started again, and numbers and
 * times grow over the gap. */
#ifndef PLACIDO_DRIVERS_REPLUG_H
#define PLACIDO_DRIVERS_REPLUG_H

#include "base/clock.h"
#include "drivers/driver.h"

#include <stdbool.h>
#include <stdint.h>

#define PLACIDO_REPLUG_MAX_S 3600

enum placido_plug {
  PLACIDO_PLUGGED,  /* as far as is known; the driver is started */
  PLACIDO_AWAITED,  /* unplugged; the driver is stopped */
  PLACIDO_GIVEN_UP, /* it did not come back in time */
};

/* The numbers and times of a device's frames, or of its events. */
typedef struct placido_order {
  bool any;       /* was given out */
  bool is_anew;   /* the next one is the first after a replug */
  uint64_t last_seq, shift_seq;
  int64_t last_t_ns;
} placido_order;

/* Zeroed but for driver, state and clock: plugged, and without patience. */
typedef struct placido_replug {
  const placido_driver *driver;
  void *state; /* the driver's */
  const placido_clock *clock;
  double patience_s;
  bool is_address_patient; /* patience_s stood in the address */
  enum placido_plug plug;
  int64_t deadline_ns, next_try_ns; /* while awaited */
  uint64_t count;
  placido_order frames, events;
} placido_replug;

/* What PLACIDO_GONE of a started driver leads to: true where the device is now waited for, and the
 * driver stopped; false where there is no patience (left). */
bool placido_replug_await(placido_replug *replug);

/* Waits for an awaited device until `until_ns`, and starts it. Returns PLACIDO_OK (it is plugged),
 * PLACIDO_TIMEOUT, PLACIDO_GONE (given up), PLACIDO_MEMORY. A start that is under way is not cut
 * short. */
int placido_replug_wait(placido_replug *replug, int64_t until_ns, placido_error *err);

/* Makes the number of what came grow, by at least 1, and its time not go back, over replugs. */
void placido_replug_order(placido_order *order, uint64_t replugs, uint64_t *seq, int64_t *t_ns);

#endif
