/* Cameras of the kernel (Video for Linux) as a driver: opened, regulated, streamed from, and found
 * again by the next start where they were unplugged. */
#include "drivers/v4l2/v4l2.h"

#include "base/memory.h"
#include "drivers/settings.h"
#include "drivers/v4l2/control.h"
#include "drivers/v4l2/rate.h"
#include "drivers/v4l2/stream.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct v4l2 {
  placido_device_info info;
  char address[1024]; /* without the query */
  const placido_v4l2_calls *calls;
  placido_v4l2_request request;
  placido_v4l2_camera camera, known; /* as it is; as it was opened */
  bool has_twin;                     /* one with the same serial number */
  placido_v4l2_mode mode;
  placido_v4l2_stream stream;
  placido_v4l2_controls controls;
  double wanted[PLACIDO_V4L2_CONTROLS_MAX]; /* as set since open; NaN: left alone */
  bool is_lost;
} v4l2;

static void describe(v4l2 *state) {
  placido_device_info *info = &state->info;
  snprintf(info->uri, sizeof info->uri, "v4l2:%.1000s", state->address);
  snprintf(info->vendor, sizeof info->vendor, "%s", state->camera.vendor);
  snprintf(info->model, sizeof info->model, "%s", state->camera.card);
  snprintf(info->serial, sizeof info->serial, "%s", state->camera.serial);
  snprintf(info->firmware, sizeof info->firmware, "%s", state->camera.firmware);
  info->axis_z_mm = info->axis_z_sigma_mm = NAN;
  info->endless = true;
}

static void v4l2_close(void *pointer) {
  v4l2 *state = pointer;
  placido_v4l2_stream_stop(&state->stream);
  placido_v4l2_camera_close(&state->camera);
  placido_memory_free(state);
}

int placido_v4l2_open(void **pointer, const char *address, const placido_v4l2_calls *calls,
                      placido_notes *notes, placido_error *err) {
  *pointer = NULL;
  v4l2 *state = placido_memory_new(1, sizeof *state, err);
  if (!state) {
    return PLACIDO_MEMORY;
  }
  state->calls = calls;
  state->camera.fd = -1;
  const char *query;
  int status = placido_settings_split(state->address, sizeof state->address, &query, address,
                                      "camera", err);
  if (!status) {
    status = placido_v4l2_request_read(&state->request, query, err);
  }
  if (!status) {
    status = placido_v4l2_camera_open(&state->camera, state->address, calls, err);
  }
  if (!status) {
    state->known = state->camera;
    state->has_twin = placido_v4l2_camera_has_twin(&state->camera);
    status = placido_v4l2_mode_set(&state->mode, &state->camera, &state->request, notes, err);
  }
  if (status) {
    v4l2_close(state);
    return status;
  }
  double rates_hz[2];
  placido_v4l2_rate_range(rates_hz, &state->camera, &state->mode);
  placido_v4l2_controls_list(&state->controls, &state->camera, rates_hz);
  for (size_t i = 0; i < PLACIDO_V4L2_CONTROLS_MAX; i++) {
    state->wanted[i] = NAN;
  }
  describe(state);
  *pointer = state;
  return PLACIDO_OK;
}

static int open_real(void **state, const char *address, placido_notes *notes,
                     placido_error *err) {
  return placido_v4l2_open(state, address, &placido_v4l2_kernel, notes, err);
}

static const placido_device_info *v4l2_info(const void *pointer) {
  const v4l2 *state = pointer;
  return &state->info;
}

static const placido_control *v4l2_controls(const void *pointer, size_t *count) {
  const v4l2 *state = pointer;
  *count = state->controls.count;
  return state->controls.rows;
}

static int v4l2_get(void *pointer, size_t control, double *value, placido_error *err) {
  const v4l2 *state = pointer;
  return placido_v4l2_control_get(&state->controls, &state->camera, control, value, err);
}

static int v4l2_set(void *pointer, size_t control, double value, placido_error *err) {
  v4l2 *state = pointer;
  const int status =
      placido_v4l2_control_set(&state->controls, &state->camera, control, value, err);
  if (!status && !state->controls.behind[control].is_write_only) {
    state->wanted[control] = value;
  }
  return status;
}

/* Gives up a camera that does not answer, so that the kernel can forget its node. */
static void let_go(v4l2 *state) {
  placido_v4l2_stream_stop(&state->stream);
  placido_v4l2_camera_close(&state->camera);
  state->is_lost = true;
}

/* Sets the mode anew. Whoever takes pictures counts on their size: a camera that came back on a
 * slower bus may not have it any longer. */
static int set_mode_again(v4l2 *state, placido_error *err) {
  const placido_v4l2_mode before = state->mode;
  placido_v4l2_mode *now = &state->mode;
  int status = placido_v4l2_mode_set(now, &state->camera, &state->request, NULL, err);
  if (!status && (now->width_px != before.width_px || now->height_px != before.height_px ||
                  now->format != before.format)) {
    status = placido_error_set(err, PLACIDO_SYSTEM,
                               "the camera %s came back with %d x %d pixels of %s, not %d x %d of "
                               "%s",
                               state->camera.card, now->width_px, now->height_px,
                               now->format->name, before.width_px, before.height_px,
                               before.format->name);
  }
  if (status) {
    state->mode = before;
  }
  return status;
}

