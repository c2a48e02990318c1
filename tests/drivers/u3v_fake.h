/* A USB3 Vision camera played from a script, below the pipe: its registers, its description, and
 * the bytes of its stream, with whatever goes wrong. */
#ifndef PLACIDO_TESTS_DRIVERS_U3V_FAKE_H
#define PLACIDO_TESTS_DRIVERS_U3V_FAKE_H

#include "drivers/u3v/pipe.h"
#include "drivers/u3v/wire/packet.h"
#include "drivers/u3v/wire/pixel.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FAKE_MEMORY 0x50000u
#define FAKE_SIRM 0x11000u
/* Registers of the features, as the description has them. */
enum {
  FAKE_WIDTH = 0x40000,
  FAKE_HEIGHT = 0x40004,
  FAKE_OFFSET_X = 0x40008,
  FAKE_OFFSET_Y = 0x4000c,
  FAKE_PIXEL_FORMAT = 0x40010,
  FAKE_START = 0x40018,
  FAKE_STOP = 0x4001c,
  FAKE_EXPOSURE_AUTO = 0x40020,
  FAKE_EXPOSURE = 0x40024, /* float */
  FAKE_GAIN = 0x40028,     /* float */
  FAKE_RATE_ENABLE = 0x4002c,
  FAKE_RATE = 0x40030, /* float */
  FAKE_TRIGGER_MODE = 0x40034,
  FAKE_TRIGGER_SOURCE = 0x40038,
  FAKE_TRIGGER = 0x4003c,
  FAKE_TEMPERATURE = 0x40040, /* float */
  FAKE_LOCKED = 0x40044,
  FAKE_BLACK = 0x40048,
  FAKE_EXPOSURE_RAW = 0x4004c,
};

#define FAKE_PERIOD_NS 10000000 /* 100 pictures a second */
#define FAKE_EXPOSED_NS 4000000 /* before its first byte */
#define FAKE_WIDTH_MAX 2048 /* of the sensor; pictures are 64 x 48 unless set otherwise */
#define FAKE_HEIGHT_MAX 1536

/* What comes of the next pictures, one after another; behind the last all goes well. */
struct fake_picture {
  uint32_t skip;            /* so many pictures are lost before it */
  bool no_leader, no_trailer;
  bool bad_leader, bad_trailer; /* bytes without sense in its place */
  uint64_t trailer_id_off;  /* by so much the trailer's number is wrong */
  uint16_t status;          /* of the trailer */
  bool is_short;            /* only `bytes` of the samples are sent */
  uint32_t bytes;
  bool is_padded;           /* ... and for the rest of the transfers empty ones */
  uint32_t valid_rows;      /* of the trailer; 0: all */
  uint32_t surplus;         /* bytes behind the samples */
  uint16_t payload_type;    /* 0: image */
  uint32_t width, height, format, padding; /* the leader's lies; 0: none */
  bool mimics_trailer;      /* its samples begin as a trailer of it would */
  bool resets_id;           /* the camera begins to count anew */
  bool is_late;             /* its time stamp is a day ahead */
  bool is_unplug, is_switched_off; /* instead of a picture */
};

struct fake_transfer {
  placido_u3v_transfer *transfer;
  void *pipe;
  bool is_cancelled;
};

struct fake {
  uint8_t memory[FAKE_MEMORY];
  placido_u3v_found found[3];
  int found_count;
  const char *without;         /* features with this in their names the camera does not have */
  const char *without_exactly; /* nor the one of this name */
  int64_t clock_ns, camera_ahead_ns;
  bool has_no_clock, answers_not, never_gives_back;
  size_t spare_bytes;       /* of the required payload */
  size_t usb_memory;        /* of the kernel */
  int64_t slow_ns;          /* an answer takes so long */

  struct fake_picture script[64];
  size_t script_count, script_next;

  /* the stream */
  bool is_acquiring, is_halted, is_gone;
  int generation;           /* of the plug: a pipe of an earlier one is dead */
  uint64_t next_id, sent;
  int64_t next_ns;
  int triggers;             /* waiting */
  struct fake_transfer pending[1024];
  size_t pending_count, flying_bytes, flying_most;
  size_t queue_ends[64], queue_count, queue_begin, queue_size; /* what the camera has to send */

  /* control channel: the answer that waits to be read */
  uint8_t answer[4096];
  size_t answer_size;

  /* what is open, and how often what was called */
  int open_count, own_count, starts, resets;

  /* which call fails: the fail_at-th from now (1 = the next), and those behind it too */
  int fail_at, call_count;
  enum placido_u3v_end fail_end;
  bool fails_for_ever;
  /* likewise for transfers that have ended */
  int transfer_fail_at, transfer_count;
  enum placido_u3v_end transfer_fail_end;
};

extern struct fake fake;
extern const placido_u3v_calls fake_calls;

/* A camera "S1" of 64 x 48 pixels Mono8 at 100 pictures a second. */
void fake_reset(void);
void fake_next(struct fake_picture picture);
void fake_unplug(void);
void fake_replug(void);

/* Its registers as they are after power came; its description; what it is set to. */
void fake_power_on(void);
void fake_describe(void);
const placido_pixel_format *fake_format(void);
size_t fake_picture_bytes(void);

uint32_t fake_get(uint32_t address);
void fake_put(uint32_t address, uint32_t value);
float fake_get_float(uint32_t address);
void fake_put_float(uint32_t address, float value);

/* All that can happen in the stream up to now; what was cancelled ends; whether pictures flow. */
void fake_catch_up(void);
void fake_end_cancelled(void);
bool fake_is_on(void);

/* The sample of a picture: its number, its place and the format's bits. */
uint8_t fake_sample(uint64_t id, size_t byte);

/* Lets time pass in which nobody looks. */
void fake_sleep_ms(int duration_ms);

#endif
