/* Takes a device's frames into a session: all of them, or bursts; with the light on for no longer
 * than they last. */
#ifndef PLACIDO_ACQUIRE_TAKING_H
#define PLACIDO_ACQUIRE_TAKING_H

#include "acquire/guide.h"
#include "acquire/recorder.h"
#include "acquire/trigger.h"

#include <placido/device.h>
#include <placido/session.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What whoever looks on sees: every frame as it comes, and several times a second where none
 * does. */
typedef struct placido_taking_view {
  const placido_frame *frame;       /* NULL: none came */
  const placido_guidance *guidance; /* of a frame not long ago; NULL: not known */
  placido_recorder *recorder;       /* to be asked how far it is; NULL: not begun */
  int bursts;                       /* that are over */
  bool is_lit, is_waiting;          /* in a burst, or about to be; unplugged */
} placido_taking_view;

/* What he wants; bits. */
#define PLACIDO_TAKING_FIRE 1u /* a burst: the key */
#define PLACIDO_TAKING_END 2u

typedef struct placido_taking_settings {
  placido_device *device;  /* not started */
  placido_device *light;   /* has a control "light"; NULL: none */
  placido_device *pedal;   /* tells of events "pedal", not started; NULL: none. May be the light */
  placido_guide *guide;    /* NULL: none; automatic bursts need one */
  const char *path, *instrument_path;
  placido_session_info info; /* format, bits and rate_hz come from the device; codec is that */
  bool chooses_codec;        /* info.codec is of no account: FFV1 where it is fast enough */
  size_t queue_bytes;        /* as in placido_recorder_open */
  double for_s;              /* end after so long by the device's time; 0: not */
  int64_t frames;            /* end after so many were recorded; 0: not */
  placido_trigger_settings trigger; /* no sources: every frame is recorded */
  unsigned (*look)(void *user, const placido_taking_view *view); /* must not take long; NULL: no */
  void *user;
} placido_taking_settings;

typedef struct placido_taking_result {
  placido_recorder_summary summary;
  bool is_begun; /* the session is there, if without a frame yet */
  enum placido_session_codec codec;
  int64_t seen, undecodable;
  int bursts;
} placido_taking_result;

/* Starts the device and takes its frames until it ends, `look` says so, or as many as asked for are
 * taken. A device without a control "frame_rate_hz" has its rate told by its first two frames; one
 * with a control "speed" at 0 (a replay) waits for the recorder, so that nothing is dropped.
 *
 * Whatever the status: the light is off, devices are stopped, and what was recorded is an orderly
 * session, in whose events stands why it ended early. Returns PLACIDO_OK; PLACIDO_GONE (the device
 * was lost), PLACIDO_TIMEOUT (it gives nothing); PLACIDO_INPUT (colour); PLACIDO_SYSTEM (disk full)
 * and what else devices and sessions return. */
int placido_taking_run(placido_taking_result *result, const placido_taking_settings *settings,
                       placido_error *err);

#endif
