/* The pictures that a simulated camera shows, made before it is plugged in: nothing is rendered
 * while a host waits. */
#include "acquire/cli/sim_view.h"

#include "acquire/cli/subject.h"
#include "base/memory.h"

#include <math.h>
#include <placido/phantom.h>
#include <string.h>

#define DEFAULT_EYE "normal"
#define DEFAULT_INSTRUMENT "cone24"
#define DEFAULT_RATE_HZ 30.0
#define STEP_NS INT64_C(40000000)          /* of the eye's movement */
#define BLINK_EVERY_NS INT64_C(4000000000)
#define BLINKING 3                         /* pictures of a blink: closing, closed, opening */
#define BLINK_STEP_NS INT64_C(70000000)
#define NOISE 1.5                          /* grey levels */
#define LID_LEVEL 92                       /* skin, as bright as mires light it */
#define MEMORY_BYTES_MAX (1u << 30)        /* for a session's pictures */

static int refuse_both(placido_error *err) {
  return placido_error_set(err, STATUS_USAGE,
                           "a session was given, so --eye and --instrument are too much");
}

/* The eye's way, a closed curve: the pictures can be shown again and again without a jump. */
static placido_disturbance disturb(const struct settings *settings, int step, int steps) {
  const double turn = 2 * 3.14159265358979323846 * step / steps;
  placido_disturbance disturbance = {
      .seed = settings->disturbance.seed + (uint64_t)step,
      .noise = settings->disturbance.noise > 0 ? settings->disturbance.noise : NOISE,
      .bits = settings->disturbance.bits,
      .shift_mm = {0.05 * sin(turn), 0.03 * sin(2 * turn), 0.01 * cos(turn)},
      .blur_px = 0.3 + 0.2 * sin(3 * turn),
  };
  return disturbance;
}

/* A closed lid: skin with a little structure, everywhere. */
static void close_lid(placido_frame *frame) {
  for (int y = 0; y < frame->height_px; y++) {
    uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    for (int x = 0; x < frame->width_px; x++) {
      const uint32_t grain = ((uint32_t)x * 2654435761u ^ (uint32_t)y * 2246822519u) >> 29;
      const uint16_t level = (uint16_t)((LID_LEVEL + grain) << (frame->bits - 8));
      if (frame->format == PLACIDO_MONO8) {
        row[x] = (uint8_t)level;
      } else {
        ((uint16_t *)(void *)row)[x] = level;
      }
    }
  }
}

static int render_eye(struct sim_view *view, const placido_surface *surface,
                      const placido_instrument *instrument, const struct settings *settings,
                      struct outcome *outcome, placido_error *err) {
  const int threads = settings_use_threads(settings);
  int status = PLACIDO_OK;
  for (size_t i = 0; i < view->count && status == PLACIDO_OK; i++) {
    stages_next(&outcome->stages, "rendering picture %zu of %zu", i + 1, view->count);
    placido_disturbance disturbance = disturb(settings, (int)i, (int)view->awake);
    disturbance.lid = i >= view->awake;
    status = placido_phantom_render(&view->frames[i], surface, instrument, &disturbance, threads,
                                    err);
  }
  if (status == PLACIDO_OK) {
    close_lid(&view->frames[view->awake + 1]);
  }
  return status;
}

static const placido_frame *look_at_eye(void *user, int64_t t_ns) {
  struct sim_view *view = user;
  if (view->started_ns == 0) {
    view->started_ns = t_ns;
  }
  const int64_t since_ns = t_ns > view->started_ns ? t_ns - view->started_ns : 0;
  const int64_t blink = (since_ns % BLINK_EVERY_NS - BLINK_EVERY_NS / 2) / BLINK_STEP_NS;
  if (since_ns % BLINK_EVERY_NS >= BLINK_EVERY_NS / 2 && blink < (int64_t)view->blinking) {
    return &view->frames[view->awake + (size_t)blink];
  }
  return &view->frames[(uint64_t)(since_ns / STEP_NS) % view->awake];
}

static int open_eye(struct sim_view *view, const struct settings *settings,
                    struct outcome *outcome, placido_error *err) {
  placido_surface *surface = NULL;
  placido_instrument instrument;
  view->awake = (size_t)settings->pictures;
  view->blinking = BLINKING;
  view->frames = placido_memory_new(view->awake + view->blinking, sizeof *view->frames, err);
  if (!view->frames) {
    return PLACIDO_MEMORY;
  }
  view->count = view->awake + view->blinking;
  int status = subject_eye(&surface, settings->eye ? settings->eye : DEFAULT_EYE,
                           &outcome->notes, err);
  if (status == PLACIDO_OK) {
    status = subject_instrument(
        &instrument, settings->instrument ? settings->instrument : DEFAULT_INSTRUMENT,
        &outcome->notes, err);
  }
  if (status == PLACIDO_OK) {
    status = render_eye(view, surface, &instrument, settings, outcome, err);
  }
  placido_surface_free(surface);
  view->view.look = look_at_eye;
  view->view.rate_hz = DEFAULT_RATE_HZ;
  return status;
}

