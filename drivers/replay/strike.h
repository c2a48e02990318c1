/* Which faults of a script strike a frame, and what they make of it. */
#ifndef PLACIDO_DRIVERS_REPLAY_STRIKE_H
#define PLACIDO_DRIVERS_REPLAY_STRIKE_H

#include "drivers/replay/faults.h"

#include <placido/frame.h>

/* How far a script has come. */
typedef struct placido_strikes {
  placido_faults faults;
  struct {
    bool has_begun;
    int64_t first; /* frame that it struck */
  } progress[PLACIDO_FAULTS_MAX];
} placido_strikes;

/* All that strikes one frame. */
typedef struct placido_strike {
  bool any[PLACIDO_FAULT_KINDS];
  int64_t delay_ns;
  int64_t absence_ns; /* of a disconnection; INT64_MAX: for ever */
} placido_strike;

/* Back to the script's beginning. */
void placido_strikes_rewind(placido_strikes *strikes);

/* What strikes frame number `frame`, t_ns after the first. A fault begins with the first frame that
 * is asked about at or after its own. */
placido_strike placido_strikes_at(placido_strikes *strikes, int64_t frame, int64_t t_ns);

/* Truncates and corrupts the frame, with its flags, as far as the strike says. */
void placido_strike_spoil(const placido_strike *strike, placido_frame *frame);

#endif
