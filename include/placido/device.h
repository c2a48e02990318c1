/* A device that gives frames, opened by URI: `replay:PATH` (a session or an image),
 * `v4l2:/dev/videoN` (a camera); later `u3v:`, `gpio:`. Pull with a deadline; one thread at a
 * time. */
#ifndef PLACIDO_DEVICE_H
#define PLACIDO_DEVICE_H

#include <placido/frame.h>
#include <placido/notes.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct placido_device placido_device;

/* What a device tells of itself; empty strings and NaN where unknown. */
typedef struct placido_device_info {
  char uri[1024];
  char vendor[64], model[64], serial[64], firmware[64];
  char eye[8];                       /* replay: OD or OS of the session */
  char instrument_path[1024];        /* replay: the session's instrument.json; else empty */
  double axis_z_mm, axis_z_sigma_mm; /* replay: as the session has them; else NaN */
  bool endless;                      /* gives frames until it is stopped */
} placido_device_info;

/* A control of a device, as data. */
typedef struct placido_control {
  const char *name; /* lower case with its unit: exposure_us, gain_db, speed */
  const char *unit;
  const char *help;
  double min, max, step;
} placido_control;

/* What was counted since the device was opened. */
typedef struct placido_device_statistics {
  uint64_t frames;    /* given out */
  uint64_t dropped;   /* that the device's counter skipped */
  uint64_t corrupt;   /* flagged PLACIDO_FRAME_CORRUPT, or damaged beyond decoding */
  uint64_t truncated; /* given out, flagged PLACIDO_FRAME_TRUNCATED */
  uint64_t restarts;  /* of the stream, after an error */
  uint64_t replugs;   /* how often it was unplugged and came back in time; the device layer's */
} placido_device_statistics;

/* Opens a device. A URI without a known scheme is taken as replay:URI. Close with
 * placido_device_close. "?CONTROL=VALUE&..." behind an address sets controls; a note tells where
 * the device took another value. "replug_s=SECONDS" among them is every device's patience, see
 * placido_device_patience_set. Returns PLACIDO_OK, PLACIDO_INPUT (URI), PLACIDO_SYSTEM,
 * PLACIDO_UNSUPPORTED (scheme not in this build), PLACIDO_MEMORY. */
int placido_device_open(placido_device **device, const char *uri, placido_notes *notes,
                        placido_error *err);
void placido_device_close(placido_device *device);

/* Borrowed until the device is closed. */
const placido_device_info *placido_device_info_get(const placido_device *device);

/* The device's controls, `*count` of them; borrowed until the device is closed. */
const placido_control *placido_device_controls(const placido_device *device, size_t *count);
int placido_device_get(placido_device *device, const char *control, double *value,
                       placido_error *err);
int placido_device_set(placido_device *device, const char *control, double value,
                       placido_error *err);

#define PLACIDO_RATES_MAX 32

/* Pictures that a device can give: a format and a size, or a range of sizes. */
typedef struct placido_device_mode {
  char format[32];  /* as the device calls it: GREY, Mono12p */
  bool is_readable; /* can be made into frames by this build */
  int width_min_px, width_max_px, width_step_px; /* equal and step 0 where the size is fixed */
  int height_min_px, height_max_px, height_step_px;
  int rate_count;                     /* 0: not known */
  double rates_hz[PLACIDO_RATES_MAX]; /* of the largest size */
  bool any_rate;                      /* everything between the two listed; else just those */
} placido_device_mode;

/* Calls `each` for every mode of the device and stops with its value where that is not 0. Changes
 * nothing. Returns PLACIDO_OK, PLACIDO_UNSUPPORTED (a device of this kind has none to tell),
 * PLACIDO_SYSTEM, PLACIDO_GONE. */
int placido_device_modes(placido_device *device,
                         int (*each)(void *user, const placido_device_mode *mode), void *user,
                         placido_error *err);

/* Frames flow from start to stop. next fills `frame` (the caller's) within timeout_ms; it returns
 * PLACIDO_END when there will be no further frame, PLACIDO_TIMEOUT when none came in time,
 * PLACIDO_INPUT where a frame came that cannot be decoded: the next one may be whole, and
 * PLACIDO_GONE where the device was unplugged: a further start finds it once it is back. */
int placido_device_start(placido_device *device, placido_error *err);
int placido_device_next(placido_device *device, placido_frame *frame, int timeout_ms,
                        placido_error *err);
int placido_device_stop(placido_device *device, placido_error *err);

/* How long next and event wait for an unplugged device to come back, 0 (the default: not at all) to
 * 3,600 s; "replug_s=" in the address goes before it. Until then they return PLACIDO_TIMEOUT, each
 * within its own timeout_ms, and is_waiting is true; then PLACIDO_GONE. Once the device is back
 * frames flow on with the same settings: seq grows, by at least 1, and t_ns does not go back.
 * Returns PLACIDO_OK or PLACIDO_INPUT (out of range). */
int placido_device_patience_set(placido_device *device, double replug_s, placido_error *err);
bool placido_device_is_waiting(const placido_device *device);

/* What a device tells between or instead of pictures: a trigger, a foot pedal. */
typedef struct placido_event {
  int64_t t_ns;     /* monotonic, as the kernel stamped it */
  uint64_t seq;     /* of the device's events, from 1; a gap tells of lost ones */
  const char *name; /* "pedal"; borrowed until the device is closed */
  int value;        /* 1 pressed or begun, 0 released or ended */
} placido_event;

/* The next event of a started device within timeout_ms. PLACIDO_UNSUPPORTED: it has none. Returns
 * PLACIDO_OK, PLACIDO_TIMEOUT, PLACIDO_GONE, PLACIDO_SYSTEM. */
int placido_device_event(placido_device *device, placido_event *event, int timeout_ms,
                         placido_error *err);

/* Zeros where the device counts nothing. */
void placido_device_statistics_get(const placido_device *device,
                                   placido_device_statistics *statistics);

/* Calls `found` for every device that can be seen, driver by driver; stops and returns its value
 * where that is not 0. `scheme` may be NULL (all drivers). A driver that fails does not hide the
 * devices of the others; its status comes back at the end. */
int placido_device_scan(const char *scheme,
                        int (*found)(void *user, const char *uri, const char *description),
                        void *user, placido_error *err);

/* Calls `each` with scheme and summary of every driver in this build. */
void placido_driver_list(void (*each)(void *user, const char *scheme, const char *summary),
                         void *user);

#endif
