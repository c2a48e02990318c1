/* Size and pixel format: the choice among what a camera offers. */
#ifndef PLACIDO_DRIVERS_U3V_MODE_H
#define PLACIDO_DRIVERS_U3V_MODE_H

#include "drivers/genicam/genicam.h"
#include "drivers/u3v/request.h"

#include <placido/device.h>
#include <placido/notes.h>

/* What was agreed with the camera. */
typedef struct placido_u3v_mode {
  const placido_pixel_format *format;
  int width_px, height_px;
  int offset_x_px, offset_y_px; /* 0 where the camera has none */
} placido_u3v_mode;

/* Sets format, size and offset as near to the request as the camera can, and notes each that is
 * not what was asked; the camera is told to go on until it is stopped. Returns PLACIDO_OK,
 * PLACIDO_UNSUPPORTED (no format that can be made into frames), PLACIDO_INPUT (the camera's
 * description lacks a size or is wrong), or what the camera's port returns. */
int placido_u3v_mode_set(placido_u3v_mode *mode, placido_genicam *features,
                         const placido_u3v_request *request, placido_notes *notes,
                         placido_error *err);

/* Calls `each` for every pixel format of the camera, with the range of sizes, and stops with its
 * value where that is not 0. `rates_hz`: lowest and highest frame rate that can be set; 0: none. */
int placido_u3v_modes(placido_genicam *features, const double rates_hz[2],
                      int (*each)(void *user, const placido_device_mode *mode), void *user,
                      placido_error *err);

/* Bytes of a row of the mode, without padding, and of the whole picture. */
size_t placido_u3v_mode_row_bytes(const placido_u3v_mode *mode);
size_t placido_u3v_mode_bytes(const placido_u3v_mode *mode);

#endif
