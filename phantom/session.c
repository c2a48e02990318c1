/* A whole examination of an eye that is never quite still: it drifts and trembles, comes in and out
 * of focus, jerks once and blinks once, so that choosing the best frame matters. */
#include "base/file.h"
#include "base/random.h"
#include "phantom/shot.h"
#include "phantom/streams.h"

#include <math.h>
#include <placido/session.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static const double turn = 6.283185307179586;
/* Standard deviation of a distance meter, as the session states it. */
static const double axis_z_sigma_mm = 0.02;

/* What becomes of one frame. */
typedef struct moment {
  double shift_mm[3];
  double blur_px; /* beyond the session's own */
  double motion_px, motion_deg;
  double lid_mm;
} moment;

/* What is recorded, and how. */
typedef struct take {
  placido_phantom_shot shot;
  placido_disturbance still; /* as the caller asked */
  double lid_mm;
  int frame_count;
  double rate_hz;
} take;

static double draw(const take *t, int frame, int which, double low, double high) {
  return placido_random_uniform(t->still.seed, PLACIDO_PHANTOM_MOVEMENT,
                                 (uint64_t)frame * 16 + (uint64_t)which, low, high);
}

/* Slow drift (about a hertz) and tremor along one axis, of at most reach_mm. The first frame is
 * where the eye rests. */
static double wander(const take *t, int frame, int axis, double reach_mm) {
  double seconds = frame / t->rate_hz;
  double phase[2] = {draw(t, 0, axis, 0, turn), draw(t, 0, axis + 3, 0, turn)};
  double slow = sin(turn * 0.9 * seconds + phase[0]) - sin(phase[0]);
  double slower = sin(turn * 0.37 * seconds + phase[1]) - sin(phase[1]);
  double tremor = frame == 0 ? 0 : draw(t, frame, axis, -1, 1);
  return reach_mm * (0.25 * slow + 0.15 * slower + 0.2 * tremor);
}

/* The frames in which something happens: out of focus at a quarter, lid half closed in the middle,
 * a jerk of the eye at three quarters. Everything else is sharp to a third of a pixel. */
static moment moment_of(const take *t, int frame) {
  int n = t->frame_count, quarter = n / 4, middle = n / 2, late = 3 * n / 4;
  moment now = {
      .shift_mm = {wander(t, frame, 0, 0.05), wander(t, frame, 1, 0.05),
                   wander(t, frame, 2, 0.012)},
      .blur_px = n > 1 ? draw(t, frame, 8, 0, 0.3) : 0,
      .lid_mm = t->lid_mm,
  };
  if (n > 1 && frame == quarter) {
    now.blur_px = 3;
    now.shift_mm[2] = frame == 0 ? 0 : 0.03;
  } else if (n > 2 && frame == middle) {
    now.lid_mm = fmin(now.lid_mm, 0.4);
  } else if (n > 11 && (frame == middle - 1 || frame == middle + 1)) {
    now.lid_mm = fmin(now.lid_mm, 2);
  } else if (n > 4 && frame == late) {
    now.motion_px = 5;
    now.motion_deg = draw(t, frame, 9, 0, 180);
  }
  return now;
}

/* Independent blurs add in variance; of two motions the longer one is taken. */
static void set_shot(take *t, int frame) {
  moment now = moment_of(t, frame);
  placido_disturbance *d = &t->shot.disturbance;
  *d = t->still;
  for (int i = 0; i < 3; i++) {
    d->shift_mm[i] += now.shift_mm[i];
  }
  d->blur_px = hypot(d->blur_px, now.blur_px);
  if (now.motion_px > d->motion_px) {
    d->motion_px = now.motion_px;
    d->motion_deg = now.motion_deg;
  }
  t->shot.lid_mm = now.lid_mm;
  t->shot.number = (uint64_t)frame;
}

static int append_frames(placido_session_writer *writer, take *t, placido_error *err) {
  placido_frame frame = {0};
  int status = PLACIDO_OK;
  for (int i = 0; i < t->frame_count && status == PLACIDO_OK; i++) {
    set_shot(t, i);
    status = placido_phantom_shot_take(&frame, &t->shot, err);
    if (status == PLACIDO_OK) {
      placido_frame_info info = {
          .index = i,
          .t_ns = 1000000000 + llround(i * 1e9 / t->rate_hz),
          .seq = (uint64_t)i,
          .exposure_us = fmin(4000, 5e5 / t->rate_hz),
          .gain_db = 0,
      };
      frame.t_ns = info.t_ns;
      frame.seq = info.seq;
      status = placido_session_writer_append(writer, &frame, &info, err);
    }
  }
  placido_frame_free(&frame);
  return status;
}

