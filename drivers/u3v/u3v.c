/* Cameras that speak USB3 Vision as a driver: opened, regulated, streamed from, and found again by
 * the next start where they were unplugged. */
#include "drivers/u3v/u3v.h"

#include "base/memory.h"
#include "drivers/settings.h"
#include "drivers/u3v/features.h"
#include "drivers/u3v/stream.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct u3v {
  placido_device_info info;
  char address[256]; /* without the query */
  const placido_u3v_calls *calls;
  placido_u3v_request request; /* what was agreed, once it was */
  placido_u3v_camera camera;
  placido_u3v_mode mode;
  placido_u3v_stream stream;
  placido_u3v_controls controls;
  double wanted[PLACIDO_U3V_CONTROLS_MAX]; /* as set since open; NaN: left alone */
  bool is_lost;
} u3v;

static const char *either(const char *text, const char *otherwise) {
  return text[0] ? text : otherwise;
}

static void describe(u3v *state) {
  placido_device_info *info = &state->info;
  const placido_u3v_bootstrap *said = &state->camera.bootstrap;
  const placido_u3v_found *found = &state->camera.found;
  snprintf(info->vendor, sizeof info->vendor, "%s", either(said->vendor, found->vendor));
  snprintf(info->model, sizeof info->model, "%s", either(said->model, found->model));
  snprintf(info->serial, sizeof info->serial, "%s", either(said->serial, found->serial));
  snprintf(info->firmware, sizeof info->firmware, "%s", either(said->version, found->version));
  snprintf(info->uri, sizeof info->uri, "u3v:%s", either(state->address, found->serial));
  info->axis_z_mm = info->axis_z_sigma_mm = NAN;
  info->endless = true;
}

/* Gives the camera up, so that the kernel can forget the device. */
static void let_go(u3v *state) {
  placido_u3v_stream_stop(&state->stream);
  if (state->stream.is_hung) {
    placido_u3v_camera_abandon(&state->camera);
  } else {
    placido_u3v_camera_close(&state->camera);
  }
  state->is_lost = true;
}

static void u3v_close(void *pointer) {
  u3v *state = pointer;
  let_go(state);
  placido_memory_free(state);
}

/* What is agreed is what a camera that was unplugged will be set to again. */
static void keep_agreed(u3v *state) {
  const placido_u3v_mode *mode = &state->mode;
  state->request.format = mode->format;
  state->request.width_px = mode->width_px;
  state->request.height_px = mode->height_px;
  state->request.offset_x_px = mode->offset_x_px;
  state->request.offset_y_px = mode->offset_y_px;
}

static int set_control(u3v *state, size_t control, double value, placido_error *err) {
  const int status = placido_u3v_control_set(&state->controls, state->camera.features, control,
                                             value, err);
  if (!status && !state->controls.behind[control].is_write_only) {
    state->wanted[control] = value;
  }
  return status;
}

/* The rate of the address, as near as the camera can. */
static int set_rate(u3v *state, placido_notes *notes, placido_error *err) {
  const double asked_hz = state->request.rate_hz;
  const size_t control = placido_u3v_control_find(&state->controls, "frame_rate_hz");
  if (asked_hz <= 0) {
    return PLACIDO_OK;
  }
  if (control == state->controls.count) {
    placido_notes_add(notes, "the camera has no frame rate to set");
    return PLACIDO_OK;
  }
  const placido_control *row = &state->controls.rows[control];
  double got_hz = asked_hz;
  int status = set_control(state, control, fmin(fmax(asked_hz, row->min), row->max), err);
  if (!status) {
    status = placido_u3v_control_get(&state->controls, state->camera.features, control, &got_hz,
                                     err);
  }
  if (!status && fabs(got_hz - asked_hz) > 0.01 * asked_hz) {
    placido_notes_add(notes, "the camera gives %.4g frames/s, not %.4g as asked", got_hz,
                      asked_hz);
  }
  return status;
}

/* From an address to a camera that is ready to start. */
static int open_camera(u3v *state, const char *address, placido_notes *notes,
                       placido_error *err) {
  const char *query;
  placido_u3v_found found;
  int status = placido_settings_split(state->address, sizeof state->address, &query, address,
                                      "camera", err);
  status = status ? status : placido_u3v_request_read(&state->request, query, err);
  status = status ? status
                  : placido_u3v_camera_find(&found, state->calls, state->address, err);
  status = status ? status : placido_u3v_camera_open(&state->camera, &found, state->calls, err);
  if (status) {
    return status;
  }
  placido_genicam *features = state->camera.features;
  status = placido_u3v_mode_set(&state->mode, features, &state->request, notes, err);
  status = status ? status : placido_u3v_controls_list(&state->controls, features, err);
  return status ? status : set_rate(state, notes, err);
}

