/* A recorded session, or one image file, as a device: its frames in order, in the time in which
 * they were recorded or at another speed, with such faults as a script asks for.
 *
 * A frame that cannot be decoded is told as PLACIDO_INPUT in its turn, so that whoever counts
 * frames counts as the recording does; the message of PLACIDO_END says how many there were. */
#include "drivers/replay/replay.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/text.h"
#include "drivers/replay/source.h"
#include "drivers/replay/strike.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define SCRIPT "faults"
#define LOST_AT_ONCE 100

enum replay_control { SPEED, LOOP, CONTROL_COUNT };

static const placido_control controls[CONTROL_COUNT] = {
    [SPEED] = {.name = "speed",
               .unit = "times the recorded speed",
               .help = "1, unless said: as it was recorded; 0: every frame as soon as it is asked "
                       "for",
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
  double settings[CONTROL_COUNT];
  placido_replay_source source;
  placido_strikes strikes;

  bool is_waiting;       /* source.frame is not given out yet */
  placido_strike strike; /* what is to become of it */
  int64_t fetched_ns;    /* when it was decoded */

  bool any_given;                /* since start */
  int64_t clock_start_ns;        /* when the frame of first_t_ns was due */
  int64_t first_t_ns, last_t_ns; /* the recording's time there, and of the last frame given */
  bool has_origin;               /* a frame was decoded since start */
  int64_t origin_t_ns;           /* its time */

  bool is_gone;        /* unplugged, by the script */
  int64_t back_ns;     /* when it is plugged in again; INT64_MAX: never */
  int64_t absent_t_ns; /* what was recorded before is lost */
  placido_device_statistics statistics;
} replay;

static void replay_close(void *pointer) {
  replay *state = pointer;
  placido_replay_source_close(&state->source);
  placido_memory_free(state);
}

/* Reads the script that the settings of an address name, if they do. */
static int read_script(replay *state, const char *query, placido_error *err) {
  const size_t name = strlen(SCRIPT "=");
  while (query && *query && strncmp(query, SCRIPT "=", name) != 0) {
    query += strcspn(query, "&");
    query += *query == '&';
  }
  if (!query || !*query) {
    return PLACIDO_OK;
  }
  char path[sizeof state->info.uri];
  const int length = (int)strcspn(query + name, "&");
  snprintf(path, sizeof path, "%.*s", length, query + name); /* the whole uri has room there */
  return placido_faults_load(&state->strikes.faults, path, err);
}

/* Opens the path in front of the settings; a path that exists has none, whatever marks it has. */
static int open_address(replay *state, const char *address, placido_notes *notes,
                        placido_error *err) {
  placido_device_info *info = &state->info;
  char path[sizeof info->uri];
  const int length = snprintf(info->uri, sizeof info->uri, "replay:%s", address);
  if (length < 0 || (size_t)length >= sizeof info->uri) {
    return placido_error_set(err, PLACIDO_INPUT, "the path ...%s is too long",
                             placido_text_tail(address));
  }
  strcpy(path, address);
  char *query = access(path, F_OK) == 0 ? NULL : strrchr(path, '?');
  if (query) {
    *query++ = '\0';
  }
  const int status = read_script(state, query, err);
  return status ? status : placido_replay_source_open(&state->source, info, path, notes, err);
}

static int replay_open(void **pointer, const char *address, placido_notes *notes,
                       placido_error *err) {
  *pointer = NULL;
  replay *state = placido_memory_new(1, sizeof *state, err);
  if (!state) {
    return PLACIDO_MEMORY;
  }
  state->settings[SPEED] = 1;
  const int status = open_address(state, address, notes, err);
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
    state->clock_start_ns = placido_clock_now_ns();
    state->first_t_ns = state->last_t_ns;
  }
  return PLACIDO_OK;
}

