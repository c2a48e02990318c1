/* The registers of the simulated USB3 Vision camera: what lies at which address, what may be
 * written there and when, and what a write does. */
#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "gadget/u3v_camera.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define GENCP_VERSION 0x00010000u
#define U3V_VERSION 0x00010002u
/* There are: a user-defined name, a timestamp, a family name, the SBRM, the endianness registers,
 * and a count in the answer to a write. */
#define DEVICE_CAPABILITY 0xF09u
#define SI_NOT_ALIGNED 0xA003u
#define SI_INCONSISTENT 0xA004u
#define ALIGNMENT_LOG2 2u
#define RESPONSE_MS 200u
#define SPEED_HIGH 4u /* of the register "current speed" */
#define SPEED_SUPER 8u
#define NAME_BYTES 64

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

bool placido_u3v_is_streaming(const placido_u3v_camera *camera) {
  return (placido_read_u32(camera->sirm + PLACIDO_SIRM_CONTROL) & PLACIDO_SIRM_CONTROL_ENABLE) != 0;
}

/* Whether what makes up the picture's size must stay. */
static bool is_locked(const placido_u3v_camera *camera) {
  return camera->is_acquiring || placido_u3v_feature(camera, PLACIDO_U3V_TL_PARAMS_LOCKED) != 0;
}

