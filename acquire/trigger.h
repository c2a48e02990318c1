/* When a burst begins and ends, and when the light is on: a state machine of key, pedal and score,
 * without a clock or a device of its own. */
#ifndef PLACIDO_ACQUIRE_TRIGGER_H
#define PLACIDO_ACQUIRE_TRIGGER_H

#include <stdbool.h>
#include <stdint.h>

/* What may start a burst; bits. */
#define PLACIDO_TRIGGER_KEY 1u
#define PLACIDO_TRIGGER_PEDAL 2u
#define PLACIDO_TRIGGER_AUTO 4u

/* "key", "pedal" or "auto" of one bit; a constant. */
const char *placido_trigger_name(unsigned source);

typedef struct placido_trigger_settings {
  unsigned sources;
  int burst;        /* frames of a burst, 1 to 10,000 */
  int warm_up;      /* frames between light on and the first of the burst */
  double score_min; /* automatic: the score that has to be held ... */
  double hold_s;    /* ... for this long */
  double rest_s;    /* after a burst, before the next automatic one */
  int bursts;       /* how many; 0: until the end */
} placido_trigger_settings;

typedef struct placido_trigger {
  placido_trigger_settings settings;
  bool is_good, rests;                /* the score is held; a burst was not long ago */
  int64_t good_since_ns, rests_until_ns;
  int warm_left, burst_left, bursts_done;
  bool is_lit;
} placido_trigger;

/* What is to be done with the frame just seen. */
typedef struct placido_trigger_action {
  bool light_on, light_off; /* switch it now */
  bool take;                /* the frame belongs to a burst */
  bool first, last;         /* of its burst */
  bool finished;            /* no further burst will come */
  unsigned source;          /* with light_on: which one of the sources it was */
} placido_trigger_action;

/* Begins dark and idle; `settings` are copied. */
void placido_trigger_start(placido_trigger *trigger, const placido_trigger_settings *settings);

/* One frame has come, at t_ns, which does not go back. `fired`: the sources that fired since the
 * last one; those not asked for, and all that fire while a burst runs, are ignored. `score` is that
 * of the frame, NaN where it is not known, which ends a hold. The frame that starts a burst was
 * exposed in the dark: the burst begins warm_up frames behind it. */
placido_trigger_action placido_trigger_frame(placido_trigger *trigger, int64_t t_ns, double score,
                                             unsigned fired);

#endif
