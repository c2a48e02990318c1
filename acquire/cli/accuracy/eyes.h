/* The eyes that accuracy is measured on, from easy to hard: what the camera saw of each, the truth,
 * and what is found with every knob at its finest. */
#ifndef PLACIDO_CLI_ACCURACY_EYES_H
#define PLACIDO_CLI_ACCURACY_EYES_H

#include "acquire/cli/accuracy/sight.h"

#include <placido/instrument.h>
#include <placido/reconstruct.h>

struct accuracy_eye {
  const char *name;
  placido_instrument instrument;
  placido_surface *truth;
  double axis_z_mm;
  placido_frame frame;
  placido_mires mires; /* at the finest */
  placido_fit *fit;    /* of these, at the finest */
  struct accuracy_sight seen, true_seen; /* through it, and through the truth */
};

struct settings;

struct accuracy_bench {
  bool quick;
  int repeats; /* of what is timed: the least counts */
  const struct settings *settings; /* of examinations; borrowed */
  struct accuracy_knobs finest;
  struct accuracy_chart chart;
  size_t count;
  struct accuracy_eye *eyes;
};

/* Renders the frames of all eyes (`quick`: of two) with the noise of an ordinary camera, and finds
 * what is found at the finest.
 * `progress` (may be NULL) is called before each eye. Free with accuracy_bench_free, whatever the
 * status. */
int accuracy_bench_new(struct accuracy_bench *bench, const struct settings *settings, bool quick,
                       void (*progress)(void *user, const char *eye), void *user,
                       placido_error *err);
void accuracy_bench_free(struct accuracy_bench *bench);

/* One examination's mires, and their fit, in one thread. */
int accuracy_eye_mires(placido_mires *mires, const struct accuracy_eye *eye,
                       const struct accuracy_knobs *knobs, placido_error *err);
int accuracy_eye_fit(placido_fit **fit, placido_mires *mires, const struct accuracy_eye *eye,
                     const struct accuracy_knobs *knobs, placido_error *err);

#endif