/* The next picture that can be decoded; from the beginning again where there is none. */
static int read_on(struct sim_view *view, placido_frame *frame, placido_error *err) {
  int status = placido_session_reader_next(view->reader, frame, err);
  for (int i = 0; i < 2 && status == PLACIDO_END; i++) {
    status = placido_session_reader_rewind(view->reader, err);
    if (status == PLACIDO_OK) {
      status = placido_session_reader_next(view->reader, frame, err);
    }
  }
  return status;
}

/* All pictures at once where they fit; else the last one only, decoded when it is looked at. */
static const placido_frame *look_at_session(void *user, int64_t t_ns) {
  struct sim_view *view = user;
  if (view->started_ns == 0) {
    view->started_ns = t_ns;
  }
  const int64_t since_ns = t_ns > view->started_ns ? t_ns - view->started_ns : 0;
  const int64_t number = since_ns / view->period_ns;
  if (!view->reader) {
    return &view->frames[(uint64_t)number % view->count];
  }
  if (number > view->shown) {
    view->shown = number;
    (void)read_on(view, &view->current, NULL); /* a damaged one leaves the one before in place */
  }
  return view->current.data ? &view->current : NULL;
}

static size_t frame_bytes(const placido_frame *frame) {
  return (size_t)frame->height_px * frame->stride_bytes;
}

/* Decodes into memory until the end, or until there is no room for more. */
static int decode_all(struct sim_view *view, struct outcome *outcome, bool *is_whole,
                      placido_error *err) {
  placido_frame frame = {0};
  size_t bytes = 0;
  int status = PLACIDO_OK;
  *is_whole = false;
  while (status == PLACIDO_OK && bytes <= MEMORY_BYTES_MAX) {
    if (view->count % 10 == 0) {
      stages_next(&outcome->stages, "decoding picture %zu", view->count + 1);
    }
    status = placido_session_reader_next(view->reader, &frame, err);
    if (status == PLACIDO_INPUT) {
      status = PLACIDO_OK; /* a damaged one is passed over */
      continue;
    }
    placido_frame *grown = status == PLACIDO_OK
                               ? placido_memory_grow(view->frames, view->count + 1, sizeof frame,
                                                     err)
                               : NULL;
    if (grown) {
      view->frames = grown;
      view->frames[view->count++] = frame;
      bytes += frame_bytes(&frame);
      frame = (placido_frame){0};
    } else if (status == PLACIDO_OK) {
      status = PLACIDO_MEMORY;
    }
  }
  placido_frame_free(&frame);
  *is_whole = status == PLACIDO_END;
  return status == PLACIDO_END ? PLACIDO_OK : status;
}

static void drop_frames(struct sim_view *view) {
  for (size_t i = 0; i < view->count; i++) {
    placido_frame_free(&view->frames[i]);
  }
  placido_memory_free(view->frames);
  view->frames = NULL;
  view->count = 0;
}

static int open_session(struct sim_view *view, const struct settings *settings,
                        struct outcome *outcome, placido_error *err) {
  bool is_whole;
  int status =
      placido_session_reader_open(&view->reader, settings->input, &outcome->notes, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const double rate_hz = placido_session_reader_info(view->reader)->rate_hz;
  view->view.rate_hz = rate_hz > 0 ? rate_hz : DEFAULT_RATE_HZ;
  view->period_ns = llround(1e9 / view->view.rate_hz);
  view->view.look = look_at_session;
  status = decode_all(view, outcome, &is_whole, err);
  if (status == PLACIDO_OK && view->count == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: no picture of it can be decoded",
                             settings->input);
  }
  if (status == PLACIDO_OK && is_whole) {
    placido_session_reader_close(view->reader);
    view->reader = NULL;
  } else if (status == PLACIDO_OK) {
    view->current = view->frames[0]; /* to have one before the first is decoded again */
    view->frames[0] = (placido_frame){0};
    drop_frames(view);
    status = placido_session_reader_rewind(view->reader, err);
  }
  return status;
}

int sim_view_open(struct sim_view *view, const struct settings *settings, struct outcome *outcome,
                  placido_error *err) {
  if (settings->input && (settings->eye || settings->instrument)) {
    return refuse_both(err);
  }
  const int status = settings->input ? open_session(view, settings, outcome, err)
                                     : open_eye(view, settings, outcome, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const placido_frame *first = view->reader ? &view->current : &view->frames[0];
  view->view.user = view;
  view->view.width_px = first->width_px;
  view->view.height_px = first->height_px;
  if (settings->rate_hz > 0) {
    view->view.rate_hz = settings->rate_hz;
  }
  return PLACIDO_OK;
}

void sim_view_close(struct sim_view *view) {
  drop_frames(view);
  placido_frame_free(&view->current);
  placido_session_reader_close(view->reader);
  *view = (struct sim_view){0};
}
