/* A camera played from a script, in the place of the kernel's system calls. */
#ifndef PLACIDO_TESTS_DRIVERS_V4L2_FAKE_H
#define PLACIDO_TESTS_DRIVERS_V4L2_FAKE_H

#include "drivers/v4l2/calls.h"

#include <linux/videodev2.h>
#include <stdbool.h>

#define FAKE_BUFFERS 40
#define FAKE_EVENTS 64

/* What comes of the next pictures, one after another; behind the last all goes well. */
struct fake_event {
  int code;          /* errno of DQBUF or read; 0: a picture */
  uint32_t flags;    /* further V4L2_BUF_FLAG_... */
  uint32_t skip;     /* so many pictures are lost before it */
  bool is_short;     /* `used` is what bytesused says */
  uint32_t used;
  bool is_elsewhere; /* `index` is what the buffer is called */
  uint32_t index;
  bool is_silent;    /* nothing comes: the wait runs out */
  bool is_unplug;
};

struct fake_control {
  uint32_t id, type, flags;
  const char *name;
  int64_t min, max, step, value;
};

struct fake_offer {
  uint32_t fourcc, width, height, rates[4];
};

/* The one camera: set up by the test, changed by the driver's calls. */
struct fake {
  /* who it is */
  const char *card, *bus;
  const char *second_bus; /* of /dev/video1; NULL: there is none */
  bool is_multiplanar, can_stream, can_read, is_not_camera, gives_no_sizes, cannot_export, has_rate;
  bool has_size_range; /* even numbers up to a million */
  struct fake_offer offers[8];
  struct fake_control controls[16];
  const uint8_t *picture; /* its bytes; NULL: zeros */
  size_t picture_size;

  /* what it lies about; 0: nothing */
  uint32_t lie_width, lie_height, lie_stride, lie_size, lie_fourcc, lie_planes;
  uint32_t lie_count, lie_length, lie_data_offset;
  bool lists_never_end, is_always_ready;
  int64_t lie_seconds;

  /* how it is */
  uint32_t fourcc, width, height, stride, size, rate;
  struct {
    uint8_t *bytes;
    bool is_queued;
  } buffers[FAKE_BUFFERS];
  uint32_t buffer_count, buffer_size;
  uint32_t queue[FAKE_BUFFERS], queue_length; /* the order they were queued in */
  bool is_streaming, is_gone;
  int node;          /* it is /dev/video<node> */
  int generation;    /* of the plug: a descriptor of an earlier one is dead */
  uint32_t sequence; /* of the next picture */
  struct fake_event events[FAKE_EVENTS];
  int event_count, event_next;
  int64_t clock_ns, asleep_ns;

  /* what is open */
  int open_count, mapped_count;
  int streamon_count, last_open_flags;
  bool is_second; /* what was opened last */

  /* which call fails: the fail_at-th from now (1 = the next), and those behind it too */
  int fail_at, fail_code, call_count;
  bool fails_for_ever;
};

extern struct fake fake;
extern const placido_v4l2_calls fake_calls;

/* A camera with one GREY offer of 8 x 4 pixels at 30 and 60 frames/s and no controls. */
void fake_reset(void);
/* Adds an event. */
void fake_next(struct fake_event event);
void fake_unplug(void);
void fake_replug(void);

#endif
