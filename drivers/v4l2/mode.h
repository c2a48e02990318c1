/* What a camera offers (formats, sizes, rates), and the choice among it. */
#ifndef PLACIDO_DRIVERS_V4L2_MODE_H
#define PLACIDO_DRIVERS_V4L2_MODE_H

#include "drivers/v4l2/camera.h"
#include "drivers/v4l2/convert.h"
#include "drivers/v4l2/request.h"

#include <placido/device.h>
#include <placido/notes.h>
#include <placido/status.h>

/* A picture of more bytes is a driver's error. */
#define PLACIDO_V4L2_PICTURE_MAX_BYTES ((size_t)1 << 30)

/* One format and size of a camera, with its rates. */
typedef struct placido_v4l2_offer {
  char name[8];                      /* of the format; its four characters where it is unknown */
  char description[33];              /* the kernel's words for the format */
  const placido_v4l2_format *format; /* NULL: cannot be made into frames */
  int width_min_px, width_max_px, width_step_px; /* the same, step 0, where the size is fixed */
  int height_min_px, height_max_px, height_step_px;
  int rate_count;
  double rates_hz[PLACIDO_RATES_MAX]; /* of the largest size, as listed */
  bool any_rate; /* everything between the two rates; else just those listed */
} placido_v4l2_offer;

/* Calls `each` for every offer and stops with its value where that is not 0. Lists that do not end
 * are cut off. */
int placido_v4l2_offers(const placido_v4l2_camera *camera,
                        int (*each)(void *user, const placido_v4l2_offer *offer), void *user);

/* What was agreed with the camera. */
typedef struct placido_v4l2_mode {
  const placido_v4l2_format *format;
  int width_px, height_px;
  size_t stride_bytes;
  size_t picture_bytes; /* the fewest of a whole picture; 0 where it is compressed */
  size_t buffer_bytes;  /* as the camera wants them */
  double rate_hz;       /* NaN where the camera does not tell */
} placido_v4l2_mode;

/* Sets format, size and rate as near to the request as the camera can, and notes each that is not
 * what was asked. Returns PLACIDO_OK, PLACIDO_SYSTEM (the camera refuses, or answers nonsense),
 * PLACIDO_UNSUPPORTED (nothing that can be made into frames). */
int placido_v4l2_mode_set(placido_v4l2_mode *mode, const placido_v4l2_camera *camera,
                          const placido_v4l2_request *request, placido_notes *notes,
                          placido_error *err);

#endif
