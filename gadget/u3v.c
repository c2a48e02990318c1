/* The simulated USB3 Vision camera as a USB function. */
#include "gadget/u3v.h"

#include "base/memory.h"
#include "gadget/u3v_camera.h"

#include <string.h>

#define SIDE_MIN_PX 16
#define SIDE_MAX_PX 16384
#define GREY_LEVELS 65536
#define SERIAL_CHARACTERS_MAX 63

static const uint8_t *descriptor(void *state, uint8_t type, uint8_t index, size_t *size) {
  return placido_u3v_descriptor(state, type, index, size);
}

/* Power goes with the configuration: none begins anew, but for what the user wrote into memory. */
static void configured(void *state, uint8_t interface, uint8_t alternate) {
  placido_u3v_camera *camera = state;
  if (interface != 0xFF) {
    return;
  }
  placido_u3v_sensor_stop(camera);
  placido_u3v_stream_flush(camera);
  camera->answer_count = 0;
  if (alternate == 0) {
    placido_u3v_registers_reset(camera);
    camera->power_up_ns = camera->now_ns;
    camera->reset_ns = 0;
  }
}

static enum placido_gadget_answer out(void *state, uint8_t endpoint, const uint8_t *bytes,
                                      size_t size) {
  if (endpoint != PLACIDO_U3V_GADGET_COMMAND) {
    return PLACIDO_GADGET_STALL;
  }
  placido_u3v_control_take(state, bytes, size);
  return PLACIDO_GADGET_DONE;
}

static enum placido_gadget_answer in(void *state, uint8_t endpoint, uint8_t *bytes, size_t size,
                                     size_t *sent) {
  *sent = 0;
  if (endpoint == PLACIDO_U3V_GADGET_ANSWER) {
    return placido_u3v_control_send(state, bytes, size, sent);
  }
  if (endpoint == PLACIDO_U3V_GADGET_STREAM) {
    return placido_u3v_stream_send(state, bytes, size, sent);
  }
  return PLACIDO_GADGET_STALL;
}

/* What was half sent belongs to nobody any longer. */
static void halted(void *state, uint8_t endpoint, int is_halted) {
  placido_u3v_camera *camera = state;
  (void)is_halted;
  if (endpoint == PLACIDO_U3V_GADGET_STREAM) {
    placido_u3v_stream_flush(camera);
  } else {
    camera->answer_count = 0;
  }
}

static int64_t earliest(int64_t a_ns, int64_t b_ns) {
  return a_ns < b_ns ? a_ns : b_ns;
}

static int64_t tick(void *state, int64_t now_ns) {
  placido_u3v_camera *camera = state;
  camera->power_up_ns = camera->power_up_ns ? camera->power_up_ns : now_ns;
  camera->now_ns = now_ns;
  int64_t due_ns = placido_u3v_sensor_tick(camera);
  if (camera->reset_ns) {
    due_ns = earliest(due_ns, camera->reset_ns);
  }
  /* What is ready is fetched by the host; only what is not yet needs another look at the clock. */
  const int64_t answer_ns = placido_u3v_control_due_ns(camera);
  const int64_t picture_ns = placido_u3v_stream_due_ns(camera);
  due_ns = answer_ns > now_ns ? earliest(due_ns, answer_ns) : due_ns;
  return picture_ns > now_ns ? earliest(due_ns, picture_ns) : due_ns;
}

static int resets(void *state) {
  placido_u3v_camera *camera = state;
  const bool is_due = camera->reset_ns && camera->now_ns >= camera->reset_ns;
  if (is_due) {
    camera->reset_ns = 0;
  }
  return is_due;
}

static const placido_gadget_function function = {
    .name = "u3v",
    .vendor_id = 0x1209,
    .product_id = 0x0001,
    .descriptor = descriptor,
    .configured = configured,
    .out = out,
    .in = in,
    .halted = halted,
    .tick = tick,
    .resets = resets,
};

