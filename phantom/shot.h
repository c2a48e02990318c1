/* One exposure of the phantom with all that a session varies from frame to frame. */
#ifndef PLACIDO_PHANTOM_SHOT_H
#define PLACIDO_PHANTOM_SHOT_H

#include <placido/phantom.h>

/* Everything is borrowed. */
typedef struct placido_phantom_shot {
  const placido_surface *surface;
  const placido_instrument *instrument;
  placido_disturbance disturbance; /* with its defaults filled in; `lid` is not looked at */
  double lid_mm;                   /* height of the lid's margin; INFINITY: out of sight */
  uint64_t number;                 /* of the frame: noise differs between frames */
  int threads;
} placido_phantom_shot;

/* Height of the drooping lid's margin. */
#define PLACIDO_PHANTOM_LID_MM 3.1

/* Checks what a caller asked for and fills in the defaults. `disturbance` may be NULL (none).
 * Returns PLACIDO_OK or PLACIDO_INPUT with the field named. */
int placido_phantom_shot_prepare(placido_phantom_shot *shot, const placido_surface *surface,
                                 const placido_instrument *instrument,
                                 const placido_disturbance *disturbance, int threads,
                                 placido_error *err);

/* Renders the shot into `frame`. */
int placido_phantom_shot_take(placido_frame *frame, const placido_phantom_shot *shot,
                              placido_error *err);

#endif
