/* USB/IP's packets (Documentation/usb/usbip_protocol.rst of the kernel). */
#include "gadget/usbip.h"

#include <stdio.h>
#include <string.h>

#define VERSION 0x0111
#define SUBMITTED 3
#define UNLINKED 4
#define BUS_NUMBER 1 /* as we call ourselves: the first device of the first bus */
#define DEVICE_NUMBER 2

#define NO_PACKETS 0xFFFFFFFFu /* "not isochronous", beside 0 */

static uint32_t get_u32(const uint8_t *bytes) {
  return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static void put_u16(uint8_t *bytes, uint16_t value) {
  bytes[0] = (uint8_t)(value >> 8);
  bytes[1] = (uint8_t)value;
}

static void put_u32(uint8_t *bytes, uint32_t value) {
  put_u16(bytes, (uint16_t)(value >> 16));
  put_u16(bytes + 2, (uint16_t)value);
}

/* The setup packet itself is little-endian, as on the wire. */
static placido_gadget_setup decode_setup(const uint8_t *bytes) {
  return (placido_gadget_setup){.request_type = bytes[0],
                                .request = bytes[1],
                                .value = (uint16_t)(bytes[2] | bytes[3] << 8),
                                .index = (uint16_t)(bytes[4] | bytes[5] << 8),
                                .length = (uint16_t)(bytes[6] | bytes[7] << 8)};
}

static int decode_submit(placido_usbip_request *request, const uint8_t *bytes,
                         placido_error *err) {
  const uint32_t direction = get_u32(bytes + 12), endpoint = get_u32(bytes + 16);
  const uint32_t size = get_u32(bytes + 24), packets = get_u32(bytes + 32);
  if (direction > 1 || endpoint > 15) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "USB/IP: a transfer of direction %u on endpoint %u", direction,
                             endpoint);
  }
  if (size > PLACIDO_USBIP_TRANSFER_BYTES_MAX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "USB/IP: a transfer of %u bytes, at most %u can be", size,
                             PLACIDO_USBIP_TRANSFER_BYTES_MAX);
  }
  if (packets != 0 && packets != NO_PACKETS) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "USB/IP: an isochronous transfer, of which the device has none");
  }
  request->is_in = direction == 1;
  request->endpoint = (uint8_t)(endpoint | (request->is_in && endpoint > 0 ? 0x80u : 0u));
  request->size = size;
  request->setup = decode_setup(bytes + 40);
  if (endpoint == 0 && size > 0 && request->is_in != (request->setup.request_type >> 7 == 1)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "USB/IP: a control transfer whose data go the other way than it says");
  }
  return PLACIDO_OK;
}

int placido_usbip_request_decode(placido_usbip_request *request,
                                 const uint8_t bytes[PLACIDO_USBIP_HEADER_BYTES],
                                 placido_error *err) {
  const uint32_t command = get_u32(bytes);
  *request = (placido_usbip_request){.sequence = get_u32(bytes + 4)};
  if (command == PLACIDO_USBIP_SUBMIT) {
    request->command = PLACIDO_USBIP_SUBMIT;
    return decode_submit(request, bytes, err);
  }
  if (command == PLACIDO_USBIP_UNLINK) {
    request->command = PLACIDO_USBIP_UNLINK;
    request->unlinked = get_u32(bytes + 20);
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_INPUT, "USB/IP: there is no command %u", command);
}

static void encode_answer(uint8_t *bytes, uint32_t command, uint32_t sequence, int status) {
  memset(bytes, 0, PLACIDO_USBIP_HEADER_BYTES);
  put_u32(bytes, command);
  put_u32(bytes + 4, sequence);
  put_u32(bytes + 20, (uint32_t)status);
}

void placido_usbip_submitted_encode(uint8_t bytes[PLACIDO_USBIP_HEADER_BYTES], uint32_t sequence,
                                    int status, size_t size) {
  encode_answer(bytes, SUBMITTED, sequence, status);
  put_u32(bytes + 24, (uint32_t)size);
}

