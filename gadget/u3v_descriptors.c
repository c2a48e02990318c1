/* The USB descriptors of a USB3 Vision camera: an interface for control, one for the stream, and
 * the class's own device info. */
#include "gadget/strings.h"
#include "gadget/u3v.h"
#include "gadget/u3v_camera.h"

#include <string.h>

enum text { NONE, VENDOR, MODEL, SERIAL, GUID, FAMILY, VERSION, INFO, USER };

#define VENDOR_ID 0x1209  /* pid.codes: ... */
#define PRODUCT_ID 0x0001 /* ... for tests and experiments */
#define LOW(number) ((number) & 0xFF)
#define HIGH(number) ((number) >> 8)

/* The strings of the device: as the registers have them, but for the GUID: a vendor's four
 * characters and eight of the serial number's. */
static const char *text_of(const placido_u3v_camera *camera, uint8_t index, char guid[16]) {
  static const struct {
    uint8_t index;
    unsigned address;
  } registers[] = {
      {VENDOR, PLACIDO_ABRM_MANUFACTURER}, {MODEL, PLACIDO_ABRM_MODEL},
      {SERIAL, PLACIDO_ABRM_SERIAL},       {FAMILY, PLACIDO_ABRM_FAMILY},
      {VERSION, PLACIDO_ABRM_DEVICE_VERSION}, {INFO, PLACIDO_ABRM_MANUFACTURER_INFO},
      {USER, PLACIDO_ABRM_USER_NAME},
  };
  for (size_t i = 0; i < sizeof registers / sizeof registers[0]; i++) {
    if (registers[i].index == index) {
      return (const char *)camera->abrm + registers[i].address;
    }
  }
  if (index != GUID) {
    return NULL;
  }
  uint32_t hash = 2166136261u; /* FNV-1a: cameras of other serial numbers have other GUIDs */
  for (const uint8_t *c = camera->abrm + PLACIDO_ABRM_SERIAL; *c; c++) {
    hash = (hash ^ *c) * 16777619u;
  }
  memcpy(guid, "PLAC", 4);
  for (int i = 0; i < 8; i++) {
    guid[4 + i] = "0123456789ABCDEF"[hash >> 4 * i & 15];
  }
  guid[12] = '\0';
  return guid;
}

static size_t put_string(const placido_u3v_camera *camera, uint8_t *bytes, uint8_t index) {
  char guid[16], text[64];
  if (index == 0) {
    return placido_gadget_languages(bytes);
  }
  const char *from = text_of(camera, index, guid);
  if (!from) {
    return 0;
  }
  const size_t length = strnlen(from, sizeof text - 1);
  memcpy(text, from, length);
  text[length] = '\0';
  return placido_gadget_string(bytes, text);
}

static size_t append(uint8_t *bytes, size_t size, const uint8_t *more, size_t more_size) {
  memcpy(bytes + size, more, more_size);
  return size + more_size;
}

static size_t put_device(const placido_u3v_camera *camera, uint8_t *bytes, uint8_t index) {
  const bool is_super = camera->speed == PLACIDO_GADGET_SUPER;
  const uint8_t device[] = {18, 1, 0, is_super ? 3 : 2, /* USB 3.0 or 2.0 */
                            0xEF, 2, 1, /* class: an interface association has it */
                            is_super ? 9 : 64, /* of endpoint 0: 2^9 or 64 */
                            LOW(VENDOR_ID), HIGH(VENDOR_ID), LOW(PRODUCT_ID), HIGH(PRODUCT_ID),
                            0, 1, VENDOR, MODEL, SERIAL, 1};
  return index == 0 ? append(bytes, 0, device, sizeof device) : 0;
}

/* A bulk endpoint, with its companion at super speed. */
static size_t append_endpoint(const placido_u3v_camera *camera, uint8_t *bytes, size_t size,
                              uint8_t address, uint8_t burst) {
  const bool is_super = camera->speed == PLACIDO_GADGET_SUPER;
  const uint8_t endpoint[] = {7, 5, address, 2, 0, is_super ? 4 : 2, 0}; /* 1,024 or 512 bytes */
  const uint8_t companion[] = {6, 0x30, burst, 0, 0, 0};
  size = append(bytes, size, endpoint, sizeof endpoint);
  return is_super ? append(bytes, size, companion, sizeof companion) : size;
}

static size_t put_configuration(const placido_u3v_camera *camera, uint8_t *bytes, uint8_t index) {
  const bool is_super = camera->speed == PLACIDO_GADGET_SUPER;
  const uint8_t head[] = {9, 2, 0, 0, 2, 1, 0, 0x80, is_super ? 112 : 250, /* 896 or 500 mA */
                          8, 11, 0, 2, 0xEF, 5, 0, 0, /* association */
                          9, 4, 0, 0, 2, 0xEF, 5, 0, 0}; /* control interface */
  const uint8_t info[] = {20, 0x24, 1,
                          0, 0, 1, 0, /* GenCP 1.0 */
                          2, 0, 1, 0, /* USB3 Vision 1.2 */
                          GUID, VENDOR, MODEL, FAMILY, VERSION, INFO, SERIAL, USER,
                          is_super ? 0x0C : 0x04}; /* speeds: super and high, or high */
  static const uint8_t stream[] = {9, 4, 1, 0, 1, 0xEF, 5, 2, 0};
  size_t size = append(bytes, 0, head, sizeof head);
  size = append(bytes, size, info, sizeof info);
  size = append_endpoint(camera, bytes, size, PLACIDO_U3V_GADGET_ANSWER, 0);
  size = append_endpoint(camera, bytes, size, PLACIDO_U3V_GADGET_COMMAND, 0);
  size = append(bytes, size, stream, sizeof stream);
  size = append_endpoint(camera, bytes, size, PLACIDO_U3V_GADGET_STREAM, 15);
  bytes[2] = (uint8_t)LOW(size);
  bytes[3] = (uint8_t)HIGH(size);
  return index == 0 ? size : 0;
}

/* What a device of USB 3 can do beside: link power management, super speed. */
static size_t put_capabilities(const placido_u3v_camera *camera, uint8_t *bytes, uint8_t index) {
  static const uint8_t bos[] = {5, 15, 22, 0, 2, 7, 16, 2, 2, 0, 0, 0,
                                10, 16, 3, 0, 0x0E, 0, 3, 10, 100, 0};
  return camera->speed == PLACIDO_GADGET_SUPER && index == 0 ? append(bytes, 0, bos, sizeof bos)
                                                             : 0;
}

const uint8_t *placido_u3v_descriptor(placido_u3v_camera *camera, uint8_t type, uint8_t index,
                                      size_t *size) {
  static const struct {
    uint8_t type;
    size_t (*put)(const placido_u3v_camera *camera, uint8_t *bytes, uint8_t index);
  } rows[] = {{1, put_device}, {2, put_configuration}, {15, put_capabilities}, {3, put_string}};
  *size = 0;
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    if (rows[i].type == type) {
      *size = rows[i].put(camera, camera->descriptors[i], index);
      return *size > 0 ? camera->descriptors[i] : NULL;
    }
  }
  return NULL;
}
