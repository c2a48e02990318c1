/* The camera's clock read on ours: when a picture was taken, in CLOCK_MONOTONIC. */
#ifndef PLACIDO_DRIVERS_U3V_CLOCK_H
#define PLACIDO_DRIVERS_U3V_CLOCK_H

#include "drivers/u3v/channel.h"

/* Exact to half a round trip on the control channel (some tenths of a millisecond) plus what the
 * two crystals part in the seconds between two looks (50 ppm: a quarter of a millisecond). */
typedef struct placido_u3v_clock {
  bool is_known;      /* offset_ns holds */
  bool is_absent;     /* the camera has no clock: not asked again */
  int64_t offset_ns;  /* ours less the camera's */
  int64_t trip_ns;    /* of the look that gave the offset */
  int64_t begin_ns;   /* of the stream: no picture is older */
  int64_t last_ns;    /* given out; time does not go backwards */
  int64_t next_ns;    /* when to look again */
} placido_u3v_clock;

/* Gets ready for a stream that begins now. Times given out before stay before those to come.
 * Returns PLACIDO_OK (with or without a clock) or PLACIDO_GONE. */
int placido_u3v_clock_begin(placido_u3v_clock *clock, placido_u3v_channel *channel,
                            placido_error *err);

/* Looks at both clocks where it is time to; returns as begin. */
int placido_u3v_clock_look(placido_u3v_clock *clock, placido_u3v_channel *channel,
                           placido_error *err);

/* Our time for a leader's. It is `arrival_ns`, when the leader was seen, where the camera has no
 * clock or its time cannot be: before the stream began, or after the arrival. */
int64_t placido_u3v_clock_time(placido_u3v_clock *clock, uint64_t camera_ns, int64_t arrival_ns);

#endif
