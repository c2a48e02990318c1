/* The angle that a pixel of a scene subtends. */
#ifndef PLACIDO_SIMULATE_CALIBRATION_H
#define PLACIDO_SIMULATE_CALIBRATION_H

#include "base/json.h"

/* Reads the object "calibration" of a scene file. `width_px` is the picture's, 0 where the picture
 * is a chart that has no size before its scale is known (kind "camera" is refused then).
 * Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_calibration_read(double *arcmin_per_px, const placido_json *json, int width_px,
                             placido_notes *notes, placido_error *err);

#endif