int placido_u3v_open(void **pointer, const char *address, const placido_u3v_calls *calls,
                     placido_notes *notes, placido_error *err) {
  *pointer = NULL;
  u3v *state = placido_memory_new(1, sizeof *state, err);
  if (!state) {
    return PLACIDO_MEMORY;
  }
  state->calls = calls;
  for (size_t i = 0; i < PLACIDO_U3V_CONTROLS_MAX; i++) {
    state->wanted[i] = NAN;
  }
  int status = open_camera(state, address, notes, err);
  if (status) {
    u3v_close(state);
    if (status == PLACIDO_GONE || status == PLACIDO_TIMEOUT) { /* not there, or dead */
      status = PLACIDO_SYSTEM;
      if (err) {
        err->status = status;
      }
    }
    return status;
  }
  keep_agreed(state);
  describe(state);
  *pointer = state;
  return PLACIDO_OK;
}

static int open_real(void **state, const char *address, placido_notes *notes,
                     placido_error *err) {
  return placido_u3v_open(state, address, placido_u3v_libusb(), notes, err);
}

static const placido_device_info *u3v_info(const void *pointer) {
  const u3v *state = pointer;
  return &state->info;
}

static const placido_control *u3v_controls(const void *pointer, size_t *count) {
  const u3v *state = pointer;
  *count = state->controls.count;
  return state->controls.rows;
}

static int is_lost(const u3v *state, placido_error *err) {
  return placido_error_set(err, PLACIDO_GONE, "the camera %s (%s) was unplugged",
                           state->info.model, state->info.uri);
}

static int u3v_get(void *pointer, size_t control, double *value, placido_error *err) {
  const u3v *state = pointer;
  *value = 0;
  return state->is_lost ? is_lost(state, err)
                        : placido_u3v_control_get(&state->controls, state->camera.features,
                                                  control, value, err);
}

static int u3v_set(void *pointer, size_t control, double value, placido_error *err) {
  u3v *state = pointer;
  return state->is_lost ? is_lost(state, err) : set_control(state, control, value, err);
}

static int u3v_modes(void *pointer, int (*each)(void *user, const placido_device_mode *mode),
                     void *user, placido_error *err) {
  const u3v *state = pointer;
  const size_t rate = placido_u3v_control_find(&state->controls, "frame_rate_hz");
  double rates_hz[2] = {0, 0};
  if (rate < state->controls.count) {
    rates_hz[0] = state->controls.rows[rate].min;
    rates_hz[1] = state->controls.rows[rate].max;
  }
  return state->is_lost
             ? is_lost(state, err)
             : placido_u3v_modes(state->camera.features, rates_hz, each, user, err);
}

/* Another camera may stand where the lost one stood. */
static bool is_same(const u3v *state) {
  const placido_u3v_bootstrap *said = &state->camera.bootstrap;
  const placido_u3v_found *found = &state->camera.found;
  return strcmp(state->info.serial, either(said->serial, found->serial)) == 0 &&
         strcmp(state->info.model, either(said->model, found->model)) == 0;
}

/* Sets every control to what it was. Twice, because the limits of one may depend on another: only
 * the second time a failure counts. */
static int set_controls_again(u3v *state, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; !status && i < 2 * state->controls.count; i++) {
    const size_t control = i % state->controls.count;
    if (!isnan(state->wanted[control])) {
      status = placido_u3v_control_set(&state->controls, state->camera.features, control,
                                       state->wanted[control], err);
      if (i < state->controls.count && status != PLACIDO_GONE) {
        status = PLACIDO_OK;
      }
    }
  }
  return status;
}

/* Sets the mode anew. Whoever takes pictures counts on their size. */
static int set_mode_again(u3v *state, placido_error *err) {
  const placido_u3v_mode before = state->mode;
  placido_u3v_mode *now = &state->mode;
  int status = placido_u3v_mode_set(now, state->camera.features, &state->request, NULL, err);
  if (!status && (now->width_px != before.width_px || now->height_px != before.height_px ||
                  now->format != before.format)) {
    status = placido_error_set(err, PLACIDO_SYSTEM,
                               "the camera %s came back with %d x %d pixels of %s, not %d x %d of "
                               "%s",
                               state->info.model, now->width_px, now->height_px,
                               now->format->name, before.width_px, before.height_px,
                               before.format->name);
  }
  if (status) {
    state->mode = before;
  }
  return status;
}