static int check_options(const placido_gadget_options *options, placido_error *err) {
  const placido_gadget_view *view = &options->view;
  const size_t length = strlen(options->serial);
  if (view->width_px < SIDE_MIN_PX || view->height_px < SIDE_MIN_PX ||
      view->width_px > SIDE_MAX_PX || view->height_px > SIDE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a camera of %d×%d px: its sides range from %d to %d", view->width_px,
                             view->height_px, SIDE_MIN_PX, SIDE_MAX_PX);
  }
  if (!(view->rate_hz >= 0.1 && view->rate_hz <= PLACIDO_U3V_RATE_MAX_HZ)) {
    return placido_error_set(err, PLACIDO_INPUT, "a camera of %g Hz: 0.1 to %g were expected",
                             view->rate_hz, PLACIDO_U3V_RATE_MAX_HZ);
  }
  for (const char *c = options->serial; *c; c++) {
    if (*c < ' ' || *c > '~') {
      return placido_error_set(err, PLACIDO_INPUT,
                               "a serial number has printable ASCII characters only");
    }
  }
  if (length == 0 || length > SERIAL_CHARACTERS_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "a serial number of %zu characters: 1 to %d were "
                             "expected", length, SERIAL_CHARACTERS_MAX);
  }
  return PLACIDO_OK;
}

static void close_camera(void *state) {
  placido_u3v_camera *camera = state;
  if (!camera) {
    return;
  }
  for (size_t i = 0; i < PLACIDO_U3V_GADGET_PICTURES; i++) {
    placido_memory_free(camera->pictures[i].samples);
  }
  for (size_t i = 0; i < PLACIDO_U3V_GADGET_ANSWERS; i++) {
    placido_memory_free(camera->answers[i].bytes);
  }
  placido_memory_free(camera->data);
  placido_memory_free(camera->curve);
  placido_memory_free(camera->description);
  placido_frame_free(&camera->exposed);
  placido_memory_free(camera);
}

/* All the memory that the camera will ever need. */
static int allocate(placido_u3v_camera *camera, placido_error *err) {
  const placido_gadget_view *view = &camera->view;
  const size_t picture_bytes = (size_t)view->width_px * (size_t)view->height_px * 2;
  camera->curve = placido_memory_new(GREY_LEVELS, sizeof *camera->curve, err);
  camera->data = placido_memory_new(PLACIDO_U3V_GADGET_CONTROL_BYTES, 1, err);
  bool is_whole = camera->curve && camera->data;
  for (size_t i = 0; i < PLACIDO_U3V_GADGET_ANSWERS && is_whole; i++) {
    camera->answers[i].bytes = placido_memory_new(PLACIDO_U3V_GADGET_CONTROL_BYTES, 1, err);
    is_whole = camera->answers[i].bytes != NULL;
  }
  for (size_t i = 0; i < PLACIDO_U3V_GADGET_PICTURES && is_whole; i++) {
    camera->pictures[i].samples = placido_memory_new_aligned(picture_bytes, err);
    is_whole = camera->pictures[i].samples != NULL;
  }
  return is_whole ? placido_frame_resize(&camera->exposed, view->width_px, view->height_px,
                                         PLACIDO_MONO16, err)
                  : PLACIDO_MEMORY;
}

static int open_camera(void **state, const placido_gadget_options *options, placido_error *err) {
  *state = NULL;
  int status = check_options(options, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_u3v_camera *camera = placido_memory_new(1, sizeof *camera, err);
  if (!camera) {
    return PLACIDO_MEMORY;
  }
  camera->view = options->view;
  camera->speed = options->speed;
  camera->faults = options->faults ? options->faults : &camera->no_faults;
  status = allocate(camera, err);
  if (status == PLACIDO_OK) {
    status = placido_u3v_description_new(&camera->description, &camera->description_size,
                                         options->zip, err);
  }
  if (status != PLACIDO_OK) {
    close_camera(camera);
    return status;
  }
  placido_u3v_registers_set_up(camera, options->serial, options->zip);
  *state = camera;
  return PLACIDO_OK;
}

static void statistics(const void *state, placido_gadget_statistics *out_statistics) {
  *out_statistics = ((const placido_u3v_camera *)state)->statistics;
}

const placido_gadget_face placido_u3v_face = {
    .name = "u3v",
    .summary = "a USB3 Vision camera",
    .function = &function,
    .open = open_camera,
    .close = close_camera,
    .statistics = statistics,
};