/* Everything that follows from other registers or from the time. */
static void refresh(placido_u3v_camera *camera) {
  const size_t payload = placido_u3v_payload_bytes(camera);
  placido_write_u64(camera->sirm + PLACIDO_SIRM_REQUIRED_PAYLOAD, payload);
  set_feature(camera, PLACIDO_U3V_PAYLOAD_SIZE, (uint32_t)payload);
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

static uint16_t write_feature(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
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

/* Whether the transfers that the host has set up carry a picture. */
static uint16_t check_transfers(const placido_u3v_camera *camera) {
  const uint8_t *sirm = camera->sirm;
  const uint64_t size = placido_read_u32(sirm + PLACIDO_SIRM_PAYLOAD_SIZE);
  const uint64_t count = placido_read_u32(sirm + PLACIDO_SIRM_PAYLOAD_COUNT);
  const uint64_t final1 = placido_read_u32(sirm + PLACIDO_SIRM_FINAL1);
  const uint64_t final2 = placido_read_u32(sirm + PLACIDO_SIRM_FINAL2);
  const uint64_t leader = placido_read_u32(sirm + PLACIDO_SIRM_MAX_LEADER);
  const uint64_t trailer = placido_read_u32(sirm + PLACIDO_SIRM_MAX_TRAILER);
  const uint64_t mask = (1u << ALIGNMENT_LOG2) - 1;
  if (((size | final1 | final2 | leader | trailer) & mask) != 0) {
    return SI_NOT_ALIGNED;
  }
  return size * count + final1 + final2 < placido_u3v_payload_bytes(camera) ||
                 leader < PLACIDO_U3V_LEADER_BYTES || trailer < PLACIDO_U3V_TRAILER_BYTES
             ? SI_INCONSISTENT
             : PLACIDO_GENCP_SUCCESS;
}

static uint16_t write_stream(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                             size_t size) {
  static const uint8_t writable[] = {PLACIDO_SIRM_MAX_LEADER, PLACIDO_SIRM_PAYLOAD_SIZE,
                                     PLACIDO_SIRM_PAYLOAD_COUNT, PLACIDO_SIRM_FINAL1,
                                     PLACIDO_SIRM_FINAL2, PLACIDO_SIRM_MAX_TRAILER};
  if (at == PLACIDO_SIRM_CONTROL && size == 4) {
    const bool is_on = (placido_read_u32(bytes) & PLACIDO_SIRM_CONTROL_ENABLE) != 0;
    const uint16_t status = is_on ? check_transfers(camera) : PLACIDO_GENCP_SUCCESS;
    if (status == PLACIDO_GENCP_SUCCESS) {
      placido_u3v_stream_flush(camera);
      placido_write_u32(camera->sirm + at, is_on);
    }
    return status;
  }
  if (at >= PLACIDO_SIRM_BYTES || !memchr(writable, (int)at, sizeof writable)) {
    return PLACIDO_GENCP_WRITE_PROTECT;
  }
  if (size != 4) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  if (placido_u3v_is_streaming(camera)) {
    return PLACIDO_GENCP_ACCESS_DENIED;
  }
  memcpy(camera->sirm + at, bytes, size);
  return PLACIDO_GENCP_SUCCESS;
}

static uint16_t write_technology(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                                 size_t size) {
  if (at != PLACIDO_SBRM_CONFIGURATION || size != 8) {
    return PLACIDO_GENCP_WRITE_PROTECT;
  }
  memcpy(camera->sbrm + at, bytes, size);
  return PLACIDO_GENCP_SUCCESS;
}

static uint16_t write_bootstrap(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                                size_t size) {
  const bool is_name = at >= PLACIDO_ABRM_USER_NAME && at + size <= PLACIDO_ABRM_USER_NAME + NAME_BYTES;
  const bool is_configuration = at == PLACIDO_ABRM_CONFIGURATION && size == 8;
  if (at == PLACIDO_ABRM_TIMESTAMP_LATCH && size == 4) {
    placido_write_u64(camera->abrm + PLACIDO_ABRM_TIMESTAMP,
                      (uint64_t)(camera->now_ns - camera->power_up_ns));
    return PLACIDO_GENCP_SUCCESS;
  }
  if (!is_name && !is_configuration) {
    return PLACIDO_GENCP_WRITE_PROTECT;
  }
  memcpy(camera->abrm + at, bytes, size);
  return PLACIDO_GENCP_SUCCESS;
}

/* Where `size` bytes lie within a region; NULL: nowhere. */
static const placido_u3v_region *find_region(const placido_u3v_camera *camera, uint64_t address,
                                             size_t size) {
  for (size_t i = 0; i < PLACIDO_U3V_GADGET_REGIONS; i++) {
    const placido_u3v_region *region = &camera->regions[i];
    if (address >= region->address && address - region->address < region->size &&
        size <= region->size - (address - region->address)) {
      return region;
    }
  }
  return NULL;
}

uint16_t placido_u3v_registers_read(placido_u3v_camera *camera, uint64_t address, uint8_t *bytes,
                                    size_t size) {
  const placido_u3v_region *region = find_region(camera, address, size);
  if (size == 0) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  if (!region) {
    return PLACIDO_GENCP_INVALID_ADDRESS;
  }
  refresh(camera);
  memcpy(bytes, region->bytes + (address - region->address), size);
  return PLACIDO_GENCP_SUCCESS;
}

uint16_t placido_u3v_registers_write(placido_u3v_camera *camera, uint64_t address,
                                     const uint8_t *bytes, size_t size) {
  static const struct {
    uint64_t address;
    uint16_t (*write)(placido_u3v_camera *camera, size_t at, const uint8_t *bytes, size_t size);
  } writers[] = {{0, write_bootstrap},
                 {PLACIDO_U3V_GADGET_SBRM, write_technology},
                 {PLACIDO_U3V_GADGET_SIRM, write_stream},
                 {PLACIDO_U3V_GADGET_FEATURES, write_feature}};
  const placido_u3v_region *region = find_region(camera, address, size);
  if (size == 0) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  if (!region) {
    return PLACIDO_GENCP_INVALID_ADDRESS;
  }
  for (size_t i = 0; i < sizeof writers / sizeof writers[0]; i++) {
    if (writers[i].address == region->address) {
      return writers[i].write(camera, (size_t)(address - region->address), bytes, size);
    }
  }
  return PLACIDO_GENCP_WRITE_PROTECT;
}

static void put_text(uint8_t *bytes, const char *text) {
  snprintf((char *)bytes, NAME_BYTES, "%s", text);
}

static void set_up_bootstrap(placido_u3v_camera *camera, const char *serial) {
  uint8_t *abrm = camera->abrm;
  placido_write_u32(abrm + PLACIDO_ABRM_GENCP_VERSION, GENCP_VERSION);
  put_text(abrm + PLACIDO_ABRM_MANUFACTURER, "Placido");
  put_text(abrm + PLACIDO_ABRM_MODEL, "Simulated topographer");
  put_text(abrm + PLACIDO_ABRM_FAMILY, "device-sim");
  put_text(abrm + PLACIDO_ABRM_DEVICE_VERSION, PLACIDO_VERSION);
  put_text(abrm + PLACIDO_ABRM_MANUFACTURER_INFO, "not a medical device");
  put_text(abrm + PLACIDO_ABRM_SERIAL, serial);
  placido_write_u64(abrm + PLACIDO_ABRM_CAPABILITY, DEVICE_CAPABILITY);
  placido_write_u32(abrm + PLACIDO_ABRM_MAX_RESPONSE_MS, RESPONSE_MS);
  placido_write_u64(abrm + PLACIDO_ABRM_MANIFEST_ADDRESS, PLACIDO_U3V_GADGET_MANIFEST);
  placido_write_u64(abrm + PLACIDO_ABRM_SBRM_ADDRESS, PLACIDO_U3V_GADGET_SBRM);
  placido_write_u64(abrm + PLACIDO_ABRM_TIMESTAMP_INCREMENT, 1);
  placido_write_u32(abrm + PLACIDO_ABRM_PROTOCOL_ENDIANNESS, 0xFFFFFFFFu); /* little */
  placido_write_u32(abrm + PLACIDO_ABRM_IMPLEMENTATION_ENDIANNESS, 0xFFFFFFFFu);
}

static void set_up_technology(placido_u3v_camera *camera) {
  uint8_t *sbrm = camera->sbrm;
  placido_write_u32(sbrm + PLACIDO_SBRM_U3V_VERSION, U3V_VERSION);
  placido_write_u64(sbrm + PLACIDO_SBRM_CAPABILITY, 1);
  placido_write_u32(sbrm + PLACIDO_SBRM_MAX_COMMAND, PLACIDO_U3V_GADGET_CONTROL_BYTES);
  placido_write_u32(sbrm + PLACIDO_SBRM_MAX_ACK, PLACIDO_U3V_GADGET_CONTROL_BYTES);
  placido_write_u32(sbrm + PLACIDO_SBRM_STREAM_CHANNELS, 1);
  placido_write_u64(sbrm + PLACIDO_SBRM_SIRM_ADDRESS, PLACIDO_U3V_GADGET_SIRM);
  placido_write_u32(sbrm + PLACIDO_SBRM_SIRM_LENGTH, PLACIDO_SIRM_BYTES);
  placido_write_u32(sbrm + PLACIDO_SBRM_CURRENT_SPEED,
                    camera->speed == PLACIDO_GADGET_SUPER ? SPEED_SUPER : SPEED_HIGH);
}

static void set_up_manifest(placido_u3v_camera *camera, bool is_zip) {
  uint8_t *entry = camera->manifest + 8;
  placido_write_u64(camera->manifest, 1);
  placido_write_u32(entry, 0x01000000u); /* version 1.0.0 of the file */
  placido_write_u32(entry + PLACIDO_MANIFEST_SCHEMA,
                    0x01010000u | (is_zip ? 1u << 10 : 0u)); /* GenApi 1.1 */
  placido_write_u64(entry + PLACIDO_MANIFEST_ADDRESS, PLACIDO_U3V_GADGET_DESCRIPTION);
  placido_write_u64(entry + PLACIDO_MANIFEST_SIZE, camera->description_size);
}

void placido_u3v_registers_set_up(placido_u3v_camera *camera, const char *serial, bool is_zip) {
  const placido_u3v_region regions[PLACIDO_U3V_GADGET_REGIONS] = {
      {0, camera->abrm, sizeof camera->abrm},
      {PLACIDO_U3V_GADGET_SBRM, camera->sbrm, sizeof camera->sbrm},
      {PLACIDO_U3V_GADGET_SIRM, camera->sirm, sizeof camera->sirm},
      {PLACIDO_U3V_GADGET_MANIFEST, camera->manifest, sizeof camera->manifest},
      {PLACIDO_U3V_GADGET_FEATURES, camera->features, sizeof camera->features},
      {PLACIDO_U3V_GADGET_DESCRIPTION, camera->description, camera->description_size},
  };
  memcpy(camera->regions, regions, sizeof regions);
  set_up_bootstrap(camera, serial);
  set_up_technology(camera);
  set_up_manifest(camera, is_zip);
  placido_u3v_registers_reset(camera);
}

void placido_u3v_registers_reset(placido_u3v_camera *camera) {
  const uint32_t width_px = (uint32_t)camera->view.width_px / WIDTH_STEP_PX * WIDTH_STEP_PX;
  const uint32_t height_px = (uint32_t)camera->view.height_px / HEIGHT_STEP_PX * HEIGHT_STEP_PX;
  const double exposure_us = fmin(NOMINAL_EXPOSURE_US, 0.5e6 / camera->view.rate_hz);
  memset(camera->features, 0, sizeof camera->features);
  memset(camera->sirm, 0, sizeof camera->sirm);
  placido_write_u32(camera->sirm + PLACIDO_SIRM_INFO, ALIGNMENT_LOG2 << 24);
  placido_write_u32(camera->sirm + PLACIDO_SIRM_REQUIRED_LEADER, PLACIDO_U3V_LEADER_BYTES);
  placido_write_u32(camera->sirm + PLACIDO_SIRM_REQUIRED_TRAILER, PLACIDO_U3V_TRAILER_BYTES);
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
  refresh(camera);
}
