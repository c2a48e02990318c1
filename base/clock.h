/* The monotonic clock, as the kernel stamps frames; tests play it. */
#ifndef PLACIDO_BASE_CLOCK_H
#define PLACIDO_BASE_CLOCK_H

#include <stdint.h>

typedef struct placido_clock {
  int64_t (*now_ns)(void);
  void (*sleep_ms)(int duration_ms);
} placido_clock;

/* CLOCK_MONOTONIC in nanoseconds. */
int64_t placido_clock_now_ns(void);

/* The system's: placido_clock_now_ns, and a sleep that a signal may end early. */
extern const placido_clock placido_clock_monotonic;

#endif
