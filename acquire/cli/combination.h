/* The frames that are combined with the best one, and what each gave. */
#ifndef PLACIDO_CLI_COMBINATION_H
#define PLACIDO_CLI_COMBINATION_H

#include "acquire/acquire.h"

#include <placido/combine.h>

struct examination;

/* Zeroed at first. */
struct combination {
  size_t chosen;                             /* frames, the best among them; 0: it is alone */
  placido_frame frames[PLACIDO_COMBINE_MAX]; /* until their mires are found; [0] is empty, the
                                                best is the examination's */
  placido_choice choices[PLACIDO_COMBINE_MAX];
  size_t count;                    /* frames with mires, the best first */
  long index[PLACIDO_COMBINE_MAX]; /* of each in its recording */
  placido_movement movements[PLACIDO_COMBINE_MAX];
  double offset_px[2]; /* of the best frame's mires (u, v) from the combined ones */
};

/* Takes the best frames of a device: the best one into the examination, the others beside it. */
int combination_capture(struct examination *examination, placido_device *device,
                        placido_error *err);

/* Finds the mires of the other frames and puts the combined ones in the place of the best frame's.
 * A frame that cannot be used is left out with a note. */
int combination_measure(struct examination *examination, placido_error *err);

void combination_free(struct combination *combination);

#endif
