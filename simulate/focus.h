/* The best focus: where the retina must stand, or how strong the lens must be, and with which
 * cross-cylinder, for the light to serve the eye best. */
#ifndef PLACIDO_SIMULATE_FOCUS_H
#define PLACIDO_SIMULATE_FOCUS_H

#include "simulate/eye.h"
#include "simulate/trace.h"

#define PLACIDO_FOCUS_SEARCH_SAMPLES 37 /* crosshatch of 2,665 rays, 2,000 of them in the pupil */
#define PLACIDO_FOCUS_SETTLE_SAMPLES 75 /* 11,101 rays: on a flat top, fewer decide by chance */

/* Width of the profile by which light counts, (1 + d²/width²)^-3/2: what the neural sensitivity
 * exp(-0.071 deg × frequency) is as a function of place, 0.071 × 60' / 2 pi (docs/correction.md). */
#define PLACIDO_FOCUS_WIDTH_ARCMIN 0.68

/* Where a focus is sought: on a retina 4.5 to 270 mm behind the cornea. */
enum { PLACIDO_FOCUS_VERGENCE_MIN_D = 5, PLACIDO_FOCUS_VERGENCE_MAX_D = 300 };

/* The rays of a pupil, sparse to search and dense to settle, and what their angles are reckoned
 * by; borrowed. */
typedef struct placido_focus {
  const placido_rays *sparse, *dense;
  const placido_apex *apex;
  const placido_optics *optics;
} placido_focus;

/* What a search has found. */
typedef struct placido_focus_found {
  double quality;  /* share of the light within the profile: 1 for a point */
  long trials;     /* how often it was asked for, over all rays of a pupil */
} placido_focus_found;

/* Decides what is open in `eye`: where retina_mm is 0 that, else the lens's m_D where `correct` is
 * set; J0 and J45 where it is PLACIDO_CORRECT_FULL. `found` may be NULL.
 * Returns PLACIDO_OK, PLACIDO_QUALITY where there is no focus within reach, PLACIDO_MEMORY. */
int placido_focus_find(const placido_focus *focus, placido_eye *eye, placido_focus_found *found,
                       placido_error *err);

/* The same without what was found. */
int placido_focus_search(const placido_focus *focus, placido_eye *eye, placido_error *err);

/* Millimetres on the eye's retina of a minute as the buckets count it. */
double placido_focus_arcmin_mm(const placido_focus *focus, const placido_eye *eye);

/* The retinal point about which the light is densest by the same profile: the point of fixation.
 * Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_focus_peak(const placido_focus *focus, const placido_eye *eye, double peak_mm[2],
                       placido_error *err);

#endif
