/* The features of the simulated USB3 Vision camera: the registers behind camera.xml, what may be
 * written there and when, and what a write does. */
#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "gadget/u3v_camera.h"

#include <math.h>
#include <string.h>

#define WIDTH_MIN_PX 16u
#define WIDTH_STEP_PX 4u /* whole bytes a row in every format */
#define HEIGHT_MIN_PX 2u
#define HEIGHT_STEP_PX 2u
#define TIME_BASE_NS 250u
#define EXPOSURE_MIN 40u /* 10 µs */
#define EXPOSURE_MAX 4000000u /* 1 s */
#define GAIN_MAX_DB 24.0
#define BLACK_MAX 63u
#define RATE_MIN_HZ 0.1
#define NOMINAL_EXPOSURE_US 5000.0
#define TEMPERATURE_C 41.5

static uint8_t *feature_at(placido_u3v_camera *camera, enum placido_u3v_feature_register at) {
  return camera->features + at;
}

uint32_t placido_u3v_feature(const placido_u3v_camera *camera,
                             enum placido_u3v_feature_register at) {
  return placido_read_u32(camera->features + at);
}

static void set_feature(placido_u3v_camera *camera, enum placido_u3v_feature_register at,
                        uint32_t value) {
  placido_write_u32(feature_at(camera, at), value);
}