/* An unplugged device that is plugged in again goes on behind what was recorded meanwhile. */
static int come_back(replay *state, placido_error *err) {
  const int64_t left_ns = state->back_ns - placido_clock_now_ns();
  if (state->back_ns == INT64_MAX) {
    return placido_error_set(err, PLACIDO_GONE, "%s is unplugged for good, as its script says",
                             placido_text_tail(state->info.uri));
  }
  if (left_ns > 0) {
    return placido_error_set(err, PLACIDO_GONE,
                             "%s is unplugged for another %.1f s, as its script says",
                             placido_text_tail(state->info.uri), (double)left_ns / 1e9);
  }
  state->is_gone = state->is_waiting = state->any_given = false;
  return PLACIDO_OK;
}

static int replay_start(void *pointer, placido_error *err) {
  replay *state = pointer;
  if (state->is_gone) {
    return come_back(state, err);
  }
  state->is_waiting = state->any_given = state->has_origin = false;
  state->absent_t_ns = INT64_MIN;
  placido_strikes_rewind(&state->strikes);
  return placido_replay_source_rewind(&state->source, err);
}

static int take(replay *state, placido_error *err) {
  const int status = placido_replay_source_next(&state->source, state->settings[LOOP] > 0, err);
  if (!status && !state->has_origin) {
    state->has_origin = true;
    state->origin_t_ns = state->source.frame.t_ns;
  }
  return status;
}

/* Whether the frame just taken does not come: the script drops it, or it was recorded while the
 * device was unplugged. */
static bool is_lost(replay *state) {
  const int64_t t_ns = state->source.frame.t_ns;
  if (t_ns < state->absent_t_ns) {
    return true;
  }
  state->strike =
      placido_strikes_at(&state->strikes, state->source.frame_count - 1, t_ns - state->origin_t_ns);
  return state->strike.any[PLACIDO_FAULT_DROP];
}

/* Takes the next frame that comes. A row of lost ones may last beyond the deadline: for a few of
 * them that does not count at speed 0, where a loss takes no time. */
static int fetch(replay *state, int64_t deadline_ns, placido_error *err) {
  int passed_over = state->settings[SPEED] > 0 ? 0 : LOST_AT_ONCE;
  int status = take(state, err);
  while (!status && is_lost(state)) {
    state->statistics.dropped++;
    if (--passed_over < 0 && placido_clock_now_ns() > deadline_ns) {
      return placido_error_set(err, PLACIDO_TIMEOUT, "no frame in time: all were lost");
    }
    status = take(state, err);
  }
  if (status) {
    state->statistics.corrupt += status == PLACIDO_INPUT;
    return status;
  }
  state->is_waiting = true;
  state->fetched_ns = placido_clock_now_ns();
  if (!state->any_given) {
    state->clock_start_ns = state->fetched_ns;
    state->first_t_ns = state->source.frame.t_ns;
  }
  return PLACIDO_OK;
}

/* When the waiting frame is to be given out. */
static int64_t due_ns(const replay *state) {
  const double speed = state->settings[SPEED];
  if (!(speed > 0)) {
    return state->fetched_ns + state->strike.delay_ns;
  }
  const int64_t elapsed_ns = state->source.frame.t_ns - state->first_t_ns;
  return state->clock_start_ns + llround((double)elapsed_ns / speed) + state->strike.delay_ns;
}

/* Sleeps until the waiting frame is due, but not beyond the deadline. */
static int wait_until_due(const replay *state, int64_t deadline_ns, placido_error *err) {
  const int64_t due = due_ns(state), until = due < deadline_ns ? due : deadline_ns;
  const struct timespec wake = {.tv_sec = until / 1000000000, .tv_nsec = until % 1000000000};
  const int interrupted =
      until > placido_clock_now_ns() ? clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, NULL) : 0;
  if (due > placido_clock_now_ns() || interrupted) {
    return placido_error_set(err, PLACIDO_TIMEOUT, "no frame in time");
  }
  return PLACIDO_OK;
}

