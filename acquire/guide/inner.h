/* The innermost mires as a pattern: found, centred and measured as a whole, for they are the ones
 * that stand in the dark pupil about a wide dark disc. */
#ifndef PLACIDO_GUIDE_INNER_H
#define PLACIDO_GUIDE_INNER_H

#include "acquire/guide/pattern.h"
#include "acquire/guide/view.h"
#include "acquire/guide/wave.h"

#include <stdbool.h>

/* The pattern in one sector of the picture: r = scale × (radius in the pattern) + shift_px. */
typedef struct placido_guide_sector {
  double scale, shift_px;
  double likeness; /* correlation of the picture with the pattern, -1..1 */
  double contrast; /* of the mires, share of full scale */
} placido_guide_sector;

typedef struct placido_guide_inner {
  bool found;
  double centre_px[2];
  double scale;    /* mean of the sectors that show the pattern */
  double contrast;
  double likeness;
  int good;        /* sectors that show it */
  placido_guide_sector sectors[PLACIDO_GUIDE_SECTORS];
} placido_guide_inner;

/* Looks for the pattern about polar->centre_px, moves the centre to that of the mires, and measures
 * them there. Fills the inner part of `polar`. */
void placido_guide_inner_find(placido_guide_inner *inner, const placido_guide_pattern *pattern,
                              placido_guide_polar *polar, const placido_guide_view *view);

/* Radius of a pattern radius along a meridian, interpolated between sectors. */
double placido_guide_inner_radius(const placido_guide_inner *inner, int meridian,
                                  double pattern_px);

#endif