static void stamp(char *created, size_t size) {
  time_t now = time(NULL);
  struct tm utc;
  created[0] = '\0';
  if (now != (time_t)-1 && gmtime_r(&now, &utc)) {
    strftime(created, size, "%Y-%m-%dT%H:%M:%SZ", &utc);
  }
}

static placido_session_info info_of(const take *t, const char *eye) {
  const double *shift = t->still.shift_mm;
  placido_jet jet;
  placido_session_info info = {
      .driver = "phantom",
      .vendor = "Placido",
      .model = "phantom",
      .format = t->still.bits == 8 ? PLACIDO_MONO8 : PLACIDO_MONO16,
      .bits = t->still.bits,
      .rate_hz = t->rate_hz,
      .axis_z_mm = NAN,
      .axis_z_sigma_mm = NAN,
      .software = "placido " PLACIDO_VERSION,
  };
  snprintf(info.eye, sizeof info.eye, "%s", eye);
  stamp(info.created, sizeof info.created);
  if (placido_surface_at(t->shot.surface, -shift[0], -shift[1], &jet)) {
    info.axis_z_mm = placido_surface_vertex_z_mm(t->shot.surface) - jet.sag + shift[2];
    info.axis_z_sigma_mm = axis_z_sigma_mm;
  }
  return info;
}

/* Writes the session at `path`, which does not exist yet, with the truth beside the frames. */
static int record(const char *path, take *t, const char *eye, const char *instrument_path,
                  placido_error *err) {
  char truth[PLACIDO_PATH_MAX];
  placido_session_writer *writer = NULL;
  placido_session_info info = info_of(t, eye);
  int status = placido_session_writer_create(&writer, path, &info, instrument_path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = placido_session_writer_event(writer, 1000000000, "illumination", "on", err);
  if (status == PLACIDO_OK) {
    status = append_frames(writer, t, err);
  }
  int closed = placido_session_writer_close(writer, status == PLACIDO_OK ? err : NULL);
  status = status == PLACIDO_OK ? closed : status;
  if (status == PLACIDO_OK) {
    status = placido_path_join(truth, path, "truth-surface.json", err);
  }
  return status == PLACIDO_OK ? placido_surface_save(t->shot.surface, truth, err) : status;
}

/* Writes everything into a directory of another name, and renames what is whole. */
static int record_whole(const char *path, take *t, const char *eye, placido_error *err) {
  char instrument[PLACIDO_PATH_MAX], session[PLACIDO_PATH_MAX];
  placido_directory workshop, place;
  int status = placido_directory_create(&workshop, path, NULL, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = placido_path_join(instrument, workshop.temporary, "instrument.json", err);
  if (status == PLACIDO_OK) {
    status = placido_path_join(session, workshop.temporary, "session", err);
  }
  if (status == PLACIDO_OK) {
    status = placido_instrument_save(t->shot.instrument, instrument, err);
  }
  if (status == PLACIDO_OK) {
    status = record(session, t, eye, instrument, err);
  }
  if (status == PLACIDO_OK) {
    place = workshop;
    memcpy(place.temporary, session, sizeof session);
    status = placido_directory_commit(&place, err);
  }
  placido_directory_discard(&workshop);
  return status;
}

int placido_phantom_session(const char *path, const placido_surface *surface,
                            const placido_instrument *instrument, const char *eye, int frame_count,
                            double rate_hz, const placido_disturbance *disturbance, int threads,
                            placido_error *err) {
  take t = {.frame_count = frame_count, .rate_hz = rate_hz};
  int status =
      placido_phantom_shot_prepare(&t.shot, surface, instrument, disturbance, threads, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (!path || !eye || (strcmp(eye, "OD") != 0 && strcmp(eye, "OS") != 0)) {
    return placido_error_set(err, PLACIDO_INPUT, "phantom: eye is \"%s\", expected OD or OS",
                             eye ? eye : "");
  }
  if (frame_count < 1 || frame_count > 100000 || !(rate_hz >= 0.1 && rate_hz <= 1e4)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "phantom: %d frames at %g Hz, expected 1 to 100000 at 0.1 to 10000",
                             frame_count, rate_hz);
  }
  t.still = t.shot.disturbance;
  t.lid_mm = t.shot.lid_mm;
  return record_whole(path, &t, eye, err);
}
