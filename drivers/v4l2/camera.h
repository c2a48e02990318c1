/* A camera's node: found by path, serial number or place on the bus; opened, asked who it is, and
 * found again under another number. */
#ifndef PLACIDO_DRIVERS_V4L2_CAMERA_H
#define PLACIDO_DRIVERS_V4L2_CAMERA_H

#include "drivers/v4l2/calls.h"

#include <placido/status.h>
#include <linux/videodev2.h>
#include <stdbool.h>

typedef struct placido_v4l2_camera {
  const placido_v4l2_calls *calls;
  int fd;                      /* -1: closed */
  char path[1024];
  char card[33], driver[17], bus[33];
  char vendor[64], serial[64], firmware[64]; /* of the USB device; empty where it has none */
  char index[8];               /* which of its device's nodes it is; empty where unknown */
  bool is_multiplanar;
  bool can_stream, can_read;
  uint32_t type;               /* V4L2_BUF_TYPE_VIDEO_CAPTURE or ..._MPLANE */
} placido_v4l2_camera;

/* Opens the camera of an address without query: "serial=...", "bus=..." (as the kernel writes it:
 * usb-0000:00:14.0-1), or the path of a node or of a link to it. On failure the camera is closed.
 * Returns PLACIDO_OK, PLACIDO_SYSTEM (not there, busy, not a camera), PLACIDO_INPUT (an address
 * that fits several cameras). */
int placido_v4l2_camera_open(placido_v4l2_camera *camera, const char *address,
                             const placido_v4l2_calls *calls, placido_error *err);
void placido_v4l2_camera_close(placido_v4l2_camera *camera);

/* Whether the camera answers. Any failure may be that it was unplugged. */
bool placido_v4l2_camera_is_there(const placido_v4l2_camera *camera);

/* Whether another camera has the same serial number, as cheap ones do. */
bool placido_v4l2_camera_has_twin(const placido_v4l2_camera *camera);

/* Opens the camera `known`, which was unplugged, wherever it is now: by serial number and model, or
 * by its place on the bus and model where it has no serial number or a twin. `address` is what it
 * was opened by. On failure the camera is closed, and is described as before. Returns PLACIDO_OK,
 * PLACIDO_GONE (it is not there), PLACIDO_SYSTEM (it cannot be opened). */
int placido_v4l2_camera_find(placido_v4l2_camera *camera, const placido_v4l2_camera *known,
                             const char *address, bool has_twin, placido_error *err);

/* A sentence for errno `code` of an action ("starting"). PLACIDO_GONE where the camera does not
 * answer, else PLACIDO_SYSTEM with what the kernel said. */
int placido_v4l2_camera_failed(const placido_v4l2_camera *camera, const char *action, int code,
                               placido_error *err);

/* Calls `found` for every node that can capture, in the order of their numbers, and stops with its
 * value where that is not 0. Nodes that cannot be opened are passed over. The camera is open
 * during the call only. */
int placido_v4l2_camera_each(const placido_v4l2_calls *calls,
                             int (*found)(void *user, placido_v4l2_camera *camera), void *user,
                             placido_error *err);

#endif
