/* The control channel's packets, byte by byte: a header of 12 bytes, then what the command has. */
#include "drivers/u3v/wire/gencp.h"

#include "drivers/u3v/wire/bytes.h"

#include <stdbool.h>
#include <string.h>

#define MAGIC 0x43563355u /* "U3VC" */
#define PAYLOAD_BYTES_MAX 65535u

/* What a command's payload consists of, in this order. */
struct shape {
  uint16_t command;
  bool has_address, has_count, has_data;
};

static const struct shape *shape_of(uint16_t command) {
  static const struct shape shapes[] = {
      {PLACIDO_GENCP_READ, true, true, false},
      {PLACIDO_GENCP_READ_ACK, false, false, true},
      {PLACIDO_GENCP_WRITE, true, false, true},
      {PLACIDO_GENCP_WRITE_ACK, false, true, false},
      {PLACIDO_GENCP_PENDING_ACK, false, true, false},
  };
  static const struct shape unknown = {0, false, false, true};
  for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
    if (shapes[i].command == command) {
      return &shapes[i];
    }
  }
  return &unknown;
}

static const struct shape empty = {0, false, false, false};

/* Of the payload without its data. A count stands behind two reserved bytes. */
static size_t fixed_bytes(const struct shape *shape) {
  return (shape->has_address ? 8u : 0u) + (shape->has_count ? 4u : 0u);
}

static bool is_refusal(const placido_gencp_packet *packet) {
  return packet->flags != PLACIDO_GENCP_SUCCESS && (packet->command == PLACIDO_GENCP_READ_ACK ||
                                                    packet->command == PLACIDO_GENCP_WRITE_ACK);
}

size_t placido_gencp_encode(uint8_t *bytes, size_t capacity, const placido_gencp_packet *packet) {
  const struct shape *shape = is_refusal(packet) ? &empty : shape_of(packet->command);
  const size_t fixed = fixed_bytes(shape), data_size = shape->has_data ? packet->data_size : 0;
  if (data_size > PAYLOAD_BYTES_MAX - fixed ||
      capacity < PLACIDO_GENCP_HEADER_BYTES + fixed + data_size) {
    return 0;
  }
  placido_write_u32(bytes, MAGIC);
  placido_write_u16(bytes + 4, packet->flags);
  placido_write_u16(bytes + 6, packet->command);
  placido_write_u16(bytes + 8, (uint16_t)(fixed + data_size));
  placido_write_u16(bytes + 10, packet->request_id);
  uint8_t *payload = bytes + PLACIDO_GENCP_HEADER_BYTES;
  if (shape->has_address) {
    placido_write_u64(payload, packet->address);
  }
  if (shape->has_count) {
    placido_write_u16(payload + fixed - 4, 0);
    placido_write_u16(payload + fixed - 2, packet->count);
  }
  if (data_size > 0) {
    memcpy(payload + fixed, packet->data, data_size);
  }
  return PLACIDO_GENCP_HEADER_BYTES + fixed + data_size;
}

/* The header, and that the payload is there. */
static int decode_header(placido_gencp_packet *packet, size_t *length, const uint8_t *bytes,
                         size_t size, placido_error *err) {
  *length = 0;
  if (size < PLACIDO_GENCP_HEADER_BYTES) {
    return placido_error_set(err, PLACIDO_INPUT, "%zu bytes are no packet of a control channel",
                             size);
  }
  if (placido_read_u32(bytes) != MAGIC) {
    return placido_error_set(err, PLACIDO_INPUT, "a packet begins with 0x%08x instead of U3VC",
                             (unsigned)placido_read_u32(bytes));
  }
  packet->flags = placido_read_u16(bytes + 4);
  packet->command = placido_read_u16(bytes + 6);
  packet->request_id = placido_read_u16(bytes + 10);
  *length = placido_read_u16(bytes + 8);
  if (*length > size - PLACIDO_GENCP_HEADER_BYTES) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a packet says that %zu bytes follow its header; %zu do", *length,
                             size - PLACIDO_GENCP_HEADER_BYTES);
  }
  return PLACIDO_OK;
}

int placido_gencp_decode(placido_gencp_packet *packet, const uint8_t *bytes, size_t size,
                         placido_error *err) {
  *packet = (placido_gencp_packet){0};
  size_t length;
  const int status = decode_header(packet, &length, bytes, size, err);
  if (status) {
    return status;
  }
  const struct shape *shape = shape_of(packet->command);
  if (length == 0 && packet->command == PLACIDO_GENCP_WRITE_ACK) {
    shape = &empty; /* a refusal, or a camera that does not tell how much it wrote */
  }
  const uint8_t *payload = bytes + PLACIDO_GENCP_HEADER_BYTES;
  const size_t fixed = fixed_bytes(shape);
  if (length < fixed) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a packet of command 0x%04x has %zu bytes behind its header; %zu are "
                             "the fewest",
                             (unsigned)packet->command, length, fixed);
  }
  if (shape->has_address) {
    packet->address = placido_read_u64(payload);
  }
  if (shape->has_count) {
    packet->count = placido_read_u16(payload + fixed - 2);
  }
  if (shape->has_data && length > fixed) {
    packet->data = payload + fixed;
    packet->data_size = length - fixed;
  }
  return PLACIDO_OK;
}

const char *placido_gencp_status_text(uint16_t status) {
  static const struct {
    uint16_t status;
    const char *text;
  } table[] = {
      {PLACIDO_GENCP_SUCCESS, "done"},
      {PLACIDO_GENCP_NOT_IMPLEMENTED, "the command is not implemented"},
      {PLACIDO_GENCP_INVALID_PARAMETER, "a parameter is not valid"},
      {PLACIDO_GENCP_INVALID_ADDRESS, "there is no such address"},
      {PLACIDO_GENCP_WRITE_PROTECT, "the register can only be read"},
      {PLACIDO_GENCP_BAD_ALIGNMENT, "the address is not aligned"},
      {PLACIDO_GENCP_ACCESS_DENIED, "the register cannot be used now"},
      {PLACIDO_GENCP_BUSY, "the camera is busy"},
      {PLACIDO_GENCP_MESSAGE_TIMEOUT, "the command took the camera too long"},
      {PLACIDO_GENCP_INVALID_HEADER, "the command's header is not valid"},
      {PLACIDO_GENCP_WRONG_CONFIGURATION, "the camera's settings do not allow it"},
      {PLACIDO_GENCP_GENERIC_ERROR, "an error that the camera does not explain"},
      {0xA001, "data cannot be sent again"},
      {0xA002, "the stream endpoint is halted"},
      {0xA003, "a size of the stream is not aligned"},
      {0xA004, "the sizes of the stream contradict each other"},
      {0xA100, "data were discarded"},
      {0xA101, "more data came than there was room for"},
  };
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    if (table[i].status == status) {
      return table[i].text;
    }
  }
  return "an error that this version does not know";
}
