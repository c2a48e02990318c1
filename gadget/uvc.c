/* The simulated UVC camera as a USB function: when pictures are taken, what is seen in them, and
 * what goes wrong with them. */
#include "gadget/uvc.h"

#include "base/memory.h"
#include "gadget/uvc_controls.h"
#include "gadget/uvc_image.h"
#include "gadget/uvc_payload.h"

#include <string.h>

#define RATE_MIN_HZ 0.1
#define RATE_MAX_HZ 1000
#define SERIAL_MAX 63
#define ALL_INTERFACES 0xff
#define DATA_DISCONTINUITY 3 /* among the stream's errors (section 4.3.1.7) */

struct camera {
  placido_gadget_view view;
  placido_gadget_faults *faults;
  placido_uvc_modes modes;
  placido_uvc_descriptors descriptors;
  placido_uvc_controls controls;
  placido_uvc_stream stream;
  placido_gadget_statistics statistics;
  int64_t now_ns;
  bool is_on;     /* the host asked for pictures */
  int64_t due_ns; /* when the next is taken */
  placido_gadget_setup asked; /* the request that waits, where everything is slow */
  int64_t answer_ns;          /* until then; 0: none waits */
  uint8_t *image;             /* room for the largest picture */
};

static const uint8_t *get_descriptor(void *state, uint8_t type, uint8_t index, size_t *size) {
  const struct camera *camera = state;
  return placido_uvc_descriptor_get(&camera->descriptors, type, index, size);
}

static int64_t slow_ns(const struct camera *camera) {
  return camera->faults->slow_ms * INT64_C(1000000);
}

static int64_t interval_ns(const struct camera *camera) {
  return camera->controls.committed.interval * INT64_C(100);
}

static void start(struct camera *camera) {
  placido_uvc_stream_abandon(&camera->stream);
  camera->is_on = true;
  camera->due_ns = camera->now_ns;
}

static void configured(void *state, uint8_t interface, uint8_t alternate) {
  struct camera *camera = state;
  if (interface != PLACIDO_UVC_CONTROL_INTERFACE) {
    placido_uvc_stream_abandon(&camera->stream);
    camera->is_on = false;
  }
  if (interface == ALL_INTERFACES && alternate == 0) { /* as after power-up */
    placido_uvc_controls_make(&camera->controls, &camera->modes);
    camera->answer_ns = 0;
  }
}

/* A stream goes on with a whole picture. */
static void halted(void *state, uint8_t endpoint, int is_halted) {
  struct camera *camera = state;
  if (endpoint == PLACIDO_UVC_STREAM_ENDPOINT && !is_halted) {
    placido_uvc_stream_abandon(&camera->stream);
    camera->due_ns = camera->due_ns > camera->now_ns ? camera->due_ns : camera->now_ns;
  }
}

static bool is_waiting_for(const struct camera *camera, const placido_gadget_setup *setup) {
  const placido_gadget_setup *asked = &camera->asked;
  return camera->answer_ns && asked->request_type == setup->request_type &&
         asked->request == setup->request && asked->value == setup->value &&
         asked->index == setup->index && asked->length == setup->length;
}

static enum placido_gadget_answer control(void *state, const placido_gadget_setup *setup,
                                          uint8_t *data, size_t *size) {
  struct camera *camera = state;
  if (camera->faults->slow_ms > 0 && !is_waiting_for(camera, setup)) {
    camera->asked = *setup;
    camera->answer_ns = camera->now_ns + slow_ns(camera);
  }
  if (camera->now_ns < camera->answer_ns) {
    return PLACIDO_GADGET_LATER;
  }
  camera->answer_ns = 0;
  camera->statistics.commands++;
  const enum placido_gadget_answer answer =
      placido_uvc_control(&camera->controls, setup, data, size);
  if (camera->controls.is_commit_new) {
    camera->controls.is_commit_new = false;
    start(camera);
  }
  return answer;
}

