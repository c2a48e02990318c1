/* The rays of a pupil behind the cornea, column by column: what every stage after the trace works
 * from. */
#ifndef PLACIDO_SIMULATE_RAYS_BUNDLE_H
#define PLACIDO_SIMULATE_RAYS_BUNDLE_H

#include "simulate/eye.h"

#include <placido/psf.h>
#include <placido/surface.h>
#include <stddef.h>

/* Rays by number; what became of those that did not arrive is counted, never dropped silently. */
typedef struct placido_bundle {
  size_t count;            /* rays that go on behind the cornea */
  double *x_mm, *y_mm;     /* where each meets the surface */
  double *depth_mm;        /* of that point behind the surface's point on the axis */
  double *u, *v;           /* slopes dx/dz, dy/dz behind the surface */
  double *weight;          /* its share of the pupil's area; with those lost they sum to 1 */
  long asked;              /* inside the pupil: count and the three that follow */
  long missed;             /* the surface is not defined there */
  long grazed;             /* met from behind or at more than 80 degrees */
  long reflected;          /* totally */
  double lost;             /* share of the weight of those three */
  double uncovered;        /* share of the weight where no data support the surface */
} placido_bundle;

/* Traces a pupil. `rays` is the pattern's number: over the pupil's square for the crosshatch, the
 * least one that has so many (19,801 are the seed's 100² + 99²), inside the pupil for the others;
 * at least 1. A ray of the crosshatch whose cell the rim crosses has the weight of the area inside.
 * Everything in `eye` is settled. Free with placido_bundle_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_bundle_new(placido_bundle *bundle, const placido_surface *surface,
                       const placido_apex *apex, const placido_eye *eye,
                       enum placido_pattern_kind pattern, long rays, int threads,
                       placido_error *err);
void placido_bundle_free(placido_bundle *bundle);

/* Optical path in millimetres from the plane through the surface's point on the axis, by the thin
 * lens that `eye` wears and the surface at (x, y), depth behind that plane, to `focus_mm` (x, y,
 * depth). By Fermat's principle the refracted direction does not appear. */
double placido_path_mm(const placido_eye *eye, double x_mm, double y_mm, double depth_mm,
                       const double focus_mm[3]);

/* chief_path_um less the path of each ray to `focus_mm`: micrometres, positive where light is ahead
 * of the chief ray's, through the pupil's centre. opd_um has room for bundle->count numbers. */
void placido_bundle_opd(double *opd_um, const placido_bundle *bundle, const placido_eye *eye,
                        const double focus_mm[3], double chief_path_um);

#endif
