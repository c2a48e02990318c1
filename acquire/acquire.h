/* Acquisition: taking frames from a device and choosing those that show the mires best. */
#ifndef PLACIDO_ACQUIRE_ACQUIRE_H
#define PLACIDO_ACQUIRE_ACQUIRE_H

#include <placido/device.h>
#include <placido/frame.h>
#include <placido/notes.h>
#include <placido/status.h>

/* Which frame was taken and what it was taken from. */
typedef struct placido_choice {
  long index;   /* of the frame, counted from 0 */
  long frames;  /* that the device gave */
  long damaged; /* of these: could not be decoded, or are flagged as truncated or corrupt */
  double score; /* of the frame, as placido_frame_score gives it */
} placido_choice;

/* How well a frame shows mires about the image's centre: the root mean square of the grey levels'
 * radial slope beyond that of the tangential slope (noise and skin have both alike), averaged over
 * 24 cells of the largest disc in the image so that a part without mires counts in proportion, and
 * lowered by the share of saturated samples. Full scale per pixel; 0 where there is nothing. Of a
 * colour frame the best plane counts. Comparable between frames of one device only.
 * Returns PLACIDO_OK, PLACIDO_INPUT (a frame of less than 16 × 16 pixels), PLACIDO_MEMORY. */
int placido_frame_score(double *score, const placido_frame *frame, placido_error *err);

/* Starts the device, takes its frames and leaves in `frame` (the caller's) the one with the best
 * score, or frame number `wanted` where that is not negative. A damaged frame is taken only where
 * it is asked for or where there is no other; either gives a line in `notes` (may be NULL).
 * Of a device that gives frames without end 48 are looked at; a recording is read as fast as it can
 * be where its address gives no speed. Returns PLACIDO_OK, PLACIDO_INPUT (no frame, or no frame of
 * that number), PLACIDO_MEMORY and what the device returns. */
int placido_frame_choose(placido_frame *frame, placido_choice *choice, placido_device *device,
                         long wanted, placido_notes *notes, placido_error *err);

/* As placido_frame_choose, the `most` (at least 1) frames with the best scores, the best first, and
 * `*count` the number of them: fewer where there are not so many. Damaged frames are not among them
 * but for the first. `frames` and `choices` have `most` elements, which are overwritten; each frame
 * is to be freed. */
int placido_frames_choose(placido_frame *frames, placido_choice *choices, size_t most,
                          size_t *count, placido_device *device, placido_notes *notes,
                          placido_error *err);

#endif
