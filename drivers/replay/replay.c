/* A recorded session, or one image file, as a device: its frames in order, at a chosen speed.
 *
 * A frame that cannot be decoded is told as PLACIDO_INPUT in its turn, so that whoever counts
 * frames counts as the recording does; the message of PLACIDO_END says how many there were. */
#include "drivers/replay/replay.h"

#include "base/memory.h"
#include "base/text.h"

#include <placido/image.h>
#include <placido/session.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

enum replay_control { SPEED, LOOP, CONTROL_COUNT };

static const placido_control controls[CONTROL_COUNT] = {
    [SPEED] = {.name = "speed",
               .unit = "times the recorded speed",
               .help = "0: every frame as soon as it is asked for",
               .min = 0,
               .max = 1000,
               .step = 0.01},
    [LOOP] = {.name = "loop",
              .unit = "(0 or 1)",
              .help = "1: begin anew behind the last frame",
              .min = 0,
              .max = 1,
              .step = 1},
};

typedef struct replay {
  placido_device_info info;
  placido_session_reader *session; /* NULL: one image */
  double settings[CONTROL_COUNT];
  double rate_hz;

  placido_frame waiting; /* decoded, not yet due; of an image: the image */
  bool is_waiting;
  bool joins;            /* the next frame is the first of a further round */
  bool any_taken;        /* the source is not at its first frame any more */
  int64_t round_count;   /* frames since the source's beginning */
  int64_t damaged_count; /* since start */

  int64_t clock_start_ns;              /* when the first frame was due */
  int64_t first_t_ns, last_t_ns;       /* as given out */
  uint64_t last_seq;                   /* as given out */
  bool any_given;                      /* since start */
  int64_t shift_t_ns, shift_seq;       /* what the loops before this one add */
} replay;

static int64_t clock_ns(void) {
  struct timespec now = {0};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int copy_text(char *out, size_t size, const char *text, placido_error *err) {
  int length = snprintf(out, size, "%s", text);
  if (length < 0 || (size_t)length >= size) {
    return placido_error_set(err, PLACIDO_INPUT, "the path ...%s is too long",
                             placido_text_tail(text));
  }
  return PLACIDO_OK;
}

static int describe_session(replay *state, placido_error *err) {
  const placido_session_info *session = placido_session_reader_info(state->session);
  placido_device_info *info = &state->info;
  memcpy(info->vendor, session->vendor, sizeof info->vendor);
  memcpy(info->model, session->model, sizeof info->model);
  memcpy(info->serial, session->serial, sizeof info->serial);
  memcpy(info->firmware, session->firmware, sizeof info->firmware);
  memcpy(info->eye, session->eye, sizeof info->eye);
  info->axis_z_mm = session->axis_z_mm;
  info->axis_z_sigma_mm = session->axis_z_sigma_mm;
  state->rate_hz = session->rate_hz;
  return copy_text(info->instrument_path, sizeof info->instrument_path,
                   placido_session_reader_instrument(state->session), err);
}

static int open_source(replay *state, const char *path, placido_notes *notes,
                       placido_error *err) {
  struct stat found;
  if (stat(path, &found) != 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot open %s: %s", placido_text_tail(path),
                             strerror(errno));
  }
  if (!S_ISDIR(found.st_mode)) {
    return placido_frame_load(&state->waiting, path, err);
  }
  int status = placido_session_reader_open(&state->session, path, notes, err);
  return status ? status : describe_session(state, err);
}

static void replay_close(void *pointer) {
  replay *state = pointer;
  placido_session_reader_close(state->session);
  placido_frame_free(&state->waiting);
  placido_memory_free(state);
}

static int replay_open(void **pointer, const char *address, placido_notes *notes,
                       placido_error *err) {
  *pointer = NULL;
  replay *state = placido_memory_new(1, sizeof *state, err);
  if (!state) {
    return PLACIDO_MEMORY;
  }
  state->rate_hz = state->info.axis_z_mm = state->info.axis_z_sigma_mm = NAN;
  int length = snprintf(state->info.uri, sizeof state->info.uri, "replay:%s", address);
  int status = length < (int)sizeof state->info.uri
                   ? open_source(state, address, notes, err)
                   : placido_error_set(err, PLACIDO_INPUT, "the path ...%s is too long",
                                       placido_text_tail(address));
  if (status) {
    replay_close(state);
    return status;
  }
  *pointer = state;
  return PLACIDO_OK;
}

static const placido_device_info *replay_info(const void *pointer) {
  const replay *state = pointer;
  return &state->info;
}

static const placido_control *replay_controls(const void *pointer, size_t *count) {
  (void)pointer;
  *count = CONTROL_COUNT;
  return controls;
}

static int replay_get(void *pointer, size_t control, double *value, placido_error *err) {
  (void)err;
  const replay *state = pointer;
  *value = state->settings[control];
  return PLACIDO_OK;
}

/* The clock of a running replay starts anew at the last frame given, so that a change of speed
 * does not jump. */
