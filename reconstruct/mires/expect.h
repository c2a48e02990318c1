/* Where the mires would be on an ordinary cornea: the scale to which everything seen is compared.
 */
#ifndef PLACIDO_MIRES_EXPECT_H
#define PLACIDO_MIRES_EXPECT_H

#include <placido/instrument.h>

/* Radius in the image (pixels) at which each edge is mirrored by a sphere of `sphere_mm` whose
 * vertex is the origin; NaN for edges that it does not mirror to the camera. `radius_px` has
 * edge_count elements. */
void placido_mires_expect(double *radius_px, const placido_instrument *instrument,
                          double sphere_mm);

#endif
