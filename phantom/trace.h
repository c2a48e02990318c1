/* One ray's way from the camera over the cornea to the mires. */
#ifndef PLACIDO_PHANTOM_TRACE_H
#define PLACIDO_PHANTOM_TRACE_H

#include "phantom/film.h"
#include "phantom/profile.h"

#include <placido/surface.h>

#define PLACIDO_PHANTOM_NO_BAND (-2)

/* What rays are traced through. Everything is borrowed. */
typedef struct placido_phantom_rig {
  const placido_surface *surface;
  const placido_instrument *instrument;
  const placido_phantom_film *film; /* NULL: the film is whole */
  placido_phantom_profile profile;
  double shift_mm[3]; /* of the eye */
} placido_phantom_rig;

/* Where a ray went. Also the start for a ray nearby; zeroed where there is none yet. */
typedef struct placido_phantom_hit {
  bool on_cornea;
  double point_mm[3]; /* on the cornea, in the eye's own coordinates */
  double slope[2];    /* of the sag there */
  int band; /* of the mires (profile.h); PLACIDO_PHANTOM_NO_BAND where there is no cornea */
} placido_phantom_hit;

placido_phantom_rig placido_phantom_rig_of(const placido_surface *surface,
                                           const placido_instrument *instrument,
                                           const double shift_mm[3],
                                           const placido_phantom_film *film);

/* Traces the ray of a pair of normalised coordinates. `hit` holds a ray nearby before and this
 * one afterwards; where it started from changes the result by less than 1e-11 mm. */
void placido_phantom_trace(const placido_phantom_rig *rig, const double normalised[2],
                           placido_phantom_hit *hit);

/* Whether a band of the instrument's mires is lit. They alternate, within edge 0 and beyond the
 * last edge too: otherwise those would be no edges. */
bool placido_phantom_is_bright(const placido_instrument *instrument, int band);

#endif
