/* The controls of a camera, as data: each of the kernel's with its name, unit and range. */
#include "drivers/v4l2/control.h"

#include "base/text.h"
#include "drivers/v4l2/rate.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The controls whose unit the kernel defines, or whose name ours differs from. Exposure comes in
 * units of 100 microseconds. `automatic` is the control that regulates it when not at one of
 * `manual` (tried in order). */
static const struct known {
  uint32_t id;
  const char *name, *unit, *help;
  double factor;
  uint32_t automatic;
  int32_t manual[2];
} table[] = {
    {V4L2_CID_EXPOSURE_ABSOLUTE, "exposure_us", "us", "time of exposure", 100,
     V4L2_CID_EXPOSURE_AUTO, {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY}},
    {V4L2_CID_EXPOSURE, "exposure", "", "time of exposure in the camera's own unit", 1,
     V4L2_CID_EXPOSURE_AUTO, {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY}},
    {V4L2_CID_GAIN, "gain", "", "gain in the camera's own unit", 1, V4L2_CID_AUTOGAIN, {0, 0}},
    {V4L2_CID_ANALOGUE_GAIN, "gain_analogue", "", "gain before digitisation", 1,
     V4L2_CID_AUTOGAIN, {0, 0}},
    {V4L2_CID_DIGITAL_GAIN, "gain_digital", "", "gain after digitisation", 1, V4L2_CID_AUTOGAIN,
     {0, 0}},
    {V4L2_CID_BLACK_LEVEL, "black_level", "", "what is added to every sample", 1, 0, {0, 0}},
    {V4L2_CID_FOCUS_ABSOLUTE, "focus", "", "focus in the camera's own unit", 1,
     V4L2_CID_FOCUS_AUTO, {0, 0}},
    {V4L2_CID_WHITE_BALANCE_TEMPERATURE, "white_balance_k", "K", "colour temperature", 1,
     V4L2_CID_AUTO_WHITE_BALANCE, {0, 0}},
    {V4L2_CID_PIXEL_RATE, "pixel_rate_hz", "Hz", "pixels per second", 1, 0, {0, 0}},
};

static const struct known *known_of(uint32_t id) {
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    if (table[i].id == id) {
      return &table[i];
    }
  }
  return NULL;
}

/* "Trigger Mode, External" becomes trigger_mode_external. */
static void make_name(char name[40], const char *said) {
  size_t length = 0;
  for (; *said && length < 34; said++) {
    if (isalnum((unsigned char)*said)) {
      name[length++] = (char)tolower((unsigned char)*said);
    } else if (length > 0 && name[length - 1] != '_') {
      name[length++] = '_';
    }
  }
  while (length > 0 && name[length - 1] == '_') {
    length--;
  }
  name[length] = '\0';
}

static bool is_taken(const placido_v4l2_controls *controls, const char *name) {
  for (size_t i = 0; i < controls->count; i++) {
    if (strcmp(controls->behind[i].name, name) == 0) {
      return true;
    }
  }
  return false;
}

/* Two controls of one name become name and name_2. */
static void make_unique(placido_v4l2_control *control, const placido_v4l2_controls *controls) {
  if (!control->name[0]) {
    snprintf(control->name, sizeof control->name, "control");
  }
  const size_t length = strlen(control->name);
  for (int i = 2; is_taken(controls, control->name); i++) {
    snprintf(control->name + length, sizeof control->name - length, "_%d", i);
  }
}

/* What the numbers of a menu mean: "0 Auto Mode, 1 Manual Mode". */
static void describe_menu(placido_v4l2_control *control, const placido_v4l2_camera *camera,
                          const struct v4l2_query_ext_ctrl *said) {
  size_t length = 0;
  const int64_t first = said->minimum > 0 && said->minimum < 1000 ? said->minimum : 0;
  for (int64_t i = first; i <= said->maximum && i < first + 32; i++) {
    struct v4l2_querymenu item = {.id = said->id, .index = (uint32_t)i};
    if (placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_QUERYMENU, &item)) {
      continue;
    }
    char text[40];
    memcpy(text, item.name, sizeof item.name);
    text[sizeof item.name] = '\0';
    if (said->type == V4L2_CTRL_TYPE_INTEGER_MENU) {
      snprintf(text, sizeof text, "%lld", (long long)item.value);
    }
    length += (size_t)snprintf(control->help + length, sizeof control->help - length, "%s%d %s",
                               length ? ", " : "", (int)i, text);
    if (length >= sizeof control->help) {
      break;
    }
  }
  placido_text_line(control->help);
}

