/* What the times and counters of a session's frames tell. */
#ifndef PLACIDO_BASE_SESSION_CLOCK_H
#define PLACIDO_BASE_SESSION_CLOCK_H

#include "base/session/ranges.h"

#include <placido/session.h>
#include <placido/status.h>

/* Start with a zeroed struct; free with placido_clock_free. */
typedef struct placido_clock {
  struct placido_tick *ticks;
  size_t count;
} placido_clock;

typedef struct placido_clock_figures {
  double seconds;    /* from the first frame to the last; NaN: fewer than two, or times unknown */
  double rate_hz;    /* the camera's: by its counter, frames that are missing included */
  double jitter_ms;  /* root mean square of the steps' deviation from that rate */
  double longest_ms; /* step from one frame to the next */
  int64_t backwards; /* steps that do not go forward */
  int64_t missing;   /* frames that the counter leaves out */
  int64_t restarts;  /* steps at which the counter does not grow: the camera began anew */
} placido_clock_figures;

/* Adds the next frame. */
int placido_clock_add(placido_clock *clock, const placido_frame_info *frame, placido_error *err);

/* `gaps` gets the numbers of the frames before which frames are missing; may be NULL. */
int placido_clock_read(placido_clock_figures *figures, const placido_clock *clock,
                       placido_ranges *gaps, placido_error *err);

void placido_clock_free(placido_clock *clock);

#endif
