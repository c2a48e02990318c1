/* A USB3 Vision camera: found by serial number, name or place, opened, its description read. */
#ifndef PLACIDO_DRIVERS_U3V_CAMERA_H
#define PLACIDO_DRIVERS_U3V_CAMERA_H

#include "drivers/genicam/genicam.h"
#include "drivers/u3v/bootstrap.h"
#include "drivers/u3v/channel.h"

/* Not to be moved while it is open. */
typedef struct placido_u3v_camera {
  const placido_u3v_calls *calls;
  void *pipe; /* NULL: closed */
  placido_u3v_found found;
  placido_u3v_channel channel;
  placido_u3v_bootstrap bootstrap;
  placido_genicam *features;
} placido_u3v_camera;

/* The one camera that an address fits: its serial number, the name that a user gave it, or
 * "place=4-1.2" (bus and ports); empty: whatever there is. Returns PLACIDO_OK, PLACIDO_GONE (none
 * fits), PLACIDO_INPUT (several do; says how to tell them apart), or what the list returns. */
int placido_u3v_camera_find(placido_u3v_found *found, const placido_u3v_calls *calls,
                            const char *address, placido_error *err);

/* Opens a camera that was found. On failure it is closed. Returns PLACIDO_OK, PLACIDO_GONE,
 * PLACIDO_SYSTEM (no permission, busy, no answer), PLACIDO_INPUT (registers or description that
 * make no sense), PLACIDO_UNSUPPORTED, PLACIDO_TIMEOUT, PLACIDO_MEMORY. */
int placido_u3v_camera_open(placido_u3v_camera *camera, const placido_u3v_found *found,
                            const placido_u3v_calls *calls, placido_error *err);

/* Legal on a closed camera. */
void placido_u3v_camera_close(placido_u3v_camera *camera);

/* As close, but leaves the pipe to the kernel, which does not give its transfers back: closing it
 * could wait for ever. */
void placido_u3v_camera_abandon(placido_u3v_camera *camera);

#endif
