/* An instrument that is not what its drawing says, and balls before it. */
#ifndef PLACIDO_TEST_CALIBRATE_BALLS_H
#define PLACIDO_TEST_CALIBRATE_BALLS_H

#include <placido/instrument.h>
#include <placido/surface.h>
#include <stdint.h>

/* Random numbers that are the same everywhere. */
typedef struct chance {
  uint64_t state;
} chance;

double chance_even(chance *c);   /* -1 to 1 */
double chance_normal(chance *c); /* standard deviation 1 */

/* Every edge's radius and height up to 0.2 mm off, the focal length 1 %, the principal point up to
 * 5 px, the camera up to 0.1 mm across and 0.5 mm along the axis, and a distortion of up to 1.5 px
 * (k1) and 1 px (k2) in the corners. */
placido_instrument balls_spoil(const placido_instrument *nominal, chance *c);

/* A ball with its vertex at (x, y, z). The caller frees it. */
placido_surface *balls_new(double radius_mm, double x_mm, double y_mm, double z_mm);

#endif
