/* Cameras of the kernel (Video for Linux). */
#ifndef PLACIDO_DRIVERS_V4L2_V4L2_H
#define PLACIDO_DRIVERS_V4L2_V4L2_H

#include "drivers/driver.h"
#include "drivers/v4l2/calls.h"

extern const placido_driver placido_v4l2_driver;

/* The driver's open and scan over other system calls; `calls` must outlive the state. */
int placido_v4l2_open(void **state, const char *address, const placido_v4l2_calls *calls,
                      placido_notes *notes, placido_error *err);
int placido_v4l2_scan(const placido_v4l2_calls *calls,
                      int (*found)(void *user, const char *uri, const char *description),
                      void *user, placido_error *err);

/* A DMA-BUF descriptor of one of the buffers of an open and started camera; see
 * placido_v4l2_stream_export. */
int placido_v4l2_export(const void *state, int buffer, int *descriptor, placido_error *err);

#endif
