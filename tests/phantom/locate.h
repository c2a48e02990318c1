/* A simple edge finder for the phantom's tests: the centroid of the picture's radial derivative
 * about a predicted place. It knows nothing of optics. */
#ifndef PLACIDO_TESTS_PHANTOM_LOCATE_H
#define PLACIDO_TESTS_PHANTOM_LOCATE_H

#include <placido/frame.h>

/* Grey level at a place between pixels, scaled to 0..255, bilinear. */
double grey_between(const placido_frame *frame, double u_px, double v_px);

/* Where, within half_width_px of `place`, the grey steps along the unit vector `along` (rising > 0:
 * a rise is looked for, else a fall): px from `place` along the vector. *height is the step's. */
double locate_step(const placido_frame *frame, const double place[2], const double along[2],
                   double half_width_px, double rising, double *height);

/* Median of `count` values, which are reordered. */
double median_of(double *values, int count);

#endif
