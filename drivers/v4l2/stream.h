/* Pictures from a camera: a bounded queue of memory-mapped buffers, or read() where it has none. */
#ifndef PLACIDO_DRIVERS_V4L2_STREAM_H
#define PLACIDO_DRIVERS_V4L2_STREAM_H

#include "drivers/v4l2/camera.h"
#include "drivers/v4l2/mjpeg.h"
#include "drivers/v4l2/mode.h"

#include <placido/device.h>
#include <placido/frame.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct placido_v4l2_buffer {
  uint8_t *bytes; /* mapped; NULL: not */
  size_t size;
  bool is_queued;
} placido_v4l2_buffer;

/* Zeroed is stopped. The counts go on over stops and starts. */
typedef struct placido_v4l2_stream {
  const placido_v4l2_camera *camera; /* NULL: stopped */
  const placido_v4l2_mode *mode;
  placido_v4l2_buffer buffers[PLACIDO_V4L2_BUFFERS_MAX];
  int buffer_count;
  uint8_t *read_buffer;        /* read() instead of a queue */
  placido_v4l2_mjpeg *decoder; /* NULL: the format is not compressed */
  bool is_broken;       /* must be started anew before the next picture */
  int failure_count;    /* in a row, without a picture between */
  bool any_taken;       /* since the kernel began to count */
  uint32_t kernel_seq;  /* its last */
  uint64_t next_seq;
  int64_t asleep_ns;    /* at the last look */
  int64_t mend_at_ns;   /* a damaged picture was the last one: when silence means a halt; 0: not */
  placido_device_statistics statistics;
} placido_v4l2_stream;

/* `camera` and `mode` must stay where they are until the stop. On failure nothing is held. Returns
 * PLACIDO_OK, PLACIDO_GONE, PLACIDO_SYSTEM, PLACIDO_UNSUPPORTED, PLACIDO_MEMORY. */
int placido_v4l2_stream_start(placido_v4l2_stream *stream, const placido_v4l2_camera *camera,
                              const placido_v4l2_mode *mode, int buffers, placido_error *err);

/* The next picture. A queue that fails is started anew, up to three times in a row. Returns
 * PLACIDO_OK, PLACIDO_TIMEOUT, PLACIDO_GONE (unplugged), PLACIDO_SYSTEM (it does not recover),
 * PLACIDO_INPUT (a compressed picture that is damaged; counted as corrupt), PLACIDO_MEMORY. */
int placido_v4l2_stream_next(placido_v4l2_stream *stream, placido_frame *frame, int timeout_ms,
                             placido_error *err);

/* Legal on a stopped stream. */
void placido_v4l2_stream_stop(placido_v4l2_stream *stream);

/* A DMA-BUF descriptor of one buffer of a started queue, to be closed by the caller; it outlives
 * the stream. Returns PLACIDO_OK, PLACIDO_INPUT (no such buffer), PLACIDO_UNSUPPORTED (the camera
 * cannot share its buffers). */
int placido_v4l2_stream_export(const placido_v4l2_stream *stream, int buffer, int *descriptor,
                               placido_error *err);

#endif
