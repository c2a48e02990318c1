/* The controls of a camera, as data: each of the kernel's with its name, unit and range. */
#ifndef PLACIDO_DRIVERS_V4L2_CONTROL_H
#define PLACIDO_DRIVERS_V4L2_CONTROL_H

#include "drivers/v4l2/camera.h"

#include <placido/device.h>

#define PLACIDO_V4L2_CONTROLS_MAX 128

/* What stands behind one row of the list. */
typedef struct placido_v4l2_control {
  uint32_t id;   /* the kernel's; 0: the frame rate */
  uint32_t type; /* V4L2_CTRL_TYPE_... */
  double factor; /* our unit per the kernel's */
  bool is_read_only, is_write_only;
  char name[40], help[200];
} placido_v4l2_control;

typedef struct placido_v4l2_controls {
  size_t count;
  placido_control rows[PLACIDO_V4L2_CONTROLS_MAX]; /* names and help borrowed from `behind` */
  placido_v4l2_control behind[PLACIDO_V4L2_CONTROLS_MAX];
} placido_v4l2_controls;

/* Lists the controls of the camera. `rates_hz`: lowest and highest frame rate that can be set; NaN:
 * there is none. The struct must not be moved afterwards. */
void placido_v4l2_controls_list(placido_v4l2_controls *controls,
                                const placido_v4l2_camera *camera, const double rates_hz[2]);

/* Return PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_UNSUPPORTED (read only). Where the camera regulates a
 * control by itself, setting it switches that off first. */
int placido_v4l2_control_get(const placido_v4l2_controls *controls,
                             const placido_v4l2_camera *camera, size_t control, double *value,
                             placido_error *err);
int placido_v4l2_control_set(const placido_v4l2_controls *controls,
                             const placido_v4l2_camera *camera, size_t control, double value,
                             placido_error *err);

#endif