/* Finds a lost camera again and makes it what it was. */
static int find_again(v4l2 *state, placido_error *err) {
  int status = placido_v4l2_camera_find(&state->camera, &state->known, state->address,
                                        state->has_twin, err);
  if (status) {
    return status;
  }
  status = set_mode_again(state, err);
  for (size_t i = 0; !status && i < state->controls.count; i++) {
    if (!isnan(state->wanted[i])) {
      status = placido_v4l2_control_set(&state->controls, &state->camera, i, state->wanted[i],
                                        err);
    }
  }
  state->is_lost = status != PLACIDO_OK;
  if (status) {
    placido_v4l2_camera_close(&state->camera);
  }
  return status;
}

static int v4l2_start(void *pointer, placido_error *err) {
  v4l2 *state = pointer;
  int status = state->is_lost ? find_again(state, err) : PLACIDO_OK;
  if (status) {
    return status;
  }
  status = placido_v4l2_stream_start(&state->stream, &state->camera, &state->mode,
                                     state->request.buffers, err);
  if (status == PLACIDO_GONE) {
    let_go(state);
  }
  return status;
}

static int v4l2_next(void *pointer, placido_frame *frame, int timeout_ms, placido_error *err) {
  v4l2 *state = pointer;
  if (state->is_lost) {
    return placido_v4l2_camera_failed(&state->camera, "waiting for", 0, err);
  }
  const int status = placido_v4l2_stream_next(&state->stream, frame, timeout_ms, err);
  if (status == PLACIDO_GONE) {
    let_go(state);
  }
  return status;
}

static int v4l2_stop(void *pointer, placido_error *err) {
  (void)err;
  v4l2 *state = pointer;
  placido_v4l2_stream_stop(&state->stream);
  return PLACIDO_OK;
}

static void v4l2_statistics(const void *pointer, placido_device_statistics *statistics) {
  const v4l2 *state = pointer;
  *statistics = state->stream.statistics;
}

int placido_v4l2_export(const void *pointer, int buffer, int *descriptor, placido_error *err) {
  const v4l2 *state = pointer;
  return placido_v4l2_stream_export(&state->stream, buffer, descriptor, err);
}

/* Who wants to hear of cameras. */
struct listener {
  int (*found)(void *user, const char *uri, const char *description);
  void *user;
};

static int tell(void *user, placido_v4l2_camera *camera) {
  const struct listener *listener = user;
  char uri[1100], description[300];
  snprintf(uri, sizeof uri, "v4l2:%s", camera->path + strlen(camera->calls->root));
  snprintf(description, sizeof description, "%s (%s%s%sv4l2:bus=%s)", camera->card,
           camera->serial[0] ? "v4l2:serial=" : "", camera->serial,
           camera->serial[0] ? ", " : "", camera->bus);
  return listener->found(listener->user, uri, description);
}

int placido_v4l2_scan(const placido_v4l2_calls *calls,
                      int (*found)(void *user, const char *uri, const char *description),
                      void *user, placido_error *err) {
  struct listener listener = {.found = found, .user = user};
  return placido_v4l2_camera_each(calls, tell, &listener, err);
}

static int scan_real(int (*found)(void *user, const char *uri, const char *description),
                     void *user, placido_error *err) {
  return placido_v4l2_scan(&placido_v4l2_kernel, found, user, err);
}

/* Who wants to hear of modes. */
struct chooser {
  int (*each)(void *user, const placido_device_mode *mode);
  void *user;
};

static int tell_mode(void *user, const placido_v4l2_offer *offer) {
  const struct chooser *chooser = user;
  placido_device_mode mode = {
      .is_readable = offer->format && placido_v4l2_is_readable(offer->format),
      .width_min_px = offer->width_min_px,
      .width_max_px = offer->width_max_px,
      .width_step_px = offer->width_step_px,
      .height_min_px = offer->height_min_px,
      .height_max_px = offer->height_max_px,
      .height_step_px = offer->height_step_px,
      .rate_count = offer->rate_count,
      .any_rate = offer->any_rate};
  snprintf(mode.format, sizeof mode.format, "%s", offer->name);
  memcpy(mode.rates_hz, offer->rates_hz, sizeof mode.rates_hz);
  return chooser->each(chooser->user, &mode);
}

static int v4l2_modes(void *pointer, int (*each)(void *user, const placido_device_mode *mode),
                      void *user, placido_error *err) {
  const v4l2 *state = pointer;
  struct chooser chooser = {.each = each, .user = user};
  return placido_v4l2_camera_is_there(&state->camera)
             ? placido_v4l2_offers(&state->camera, tell_mode, &chooser)
             : placido_v4l2_camera_failed(&state->camera, "asking", 0, err);
}

static const placido_match matches[] = {
    {.subsystem = "video4linux",
     .usb_class = -1,
     .usb_subclass = -1,
     .only = "ENV{ID_V4L_CAPABILITIES}==\"*:capture:*\"",
     .link = "video-$env{ID_SERIAL_SHORT}-$attr{index}",
     .group = "video"},
    {.subsystem = NULL},
};

const placido_driver placido_v4l2_driver = {
    .scheme = "v4l2",
    .summary = "a camera of the kernel (Video for Linux), by node, serial number or bus",
    .options = placido_v4l2_options,
    .scan = scan_real,
    .open = open_real,
    .close = v4l2_close,
    .info = v4l2_info,
    .controls = v4l2_controls,
    .get = v4l2_get,
    .set = v4l2_set,
    .modes = v4l2_modes,
    .matches = matches,
    .start = v4l2_start,
    .next = v4l2_next,
    .stop = v4l2_stop,
    .statistics = v4l2_statistics,
};