static int replay_set(void *pointer, size_t control, double value, placido_error *err) {
  (void)err;
  replay *state = pointer;
  state->settings[control] = control == LOOP ? round(value) : value;
  state->info.endless = state->settings[LOOP] > 0;
  if (state->any_given) {
    state->clock_start_ns = clock_ns();
    state->first_t_ns = state->last_t_ns;
  }
  return PLACIDO_OK;
}

static int rewind_source(replay *state, placido_error *err) {
  int status = PLACIDO_OK;
  if (state->session && state->any_taken) {
    status = placido_session_reader_rewind(state->session, err);
  }
  state->any_taken = false;
  state->round_count = 0;
  return status;
}

static int replay_start(void *pointer, placido_error *err) {
  replay *state = pointer;
  state->is_waiting = state->any_given = state->joins = false;
  state->shift_t_ns = state->shift_seq = state->damaged_count = 0;
  return rewind_source(state, err);
}

/* The next frame of the source into `waiting`. */
static int take_from_source(replay *state, placido_error *err) {
  if (!state->session) {
    bool first = !state->any_taken;
    state->any_taken = true;
    return first ? PLACIDO_OK
                 : placido_error_set(err, PLACIDO_END, "%s is a single image", state->info.uri);
  }
  state->any_taken = true;
  int status = placido_session_reader_next(state->session, &state->waiting, err);
  state->damaged_count += status == PLACIDO_INPUT;
  if (status == PLACIDO_END && state->damaged_count > 0) {
    placido_error_set(err, PLACIDO_END, "%s has no further frame (%lld were damaged)",
                      placido_text_tail(state->info.uri), (long long)state->damaged_count);
  }
  return status;
}

static int begin_next_round(replay *state, placido_error *err) {
  int status = rewind_source(state, err);
  state->joins = true;
  return status ? status : take_from_source(state, err);
}

/* Behind the last frame, time and counter go on by one frame's step into the next round. */
static void join_rounds(replay *state) {
  int64_t step_ns = state->rate_hz > 0 ? llround(1e9 / state->rate_hz) : 1;
  state->joins = false;
  if (state->session) {
    state->shift_t_ns = state->last_t_ns + step_ns - state->waiting.t_ns;
    state->shift_seq = (int64_t)(state->last_seq + 1 - state->waiting.seq);
  }
}

static int fetch(replay *state, placido_error *err) {
  int status = take_from_source(state, err);
  if (status == PLACIDO_END && state->settings[LOOP] > 0 && state->round_count > 0) {
    status = begin_next_round(state, err);
  }
  if (status) {
    return status;
  }
  if (state->joins) {
    join_rounds(state);
  }
  state->is_waiting = true;
  state->round_count++;
  if (!state->any_given) {
    state->clock_start_ns = clock_ns();
    state->first_t_ns = state->waiting.t_ns;
  }
  return PLACIDO_OK;
}

/* Sleeps until the waiting frame is due, but not beyond the deadline. */
static int wait_until_due(const replay *state, int timeout_ms, placido_error *err) {
  double speed = state->settings[SPEED];
  if (!(speed > 0)) {
    return PLACIDO_OK;
  }
  int64_t elapsed_ns = state->waiting.t_ns + state->shift_t_ns - state->first_t_ns;
  int64_t now = clock_ns(), deadline = now + (int64_t)timeout_ms * 1000000;
  int64_t due = state->clock_start_ns + llround((double)elapsed_ns / speed);
  int64_t until = due < deadline ? due : deadline;
  const struct timespec wake = {.tv_sec = until / 1000000000, .tv_nsec = until % 1000000000};
  int interrupted =
      until > now ? clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, NULL) : 0;
  if (due > deadline || interrupted) {
    return placido_error_set(err, PLACIDO_TIMEOUT, "no frame within %d ms", timeout_ms);
  }
  return PLACIDO_OK;
}

/* Copies the waiting frame into the caller's. */
static int give(replay *state, placido_frame *frame, placido_error *err) {
  const placido_frame *waiting = &state->waiting;
  int status = placido_frame_resize(frame, waiting->width_px, waiting->height_px, waiting->format,
                                    err);
  if (status) {
    return status;
  }
  memcpy(frame->data, waiting->data, (size_t)waiting->height_px * waiting->stride_bytes);
  frame->bits = waiting->bits;
  frame->flags = waiting->flags;
  frame->t_ns = waiting->t_ns + state->shift_t_ns;
  frame->seq = waiting->seq + (uint64_t)state->shift_seq;
  state->last_t_ns = frame->t_ns;
  state->last_seq = frame->seq;
  state->any_given = true;
  state->is_waiting = false;
  return PLACIDO_OK;
}

static int replay_next(void *pointer, placido_frame *frame, int timeout_ms, placido_error *err) {
  replay *state = pointer;
  int status = state->is_waiting ? PLACIDO_OK : fetch(state, err);
  if (!status) {
    status = wait_until_due(state, timeout_ms, err);
  }
  return status ? status : give(state, frame, err);
}

const placido_driver placido_replay_driver = {
    .scheme = "replay",
    .summary = "a recorded session or an image file",
    .open = replay_open,
    .close = replay_close,
    .info = replay_info,
    .controls = replay_controls,
    .get = replay_get,
    .set = replay_set,
    .start = replay_start,
    .next = replay_next,
};