void placido_usbip_unlinked_encode(uint8_t bytes[PLACIDO_USBIP_HEADER_BYTES], uint32_t sequence,
                                   int status) {
  encode_answer(bytes, UNLINKED, sequence, status);
}

int placido_usbip_greeting_decode(enum placido_usbip_greeting *greeting,
                                  const uint8_t bytes[PLACIDO_USBIP_GREETING_BYTES],
                                  placido_error *err) {
  const unsigned version = (unsigned)(bytes[0] << 8 | bytes[1]);
  const unsigned code = (unsigned)(bytes[2] << 8 | bytes[3]);
  *greeting = PLACIDO_USBIP_LIST;
  if (version != VERSION) {
    return placido_error_set(err, PLACIDO_INPUT, "USB/IP: version %x, expected %x", version,
                             VERSION);
  }
  if (code != PLACIDO_USBIP_LIST && code != PLACIDO_USBIP_IMPORT) {
    return placido_error_set(err, PLACIDO_INPUT, "USB/IP: there is no request %x", code);
  }
  *greeting = code == PLACIDO_USBIP_LIST ? PLACIDO_USBIP_LIST : PLACIDO_USBIP_IMPORT;
  return PLACIDO_OK;
}

void placido_usbip_reply_encode(uint8_t bytes[PLACIDO_USBIP_GREETING_BYTES],
                                enum placido_usbip_greeting greeting, uint32_t status) {
  put_u16(bytes, VERSION);
  put_u16(bytes + 2, (uint16_t)(greeting & 0x7FFF));
  put_u32(bytes + 4, status);
}

int placido_usbip_device_encode(uint8_t bytes[PLACIDO_USBIP_DEVICE_BYTES],
                                const placido_usbip_description *description,
                                placido_error *err) {
  const uint8_t *device = description->device, *configuration = description->configuration;
  memset(bytes, 0, PLACIDO_USBIP_DEVICE_BYTES);
  if (description->device_size < 18 || description->configuration_size < 9) {
    return placido_error_set(err, PLACIDO_INPUT, "USB/IP: the device's descriptors are too short");
  }
  snprintf((char *)bytes, 256, "/sys/devices/placido/%s", description->bus_id);
  snprintf((char *)bytes + 256, PLACIDO_USBIP_BUS_ID_BYTES, "%s", description->bus_id);
  put_u32(bytes + 288, BUS_NUMBER);
  put_u32(bytes + 292, DEVICE_NUMBER);
  put_u32(bytes + 296, (uint32_t)description->speed);
  for (int i = 0; i < 3; i++) { /* vendor, product, version: little-endian in the descriptor */
    bytes[300 + 2 * i] = device[9 + 2 * i];
    bytes[301 + 2 * i] = device[8 + 2 * i];
  }
  memcpy(bytes + 306, device + 4, 3); /* class, subclass, protocol */
  bytes[309] = configuration[5];      /* its value */
  bytes[310] = device[17];            /* configurations */
  bytes[311] = configuration[4];      /* interfaces */
  return PLACIDO_OK;
}

size_t placido_usbip_interfaces_encode(uint8_t *bytes, size_t capacity,
                                       const placido_usbip_description *description) {
  const uint8_t *all = description->configuration;
  const size_t size = description->configuration_size;
  const size_t wanted = size < 9 ? 0 : (size_t)all[4] * PLACIDO_USBIP_INTERFACE_BYTES;
  size_t used = 0;
  if (wanted > capacity) {
    return 0;
  }
  memset(bytes, 0, wanted);
  for (size_t at = 0; at + 2 <= size && all[at] >= 2 && used < wanted; at += all[at]) {
    if (all[at + 1] == 4 && all[at] >= 9 && at + 9 <= size && all[at + 3] == 0) {
      memcpy(bytes + used, all + at + 5, 3);
      used += PLACIDO_USBIP_INTERFACE_BYTES;
    }
  }
  return wanted;
}