static bool is_number(uint32_t type) {
  return type == V4L2_CTRL_TYPE_INTEGER || type == V4L2_CTRL_TYPE_BOOLEAN ||
         type == V4L2_CTRL_TYPE_MENU || type == V4L2_CTRL_TYPE_BUTTON ||
         type == V4L2_CTRL_TYPE_INTEGER64 || type == V4L2_CTRL_TYPE_BITMASK ||
         type == V4L2_CTRL_TYPE_INTEGER_MENU;
}

static void add(placido_v4l2_controls *controls, const placido_v4l2_control *control,
                const char *unit, double min, double max, double step) {
  placido_v4l2_control *behind = &controls->behind[controls->count];
  *behind = *control;
  controls->rows[controls->count++] = (placido_control){.name = behind->name,
                                                        .unit = unit,
                                                        .help = behind->help,
                                                        .min = min,
                                                        .max = max,
                                                        .step = step};
}

static void add_control(placido_v4l2_controls *controls, const placido_v4l2_camera *camera,
                        const struct v4l2_query_ext_ctrl *said) {
  const struct known *known = known_of(said->id);
  placido_v4l2_control control = {
      .id = said->id,
      .type = said->type,
      .factor = known ? known->factor : 1,
      .is_read_only = said->flags & V4L2_CTRL_FLAG_READ_ONLY,
      .is_write_only = said->type == V4L2_CTRL_TYPE_BUTTON ||
                       (said->flags & V4L2_CTRL_FLAG_WRITE_ONLY)};
  char name[sizeof said->name + 1];
  memcpy(name, said->name, sizeof said->name);
  name[sizeof said->name] = '\0';
  if (known) {
    snprintf(control.name, sizeof control.name, "%s", known->name);
    snprintf(control.help, sizeof control.help, "%s", known->help);
  } else {
    make_name(control.name, name);
    snprintf(control.help, sizeof control.help, "%s", name);
    placido_text_line(control.help);
  }
  if (said->type == V4L2_CTRL_TYPE_MENU || said->type == V4L2_CTRL_TYPE_INTEGER_MENU) {
    describe_menu(&control, camera, said);
  }
  make_unique(&control, controls);
  double min = (double)said->minimum, max = (double)said->maximum;
  if (said->type == V4L2_CTRL_TYPE_BITMASK) {
    min = 0; /* the kernel gives the mask of legal bits as an unsigned maximum */
    max = (double)(uint32_t)said->maximum;
  }
  if (said->type == V4L2_CTRL_TYPE_BUTTON) {
    min = 0;
    max = 1;
  }
  const double step = said->step > 0 ? (double)said->step : 1;
  add(controls, &control, known ? known->unit : "", min * control.factor,
      (max < min ? min : max) * control.factor, step * control.factor);
}

void placido_v4l2_controls_list(placido_v4l2_controls *controls,
                                const placido_v4l2_camera *camera, const double rates_hz[2]) {
  controls->count = 0;
  if (rates_hz[0] > 0 && rates_hz[1] >= rates_hz[0]) {
    const placido_v4l2_control rate = {
        .name = "frame_rate_hz", .help = "frames per second; while stopped", .factor = 1};
    add(controls, &rate, "Hz", rates_hz[0], rates_hz[1], 0.001);
  }
  uint32_t last = 0;
  /* More questions than rows, because some controls are passed over; ids must grow, or a driver
   * could answer for ever. */
  for (int i = 0; i < 4 * PLACIDO_V4L2_CONTROLS_MAX; i++) {
    struct v4l2_query_ext_ctrl said = {.id = last | V4L2_CTRL_FLAG_NEXT_CTRL};
    if (placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_QUERY_EXT_CTRL, &said) ||
        said.id <= last || controls->count >= PLACIDO_V4L2_CONTROLS_MAX) {
      return;
    }
    last = said.id;
    if (is_number(said.type) && !(said.flags & V4L2_CTRL_FLAG_DISABLED)) {
      add_control(controls, camera, &said);
    }
  }
}

