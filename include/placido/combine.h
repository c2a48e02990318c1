/* Several frames of one eye made into one: the same mires with less noise. */
#ifndef PLACIDO_COMBINE_H
#define PLACIDO_COMBINE_H

#include <placido/mires.h>
#include <placido/reconstruct.h>

/* More than this would take longer than an eye stays put, and gain little. */
#define PLACIDO_COMBINE_MAX 32

/* What became of one frame. */
typedef struct placido_movement {
  double weight;        /* its share in the means, of all frames 1; 0: it was set aside */
  double shift_mm[3];   /* of the corneal vertex from its mean place, in the instrument's frame */
  double turn_deg[3];   /* of the eye about x, y and z through the cornea's centre of curvature, from
                           their means; what no mire tells of it counts as 0 */
  double spread_px;     /* robust standard deviation of its edge points about the combined ones */
  double bias_px;       /* the same of the part that does not average out along an edge, told as
                           the spread of independent points that would explain it */
} placido_movement;

/* Combines the mires of `count` frames (1 to PLACIDO_COMBINE_MAX) of one eye, all found with the
 * same instrument and meridians, into those that the eye would show at the weighted mean of its
 * places: its movement is found and removed, and every edge point is the robust mean over the frames
 * that have it (at least half of them), with the standard deviation of that mean. Of three frames
 * or more, those that disagree with the others are set aside. The first frame, which should be the
 * best, is fitted with `options` (may be NULL) on the way; the distance that they give is that of
 * the mean place.
 * `movements` (may be NULL) receives `count` elements. Free with placido_mires_free.
 * Returns PLACIDO_OK, PLACIDO_INPUT (count, or lists that do not match), PLACIDO_QUALITY (the first
 * frame cannot be fitted), PLACIDO_MEMORY. */
int placido_mires_combine(placido_mires *combined, placido_movement *movements,
                          const placido_mires *list, size_t count,
                          const placido_instrument *instrument,
                          const placido_fit_options *options, placido_error *err);

#endif
