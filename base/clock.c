/* The monotonic clock, as the kernel stamps frames. */
#include "base/clock.h"

#include <time.h>

int64_t placido_clock_now_ns(void) {
  struct timespec now = {0};
  clock_gettime(CLOCK_MONOTONIC, &now); /* cannot fail: the clock is there since Linux 2.6 */
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* A signal may end it early: callers look at the clock again. */
static void sleep_ms(int duration_ms) {
  const struct timespec duration = {.tv_sec = duration_ms / 1000,
                                    .tv_nsec = duration_ms % 1000 * 1000000L};
  nanosleep(&duration, NULL);
}

const placido_clock placido_clock_monotonic = {.now_ns = placido_clock_now_ns, .sleep_ms = sleep_ms};
