/* Camera rays of pixels: the inverse of the projection in docs/formats.md. */
#include "phantom/camera.h"

#include "base/cv/cv.h"

#include <stdbool.h>

static bool is_distorted(const placido_instrument *instrument) {
  for (int i = 0; i < 5; i++) {
    if (instrument->distortion[i] != 0) {
      return true;
    }
  }
  return false;
}

int placido_phantom_camera_normalise(double *normalised, const double *uv, size_t count,
                                     const placido_instrument *instrument, placido_error *err) {
  if (is_distorted(instrument)) {
    return placido_cv_undistort(normalised, uv, count, instrument->focal_px,
                                instrument->principal_px, instrument->distortion, err);
  }
  for (size_t i = 0; i < 2 * count; i++) {
    normalised[i] = (uv[i] - instrument->principal_px[i & 1]) / instrument->focal_px[i & 1];
  }
  return PLACIDO_OK;
}

placido_phantom_ray placido_phantom_camera_ray(const placido_instrument *instrument,
                                               const double normalised[2]) {
  const double *place = instrument->position_mm;
  if (instrument->model == PLACIDO_TELECENTRIC) {
    return (placido_phantom_ray){
        .from = {place[0] + normalised[0], place[1] - normalised[1], place[2]},
        .along = {0, 0, -1},
    };
  }
  return (placido_phantom_ray){
      .from = {place[0], place[1], place[2]},
      .along = {normalised[0], -normalised[1], -1},
  };
}