static int unplug(replay *state, placido_error *err) {
  const int64_t absence_ns = state->strike.absence_ns;
  const double speed = state->settings[SPEED] > 0 ? state->settings[SPEED] : 1;
  const bool for_good = absence_ns == INT64_MAX;
  state->is_gone = true;
  state->back_ns = for_good ? INT64_MAX : placido_clock_now_ns() + absence_ns;
  state->absent_t_ns =
      for_good ? INT64_MAX : state->source.frame.t_ns + llround((double)absence_ns * speed);
  state->statistics.dropped++;
  return placido_error_set(err, PLACIDO_GONE, "%s was unplugged, as its script says",
                           placido_text_tail(state->info.uri));
}

/* What the script puts in the place of the waiting frame, which is used up by that. */
static int strike_out(replay *state, placido_error *err) {
  const bool *any = state->strike.any;
  state->is_waiting = false;
  if (any[PLACIDO_FAULT_DISCONNECT]) {
    return unplug(state, err);
  }
  if (any[PLACIDO_FAULT_ERROR]) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s failed, as its script says",
                             placido_text_tail(state->info.uri));
  }
  state->source.damaged_count++;
  state->statistics.corrupt++;
  return placido_error_set(err, PLACIDO_INPUT, "frame %lld of %s is damaged, as its script says",
                           (long long)state->source.frame_count - 1,
                           placido_text_tail(state->info.uri));
}

static bool is_struck_out(const placido_strike *strike) {
  return strike->any[PLACIDO_FAULT_DISCONNECT] || strike->any[PLACIDO_FAULT_ERROR] ||
         strike->any[PLACIDO_FAULT_DAMAGE];
}

/* Copies the waiting frame into the caller's. */
static int give(replay *state, placido_frame *frame, placido_error *err) {
  const placido_frame *waiting = &state->source.frame;
  int status =
      placido_frame_resize(frame, waiting->width_px, waiting->height_px, waiting->format, err);
  if (status) {
    return status;
  }
  memcpy(frame->data, waiting->data, (size_t)waiting->height_px * waiting->stride_bytes);
  frame->bits = waiting->bits;
  frame->flags = waiting->flags;
  frame->t_ns = waiting->t_ns;
  frame->seq = waiting->seq;
  placido_strike_spoil(&state->strike, frame);
  state->last_t_ns = frame->t_ns;
  state->any_given = true;
  state->is_waiting = false;
  state->statistics.frames++;
  state->statistics.corrupt += (frame->flags & PLACIDO_FRAME_CORRUPT) != 0;
  state->statistics.truncated += (frame->flags & PLACIDO_FRAME_TRUNCATED) != 0;
  return PLACIDO_OK;
}

static int replay_next(void *pointer, placido_frame *frame, int timeout_ms, placido_error *err) {
  replay *state = pointer;
  if (state->is_gone) {
    return placido_error_set(err, PLACIDO_GONE, "%s is unplugged, as its script says",
                             placido_text_tail(state->info.uri));
  }
  const int64_t deadline_ns = placido_clock_now_ns() + (int64_t)timeout_ms * 1000000;
  int status = state->is_waiting ? PLACIDO_OK : fetch(state, deadline_ns, err);
  if (!status) {
    status = wait_until_due(state, deadline_ns, err);
  }
  if (status) {
    return status;
  }
  return is_struck_out(&state->strike) ? strike_out(state, err) : give(state, frame, err);
}

static void replay_statistics(const void *pointer, placido_device_statistics *statistics) {
  const replay *state = pointer;
  *statistics = state->statistics;
}

static const char *const options[] = {SCRIPT, NULL};

const placido_driver placido_replay_driver = {
    .scheme = "replay",
    .summary = "a recorded session or an image file",
    .options = options,
    .open = replay_open,
    .close = replay_close,
    .info = replay_info,
    .controls = replay_controls,
    .get = replay_get,
    .set = replay_set,
    .start = replay_start,
    .next = replay_next,
    .statistics = replay_statistics,
};