/* Finds a lost camera again, wherever it is plugged in now, and makes it what it was. */
static int find_again(u3v *state, placido_error *err) {
  const bool by_place = strncmp(state->address, "place=", 6) == 0;
  char address[64];
  snprintf(address, sizeof address, "%s", state->camera.found.serial);
  placido_u3v_found found;
  int status = placido_u3v_camera_find(&found, state->calls,
                                       by_place || !address[0] ? state->address : address, err);
  status = status ? status : placido_u3v_camera_open(&state->camera, &found, state->calls, err);
  if (!status && !is_same(state)) {
    status = placido_error_set(err, PLACIDO_SYSTEM,
                               "%s is the camera %s now, not %s: open it anew", state->info.uri,
                               state->camera.bootstrap.model, state->info.model);
  }
  status = status ? status : set_mode_again(state, err);
  status = status ? status : set_controls_again(state, err);
  state->is_lost = status != PLACIDO_OK;
  if (status) {
    placido_u3v_camera_close(&state->camera);
  }
  return status;
}

static int u3v_start(void *pointer, placido_error *err) {
  u3v *state = pointer;
  int status = state->is_lost ? find_again(state, err) : PLACIDO_OK;
  if (status) {
    return status;
  }
  status = placido_u3v_stream_start(&state->stream, &state->camera, &state->mode,
                                    state->request.buffers, err);
  if (status == PLACIDO_GONE || state->stream.is_hung) {
    let_go(state);
  }
  return status;
}

static int u3v_next(void *pointer, placido_frame *frame, int timeout_ms, placido_error *err) {
  u3v *state = pointer;
  if (state->is_lost) {
    return is_lost(state, err);
  }
  const int status = placido_u3v_stream_next(&state->stream, frame, timeout_ms, err);
  if (status == PLACIDO_GONE || state->stream.is_hung) {
    let_go(state);
  }
  return status;
}

static int u3v_stop(void *pointer, placido_error *err) {
  (void)err;
  u3v *state = pointer;
  placido_u3v_stream_stop(&state->stream);
  if (state->stream.is_hung) {
    let_go(state);
  }
  return PLACIDO_OK;
}

static void u3v_statistics(const void *pointer, placido_device_statistics *statistics) {
  const u3v *state = pointer;
  *statistics = state->stream.statistics;
}

/* Who wants to hear of cameras. */
struct listener {
  int (*found)(void *user, const char *uri, const char *description);
  void *user;
};

static int tell(void *user, const placido_u3v_found *device) {
  const struct listener *listener = user;
  char uri[100], description[300];
  const bool is_by_serial = device->serial[0] && !strpbrk(device->serial, "?&= ");
  snprintf(uri, sizeof uri, "u3v:%s%s", is_by_serial ? "" : "place=",
           is_by_serial ? device->serial : device->place);
  snprintf(description, sizeof description, "%s %s%s%s%s (USB3 Vision, u3v:place=%s, %d Mbit/s)",
           device->vendor, device->model, device->user_name[0] ? " \"" : "", device->user_name,
           device->user_name[0] ? "\"" : "", device->place, device->speed_mbit);
  return listener->found(listener->user, uri, description);
}

int placido_u3v_scan(const placido_u3v_calls *calls,
                     int (*found)(void *user, const char *uri, const char *description),
                     void *user, placido_error *err) {
  struct listener listener = {.found = found, .user = user};
  return calls->each(calls->context, tell, &listener, err);
}

static int scan_real(int (*found)(void *user, const char *uri, const char *description),
                     void *user, placido_error *err) {
  return placido_u3v_scan(placido_u3v_libusb(), found, user, err);
}

static const placido_match matches[] = {
    {.subsystem = "usb",
     .usb_class = 0xEF,
     .usb_subclass = 0x05,
     .link = "camera-$env{ID_SERIAL_SHORT}",
     .group = "plugdev"},
    {.subsystem = NULL},
};

const placido_driver placido_u3v_driver = {
    .scheme = "u3v",
    .summary = "a USB3 Vision camera, by serial number, name or place",
    .options = placido_u3v_options,
    .matches = matches,
    .scan = scan_real,
    .open = open_real,
    .close = u3v_close,
    .info = u3v_info,
    .controls = u3v_controls,
    .get = u3v_get,
    .set = u3v_set,
    .modes = u3v_modes,
    .start = u3v_start,
    .next = u3v_next,
    .stop = u3v_stop,
    .statistics = u3v_statistics,
};
