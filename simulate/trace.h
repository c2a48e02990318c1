/* Light from a distant point on the axis, through a thin lens on the cornea and the surface, to a
 * plane behind it. */
#ifndef PLACIDO_SIMULATE_TRACE_H
#define PLACIDO_SIMULATE_TRACE_H

#include "simulate/eye.h"
#include "simulate/rays/crosshatch.h"

#include <placido/surface.h>
#include <stdbool.h>
#include <stddef.h>

/* Where a ray meets the surface: position, depth behind the surface's point on the axis, slopes. */
typedef struct placido_entry {
  double x_mm, y_mm, depth_mm, sx, sy;
} placido_entry;

/* False where the surface is not defined. */
bool placido_entry_at(placido_entry *entry, const placido_surface *surface,
                      const placido_apex *apex, double x_mm, double y_mm);

/* Where the refracted ray meets the plane at retina_mm. False for a ray that cannot enter: it
 * meets the surface from behind or leaves it towards the camera. */
bool placido_entry_trace(const placido_entry *entry, const placido_eye *eye, double retina_mm,
                         double *x_mm, double *y_mm);

/* The entries of a whole pupil, kept so that the search of the focus asks the surface once. */
typedef struct placido_rays {
  placido_entry *entries;
  size_t count;
  long missed;     /* inside the pupil, where the surface is not defined */
  long uncovered;  /* of `count`: where no data support the surface */
} placido_rays;

/* Free with placido_rays_free. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_rays_new(placido_rays *rays, const placido_surface *surface, const placido_apex *apex,
                     const placido_eye *eye, int samples, placido_error *err);
void placido_rays_free(placido_rays *rays);

#endif
