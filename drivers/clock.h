/* The monotonic clock, as the kernel stamps frames; tests play it. */
#ifndef PLACIDO_DRIVERS_CLOCK_H
#define PLACIDO_DRIVERS_CLOCK_H

#include <stdint.h>

typedef struct placido_clock {
  int64_t (*now_ns)(void);
  void (*sleep_ms)(int duration_ms);
} placido_clock;

extern const placido_clock placido_clock_monotonic;

#endif