/* Gets or sets one control by the extended interface. Returns 0 or errno. */
static int transfer(const placido_v4l2_camera *camera, unsigned long request, uint32_t id,
                    uint32_t type, int64_t *value) {
  struct v4l2_ext_control one = {.id = id};
  const bool is_wide = type == V4L2_CTRL_TYPE_INTEGER64;
  if (is_wide) {
    one.value64 = *value;
  } else {
    one.value = (int32_t)(uint32_t)*value;
  }
  struct v4l2_ext_controls all = {
      .which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};
  const int code = placido_v4l2_ioctl(camera->calls, camera->fd, request, &all);
  *value = is_wide ? one.value64 : one.value;
  return code;
}

static int failed(const placido_v4l2_camera *camera, const placido_v4l2_control *control,
                  const char *verb, int code, placido_error *err) {
  if (code == EBUSY) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "%s of the camera %s cannot be changed while pictures flow",
                             control->name, camera->card);
  }
  char action[80];
  snprintf(action, sizeof action, "%s %s of", verb, control->name);
  return placido_v4l2_camera_failed(camera, action, code, err);
}

int placido_v4l2_control_get(const placido_v4l2_controls *controls,
                             const placido_v4l2_camera *camera, size_t control, double *value,
                             placido_error *err) {
  const placido_v4l2_control *behind = &controls->behind[control];
  *value = 0;
  if (behind->id == 0) {
    *value = placido_v4l2_rate(camera);
    return isnan(*value) ? failed(camera, behind, "reading", EIO, err) : PLACIDO_OK;
  }
  if (behind->is_write_only) {
    return PLACIDO_OK;
  }
  int64_t raw = 0;
  const int code = transfer(camera, VIDIOC_G_EXT_CTRLS, behind->id, behind->type, &raw);
  if (code) {
    return failed(camera, behind, "reading", code, err);
  }
  *value = behind->type == V4L2_CTRL_TYPE_BITMASK ? (double)(uint32_t)raw
                                                  : (double)raw * behind->factor;
  return PLACIDO_OK;
}

/* Switches the camera's own regulation off, where it has one that is on. */
static void take_over(const placido_v4l2_camera *camera, const struct known *known) {
  int64_t now = 0;
  if (!known || !known->automatic ||
      transfer(camera, VIDIOC_G_EXT_CTRLS, known->automatic, V4L2_CTRL_TYPE_INTEGER, &now) ||
      now == known->manual[0] || now == known->manual[1]) {
    return;
  }
  for (size_t i = 0; i < 2; i++) {
    int64_t manual = known->manual[i];
    if (transfer(camera, VIDIOC_S_EXT_CTRLS, known->automatic, V4L2_CTRL_TYPE_INTEGER,
                 &manual) == 0) {
      return;
    }
  }
}

/* The nearest whole number; 2^63 and beyond do not fit. */
static int64_t whole(double value) {
  const double limit = 9.2e18;
  return llround(value < -limit ? -limit : value > limit ? limit : value);
}

int placido_v4l2_control_set(const placido_v4l2_controls *controls,
                             const placido_v4l2_camera *camera, size_t control, double value,
                             placido_error *err) {
  const placido_v4l2_control *behind = &controls->behind[control];
  if (behind->is_read_only) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "%s of the camera %s can only be read",
                             behind->name, camera->card);
  }
  int code;
  if (behind->id == 0) {
    code = placido_v4l2_rate_set(camera, value);
  } else {
    int64_t raw = whole(value / behind->factor);
    take_over(camera, known_of(behind->id));
    code = transfer(camera, VIDIOC_S_EXT_CTRLS, behind->id, behind->type, &raw);
  }
  return code ? failed(camera, behind, "setting", code, err) : PLACIDO_OK;
}
