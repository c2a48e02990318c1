/* From pixels to camera rays. */
#ifndef PLACIDO_PHANTOM_CAMERA_H
#define PLACIDO_PHANTOM_CAMERA_H

#include <placido/instrument.h>
#include <stddef.h>

/* A half-line; `along` is not of unit length. Camera rays have along[2] = -1. */
typedef struct placido_phantom_ray {
  double from[3], along[3];
} placido_phantom_ray;

/* Normalised coordinates (docs/formats.md) of `count` image points (pairs u, v), distortion undone
 * point by point. Returns PLACIDO_OK, or what placido_cv_undistort returns. */
int placido_phantom_camera_normalise(double *normalised, const double *uv, size_t count,
                                     const placido_instrument *instrument, placido_error *err);

/* The ray that is seen at a pair of normalised coordinates. */
placido_phantom_ray placido_phantom_camera_ray(const placido_instrument *instrument,
                                               const double normalised[2]);

#endif