static double read_double(const uint8_t *bytes) {
  const uint64_t bits = placido_read_u64(bytes);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static void write_double(uint8_t *bytes, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  placido_write_u64(bytes, bits);
}

static double to_float(uint32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

double placido_u3v_gain_db(const placido_u3v_camera *camera) {
  return to_float(placido_u3v_feature(camera, PLACIDO_U3V_GAIN));
}

double placido_u3v_exposure_us(const placido_u3v_camera *camera) {
  return placido_u3v_feature(camera, PLACIDO_U3V_EXPOSURE) * (TIME_BASE_NS / 1000.0);
}

static double rate_limit_hz(const placido_u3v_camera *camera) {
  return fmin(PLACIDO_U3V_RATE_MAX_HZ,
              1e6 / (placido_u3v_exposure_us(camera) + PLACIDO_U3V_READOUT_US));
}

double placido_u3v_rate_hz(const placido_u3v_camera *camera) {
  const double limit_hz = rate_limit_hz(camera);
  return placido_u3v_feature(camera, PLACIDO_U3V_FRAME_RATE_ENABLE)
             ? fmin(camera->rate_hz, limit_hz)
             : limit_hz;
}

const placido_pixel_format *placido_u3v_format(const placido_u3v_camera *camera) {
  return placido_pixel_by_code(placido_u3v_feature(camera, PLACIDO_U3V_PIXEL_FORMAT));
}

size_t placido_u3v_payload_bytes(const placido_u3v_camera *camera) {
  const int width_px = (int)placido_u3v_feature(camera, PLACIDO_U3V_WIDTH);
  return placido_pixel_row_bytes(placido_u3v_format(camera), width_px) *
         placido_u3v_feature(camera, PLACIDO_U3V_HEIGHT);
}

/* Whether what makes up the picture's size must stay. */
static bool is_locked(const placido_u3v_camera *camera) {
  return camera->is_acquiring || placido_u3v_feature(camera, PLACIDO_U3V_TL_PARAMS_LOCKED) != 0;
}

/* Everything that follows from other registers or from the time. */
void placido_u3v_features_refresh(placido_u3v_camera *camera) {
  set_feature(camera, PLACIDO_U3V_PAYLOAD_SIZE, (uint32_t)placido_u3v_payload_bytes(camera));
  set_feature(camera, PLACIDO_U3V_ACQUISITION_STATUS, camera->is_acquiring);
  write_double(feature_at(camera, PLACIDO_U3V_FRAME_RATE), placido_u3v_rate_hz(camera));
  /* Warms up by a degree or so, in the minutes after power-up. */
  const double minutes = (double)(camera->now_ns - camera->power_up_ns) / 60e9;
  const double celsius = TEMPERATURE_C - 1.5 * exp(-minutes / 5.0);
  set_feature(camera, PLACIDO_U3V_TEMPERATURE, (uint32_t)lround(celsius * 16.0) & 0xFFFu);
}

/* Largest values as they are now, each a whole number of steps. */
static uint32_t room_x_px(const placido_u3v_camera *camera,
                          enum placido_u3v_feature_register taken) {
  return placido_u3v_feature(camera, PLACIDO_U3V_WIDTH_MAX) - placido_u3v_feature(camera, taken);
}

static uint32_t room_y_px(const placido_u3v_camera *camera,
                          enum placido_u3v_feature_register taken) {
  return placido_u3v_feature(camera, PLACIDO_U3V_HEIGHT_MAX) - placido_u3v_feature(camera, taken);
}

static bool is_within(uint32_t value, uint32_t min, uint32_t max, uint32_t step) {
  return value >= min && value <= max && value % step == 0;
}

static bool check_width(const placido_u3v_camera *camera, uint32_t value) {
  return is_within(value, WIDTH_MIN_PX, room_x_px(camera, PLACIDO_U3V_OFFSET_X), WIDTH_STEP_PX);
}

static bool check_height(const placido_u3v_camera *camera, uint32_t value) {
  return is_within(value, HEIGHT_MIN_PX, room_y_px(camera, PLACIDO_U3V_OFFSET_Y), HEIGHT_STEP_PX);
}

static bool check_offset_x(const placido_u3v_camera *camera, uint32_t value) {
  return is_within(value, 0, room_x_px(camera, PLACIDO_U3V_WIDTH), WIDTH_STEP_PX);
}

static bool check_offset_y(const placido_u3v_camera *camera, uint32_t value) {
  return is_within(value, 0, room_y_px(camera, PLACIDO_U3V_HEIGHT), HEIGHT_STEP_PX);
}

static bool check_format(const placido_u3v_camera *camera, uint32_t value) {
  static const char *const names[] = {"Mono8",   "Mono10",  "Mono12",
                                      "Mono10p", "Mono12p", "Mono12Packed"};
  (void)camera;
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    const placido_pixel_format *format = placido_pixel_by_name(names[i]);
    if (format && format->code == value) {
      return true;
    }
  }
  return false;
}

static bool check_switch(const placido_u3v_camera *camera, uint32_t value) {
  (void)camera;
  return value <= 1;
}

static bool check_exposure(const placido_u3v_camera *camera, uint32_t value) {
  (void)camera;
  return is_within(value, EXPOSURE_MIN, EXPOSURE_MAX, 1);
}

static bool check_gain(const placido_u3v_camera *camera, uint32_t value) {
  (void)camera;
  return to_float(value) >= 0.0 && to_float(value) <= GAIN_MAX_DB;
}

static bool check_black(const placido_u3v_camera *camera, uint32_t value) {
  (void)camera;
  return value <= BLACK_MAX;
}

static bool check_trigger(const placido_u3v_camera *camera, uint32_t value) {
  (void)camera;
  return value <= 7;
}

static void start(placido_u3v_camera *camera) {
  placido_u3v_sensor_start(camera);
}

static void stop(placido_u3v_camera *camera) {
  placido_u3v_sensor_stop(camera);
}

/* The answer still gets out before the plug is pulled. */
static void reset(placido_u3v_camera *camera) {
  camera->reset_ns = camera->now_ns + 50000000;
}

/* A feature's register that can be written. */
typedef struct feature_row {
  enum placido_u3v_feature_register at;
  bool is_locked; /* while pictures are taken */
  bool (*check)(const placido_u3v_camera *camera, uint32_t value);
  void (*run)(placido_u3v_camera *camera); /* a command: done where 1 is written, and not kept */
} feature_row;

static const feature_row features[] = {
    {PLACIDO_U3V_WIDTH, true, check_width, NULL},
    {PLACIDO_U3V_HEIGHT, true, check_height, NULL},
    {PLACIDO_U3V_OFFSET_X, false, check_offset_x, NULL},
    {PLACIDO_U3V_OFFSET_Y, false, check_offset_y, NULL},
    {PLACIDO_U3V_PIXEL_FORMAT, true, check_format, NULL},
    {PLACIDO_U3V_ACQUISITION_MODE, true, check_switch, NULL},
    {PLACIDO_U3V_ACQUISITION_START, false, check_switch, start},
    {PLACIDO_U3V_ACQUISITION_STOP, false, check_switch, stop},
    {PLACIDO_U3V_EXPOSURE, false, check_exposure, NULL},
    {PLACIDO_U3V_GAIN, false, check_gain, NULL},
    {PLACIDO_U3V_BLACK_LEVEL, false, check_black, NULL},
    {PLACIDO_U3V_FRAME_RATE_ENABLE, false, check_switch, NULL},
    {PLACIDO_U3V_TRIGGER, false, check_trigger, NULL},
    {PLACIDO_U3V_TRIGGER_SOFTWARE, false, check_switch, placido_u3v_sensor_trigger},
    {PLACIDO_U3V_TL_PARAMS_LOCKED, false, check_switch, NULL},
    {PLACIDO_U3V_RESET, false, check_switch, reset},
};

static uint16_t write_rate(placido_u3v_camera *camera, const uint8_t *bytes, size_t size) {
  if (size != 8) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  const double rate_hz = read_double(bytes);
  /* A rate that was read may be written again, whatever became of its last digit. */
  if (!(rate_hz >= RATE_MIN_HZ && rate_hz <= rate_limit_hz(camera) * (1.0 + 1e-9))) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  camera->rate_hz = rate_hz;
  return PLACIDO_GENCP_SUCCESS;
}

uint16_t placido_u3v_features_write(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                                    size_t size) {
  if (at == PLACIDO_U3V_FRAME_RATE) {
    return write_rate(camera, bytes, size);
  }
  for (size_t i = 0; i < sizeof features / sizeof features[0]; i++) {
    const feature_row *row = &features[i];
    if ((size_t)row->at != at) {
      continue;
    }
    if (row->is_locked && is_locked(camera)) {
      return PLACIDO_GENCP_ACCESS_DENIED;
    }
    if (size != 4 || !row->check(camera, placido_read_u32(bytes))) {
      return PLACIDO_GENCP_INVALID_PARAMETER;
    }
    if (!row->run) {
      set_feature(camera, row->at, placido_read_u32(bytes));
    } else if (placido_read_u32(bytes) == 1) {
      row->run(camera);
    }
    return PLACIDO_GENCP_SUCCESS;
  }
  return PLACIDO_GENCP_WRITE_PROTECT;
}

void placido_u3v_features_reset(placido_u3v_camera *camera) {
  const uint32_t width_px = (uint32_t)camera->view.width_px / WIDTH_STEP_PX * WIDTH_STEP_PX;
  const uint32_t height_px = (uint32_t)camera->view.height_px / HEIGHT_STEP_PX * HEIGHT_STEP_PX;
  const double exposure_us = fmin(NOMINAL_EXPOSURE_US, 0.5e6 / camera->view.rate_hz);
  memset(camera->features, 0, sizeof camera->features);
  set_feature(camera, PLACIDO_U3V_WIDTH_MAX, width_px);
  set_feature(camera, PLACIDO_U3V_HEIGHT_MAX, height_px);
  set_feature(camera, PLACIDO_U3V_WIDTH, width_px);
  set_feature(camera, PLACIDO_U3V_HEIGHT, height_px);
  set_feature(camera, PLACIDO_U3V_PIXEL_FORMAT, placido_pixel_by_name("Mono8")->code);
  set_feature(camera, PLACIDO_U3V_TIME_BASE, TIME_BASE_NS);
  set_feature(camera, PLACIDO_U3V_EXPOSURE, (uint32_t)lround(exposure_us * 1000.0 / TIME_BASE_NS));
  set_feature(camera, PLACIDO_U3V_FRAME_RATE_ENABLE, 1);
  camera->rate_hz = camera->view.rate_hz;
  camera->nominal_exposure_us = placido_u3v_exposure_us(camera);
}
