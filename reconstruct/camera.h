/* The camera ray of an image point. */
#ifndef PLACIDO_RECONSTRUCT_CAMERA_H
#define PLACIDO_RECONSTRUCT_CAMERA_H

#include <placido/instrument.h>

/* A ray with its derivatives by the image point (u, v), so that a miss in millimetres can be told
 * in pixels. */
typedef struct placido_ray {
  double origin[3], direction[3];
  double origin_u[3], direction_u[3]; /* d/du */
  double origin_v[3], direction_v[3]; /* d/dv */
} placido_ray;

/* The ray that the camera sees at (u, v). The direction points at the eye (z = -1) and is not
 * normalised. Lens distortion is undone by Newton's method to rounding. */
placido_ray placido_camera_ray(const placido_instrument *instrument, double u_px, double v_px);

#endif
