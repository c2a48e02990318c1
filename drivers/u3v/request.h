/* What a device's address asks of a camera: "?size=1280x1024&offset=0,0&format=Mono8&fps=30". */
#ifndef PLACIDO_DRIVERS_U3V_REQUEST_H
#define PLACIDO_DRIVERS_U3V_REQUEST_H

#include "drivers/u3v/wire/pixel.h"

#include <placido/status.h>
#include <stdbool.h>

#define PLACIDO_U3V_BUFFERS_MAX 32
#define PLACIDO_U3V_SIDE_MAX_PX 65536

typedef struct placido_u3v_request {
  int width_px, height_px;            /* 0: as the camera is set */
  int offset_x_px, offset_y_px;       /* of the pictures on the sensor; -1: in the middle where a
                                       * size is asked for, else as the camera is set */
  const placido_pixel_format *format; /* NULL: the best that the camera has */
  double rate_hz;                     /* 0: as the camera is set */
  int buffers;                        /* pictures that wait at most: 2 to 32 */
} placido_u3v_request;

/* The settings that this file knows, ended by NULL. */
extern const char *const placido_u3v_options[];

/* Reads the settings that are known from a query ("size=...&fps=...", may be NULL) and skips the
 * others: they are controls. Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_u3v_request_read(placido_u3v_request *request, const char *query, placido_error *err);

#endif
