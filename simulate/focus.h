/* The best focus: where the retina must stand, and with which cross-cylinder before the eye, for
 * the light to come together in a peak. */
#ifndef PLACIDO_SIMULATE_FOCUS_H
#define PLACIDO_SIMULATE_FOCUS_H

#include "simulate/eye.h"
#include "simulate/trace.h"

#define PLACIDO_FOCUS_SEARCH_SAMPLES 37 /* crosshatch of 2,665 rays, 2,000 of them in the pupil */
#define PLACIDO_FOCUS_SETTLE_SAMPLES 75 /* 11,101 rays: on a flat top, fewer decide by chance */

/* The rays of a pupil, sparse to search and dense to settle, and what their angles are reckoned
 * by; borrowed. */
typedef struct placido_focus {
  const placido_rays *sparse, *dense;
  const placido_apex *apex;
  const placido_optics *optics;
} placido_focus;

/* Decides what is open in `eye`: retina_mm where it is 0, J0 and J45 where `correct` is set.
 * Returns PLACIDO_OK, or PLACIDO_QUALITY where the surface has no focus behind it. */
int placido_focus_search(const placido_focus *focus, placido_eye *eye, placido_error *err);

/* Millimetres on the eye's retina of a minute as the buckets count it. */
double placido_focus_arcmin_mm(const placido_focus *focus, const placido_eye *eye);

/* The retinal point at which the light is densest within about a minute: the point of fixation.
 * Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_focus_peak(const placido_focus *focus, const placido_eye *eye, double peak_mm[2],
                       placido_error *err);

#endif