/* The first fault of a picture that is still to come. */
static enum placido_gadget_fault take_fault(placido_gadget_faults *faults) {
  static const enum placido_gadget_fault of_pictures[] = {
      PLACIDO_GADGET_FAULT_STALL,     PLACIDO_GADGET_FAULT_DROP,
      PLACIDO_GADGET_FAULT_CORRUPT,   PLACIDO_GADGET_FAULT_TRUNCATE,
      PLACIDO_GADGET_FAULT_MISNUMBER, PLACIDO_GADGET_FAULT_LOST_START,
      PLACIDO_GADGET_FAULT_LOST_END};
  for (size_t i = 0; i < sizeof of_pictures / sizeof of_pictures[0]; i++) {
    if (faults->left[of_pictures[i]] > 0) {
      faults->left[of_pictures[i]]--;
      return of_pictures[i];
    }
  }
  return PLACIDO_UVC_NO_FAULT;
}

/* The view at t_ns as the mode and the controls want it; false where there is none. */
static bool expose(struct camera *camera, int64_t t_ns) {
  const placido_gadget_view *view = &camera->view;
  const placido_frame *seen = view->look(view->user, t_ns);
  if (!seen || seen->width_px != view->width_px || seen->height_px != view->height_px ||
      seen->format == PLACIDO_RGB8) {
    return false;
  }
  const placido_uvc_choice *mode = &camera->controls.committed;
  const int32_t *values = camera->controls.values;
  const bool is_plain = values[PLACIDO_UVC_EXPOSURE] == PLACIDO_UVC_EXPOSURE_USUAL &&
                        values[PLACIDO_UVC_GAIN] == 16 && values[PLACIDO_UVC_BRIGHTNESS] == 0;
  uint8_t levels[256];
  placido_uvc_levels_make(levels, values[PLACIDO_UVC_EXPOSURE], values[PLACIDO_UVC_GAIN],
                          values[PLACIDO_UVC_BRIGHTNESS]);
  placido_uvc_image_make(camera->image, seen, &camera->modes.sizes[mode->size], mode->format,
                         is_plain ? NULL : levels);
  return true;
}

/* Takes the picture that was due last; earlier ones the host did not fetch in time. */
static void begin_picture(struct camera *camera) {
  const placido_uvc_choice *mode = &camera->controls.committed;
  const int64_t missed = (camera->now_ns - slow_ns(camera) - camera->due_ns) / interval_ns(camera);
  const int64_t taken_ns = camera->due_ns + missed * interval_ns(camera);
  camera->due_ns = taken_ns + interval_ns(camera);
  camera->statistics.dropped += (uint64_t)missed;
  if (!expose(camera, taken_ns)) {
    return;
  }
  const enum placido_gadget_fault fault = take_fault(camera->faults);
  if (fault == PLACIDO_GADGET_FAULT_DROP) {
    camera->statistics.dropped++;
  } else {
    camera->statistics.pictures++;
  }
  if (fault == PLACIDO_GADGET_FAULT_CORRUPT) {
    camera->controls.stream_error = DATA_DISCONTINUITY;
  }
  placido_uvc_stream_begin(
      &camera->stream, camera->image,
      placido_uvc_picture_bytes(&camera->modes, mode->format, mode->size), taken_ns, fault);
}

static enum placido_gadget_answer in(void *state, uint8_t endpoint, uint8_t *bytes, size_t size,
                                     size_t *sent) {
  struct camera *camera = state;
  *sent = 0;
  if (endpoint != PLACIDO_UVC_STREAM_ENDPOINT) {
    return PLACIDO_GADGET_STALL;
  }
  if (camera->is_on && !camera->stream.has_picture && !camera->stream.owes_end &&
      camera->now_ns >= camera->due_ns + slow_ns(camera)) {
    begin_picture(camera);
  }
  return placido_uvc_stream_take(&camera->stream, camera->now_ns, bytes, size, sent);
}

