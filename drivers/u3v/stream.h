/* Pictures from a camera: a ring of transfers, checked piece by piece, started anew where it falls
 * out of step. */
#ifndef PLACIDO_DRIVERS_U3V_STREAM_H
#define PLACIDO_DRIVERS_U3V_STREAM_H

#include "drivers/u3v/camera.h"
#include "drivers/u3v/clock.h"
#include "drivers/u3v/mode.h"
#include "drivers/u3v/ring.h"

#include <placido/device.h>
#include <placido/frame.h>

/* Zeroed is stopped. The counts go on over stops and starts. */
typedef struct placido_u3v_stream {
  placido_u3v_camera *camera; /* NULL: stopped */
  const placido_u3v_mode *mode;
  int buffers;
  placido_u3v_ring *ring;  /* NULL: broken down in a restart */
  placido_u3v_clock clock;
  const char *trouble;     /* why it must be started anew; NULL: it need not */
  bool is_hung;            /* the kernel keeps transfers: the camera must be abandoned */
  int failure_count;       /* in a row, without a picture between */
  int64_t look_ns;         /* when to see whether a silent camera is there */
  bool any_taken;          /* since the camera began to count */
  bool is_restarted;       /* the camera may have begun to count anew */
  uint64_t camera_id;      /* its last */
  uint64_t lost;           /* pictures that a restart cost, as far as we saw them */
  uint64_t next_seq;
  placido_device_statistics statistics;
} placido_u3v_stream;

/* `camera` and `mode` must stay where they are until the stop. On failure nothing is held. Returns
 * PLACIDO_OK, PLACIDO_GONE, PLACIDO_SYSTEM, PLACIDO_INPUT (the camera's sizes make no sense),
 * PLACIDO_UNSUPPORTED (the camera refuses), PLACIDO_TIMEOUT (it does not answer),
 * PLACIDO_MEMORY. */
int placido_u3v_stream_start(placido_u3v_stream *stream, placido_u3v_camera *camera,
                             const placido_u3v_mode *mode, int buffers, placido_error *err);

/* The next picture. Samples that a frame can hold as they came are not copied: the frame's block is
 * swapped with the one that the picture came in. A stream that falls out of step is started anew,
 * up to three times in a row; that may take longer than timeout_ms where the camera is slow to
 * answer. Returns PLACIDO_OK, PLACIDO_TIMEOUT, PLACIDO_GONE (unplugged), PLACIDO_SYSTEM (does not
 * recover), PLACIDO_INPUT (a picture that is not as agreed; counted as corrupt), PLACIDO_MEMORY
 * (the picture waits for the next call). */
int placido_u3v_stream_next(placido_u3v_stream *stream, placido_frame *frame, int timeout_ms,
                            placido_error *err);

/* Legal on a stopped stream. */
void placido_u3v_stream_stop(placido_u3v_stream *stream);

#endif
