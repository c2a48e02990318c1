/* The best focus: where the retina must stand, and with which cross-cylinder before the eye, for
 * the light to come together in a peak. */
#ifndef PLACIDO_SIMULATE_FOCUS_H
#define PLACIDO_SIMULATE_FOCUS_H

#include "simulate/eye.h"
#include "simulate/trace.h"

#define PLACIDO_FOCUS_SAMPLES 37 /* crosshatch of 2,665 rays, 2,000 of them in the pupil */

/* The rays of a pupil with room for where they land. */
typedef struct placido_focus {
  const placido_rays *rays;
  const placido_apex *apex;
  const placido_optics *optics;
  double *x_mm, *y_mm; /* where they land, rays->count at most */
} placido_focus;

/* Free with placido_focus_free; the rest is borrowed until then. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_focus_new(placido_focus *focus, const placido_rays *rays, const placido_apex *apex,
                      const placido_optics *optics, placido_error *err);
void placido_focus_free(placido_focus *focus);

/* Decides what is open in `eye`: retina_mm where it is 0, J0 and J45 where `correct` is set.
 * Returns PLACIDO_OK, or PLACIDO_QUALITY where the surface has no focus behind it. */
int placido_focus_search(placido_focus *focus, placido_eye *eye, placido_error *err);

/* The retinal point at which the light is densest, found from the light's middle downwards through
 * ever narrower neighbourhoods: the point of fixation. */
void placido_focus_peak(placido_focus *focus, const placido_eye *eye, double *x_mm, double *y_mm);

#endif