/* Wants to be called when an answer or a picture is due; where the host leaves pictures lie, once
 * a picture. */
static int64_t tick(void *state, int64_t now_ns) {
  struct camera *camera = state;
  int64_t next_ns = camera->answer_ns > now_ns ? camera->answer_ns : INT64_MAX;
  camera->now_ns = now_ns;
  if (camera->is_on) {
    int64_t due_ns = camera->due_ns + slow_ns(camera);
    if (due_ns <= now_ns) {
      due_ns = now_ns + interval_ns(camera);
    }
    next_ns = due_ns < next_ns ? due_ns : next_ns;
  }
  return next_ns;
}

static int check(const placido_gadget_options *options, placido_error *err) {
  const placido_gadget_view *view = &options->view;
  if (view->width_px < PLACIDO_UVC_SIDE_MIN_PX || view->width_px > PLACIDO_UVC_SIDE_MAX_PX ||
      view->height_px < PLACIDO_UVC_SIDE_MIN_PX || view->height_px > PLACIDO_UVC_SIDE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a UVC camera of %d x %d pixels cannot be simulated: %d to %d a side",
                             view->width_px, view->height_px, PLACIDO_UVC_SIDE_MIN_PX,
                             PLACIDO_UVC_SIDE_MAX_PX);
  }
  if (!(view->rate_hz >= RATE_MIN_HZ && view->rate_hz <= RATE_MAX_HZ)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a UVC camera of %g Hz cannot be simulated: %g to %d Hz",
                             view->rate_hz, RATE_MIN_HZ, RATE_MAX_HZ);
  }
  const size_t length = strlen(options->serial);
  if (length < 1 || length > SERIAL_MAX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a serial number has 1 to %d characters, not %zu", SERIAL_MAX, length);
  }
  return PLACIDO_OK;
}

static void close_camera(void *state) {
  struct camera *camera = state;
  if (camera) {
    placido_memory_free(camera->image);
    placido_memory_free(camera);
  }
}

static int open_camera(void **state, const placido_gadget_options *options, placido_error *err) {
  *state = NULL;
  int status = check(options, err);
  if (status) {
    return status;
  }
  struct camera *camera = placido_memory_new(1, sizeof *camera, err);
  if (!camera) {
    return PLACIDO_MEMORY;
  }
  camera->view = options->view;
  camera->faults = options->faults;
  placido_uvc_modes_make(&camera->modes, options->view.width_px, options->view.height_px,
                         options->view.rate_hz, options->speed);
  placido_uvc_descriptors_make(&camera->descriptors, &camera->modes, options->speed,
                               options->serial);
  placido_uvc_controls_make(&camera->controls, &camera->modes);
  camera->stream.payload_bytes = camera->modes.payload_bytes;
  const size_t pixels = (size_t)options->view.width_px * (size_t)options->view.height_px;
  camera->image = placido_memory_new(pixels, 2, err);
  if (!camera->image) {
    close_camera(camera);
    return PLACIDO_MEMORY;
  }
  *state = camera;
  return PLACIDO_OK;
}

static void get_statistics(const void *state, placido_gadget_statistics *statistics) {
  const struct camera *camera = state;
  *statistics = camera->statistics;
}

static const placido_gadget_function function = {
    .name = "uvc",
    .vendor_id = PLACIDO_UVC_VENDOR_ID,
    .product_id = PLACIDO_UVC_PRODUCT_ID,
    .descriptor = get_descriptor,
    .control = control,
    .configured = configured,
    .in = in,
    .halted = halted,
    .tick = tick,
};

const placido_gadget_face placido_uvc_face = {
    .name = "uvc",
    .summary = "a USB Video Class camera: /dev/videoN",
    .function = &function,
    .open = open_camera,
    .close = close_camera,
    .statistics = get_statistics,
};
