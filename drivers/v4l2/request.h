/* What a device's address asks of a camera: "?size=1280x1024&format=GREY&fps=30&buffers=4". */
#ifndef PLACIDO_DRIVERS_V4L2_REQUEST_H
#define PLACIDO_DRIVERS_V4L2_REQUEST_H

#include "drivers/v4l2/convert.h"

#include <placido/status.h>

/* Sides of more pixels than this are a driver's error, not a camera. */
#define PLACIDO_V4L2_SIDE_MAX_PX 16384
/* What the kernel gives at most. */
#define PLACIDO_V4L2_BUFFERS_MAX 32

typedef struct placido_v4l2_request {
  int width_px, height_px;           /* 0: the largest that is listed; as the camera is set
                                      * where it lists a range */
  const placido_v4l2_format *format; /* NULL: the best for mires */
  double rate_hz;                    /* 0: the fastest of the size */
  int buffers;                       /* 2 to 32 */
} placido_v4l2_request;

/* The settings that this file knows, ended by NULL. */
extern const char *const placido_v4l2_options[];

/* Reads the settings that are known from a query ("size=...&fps=...", may be NULL) and skips the
 * others: they are controls. Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_v4l2_request_read(placido_v4l2_request *request, const char *query,
                              placido_error *err);

#endif
