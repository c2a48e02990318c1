/* Leader and trailer of a picture, field by field. */
#include "drivers/u3v/wire/packet.h"

#include "drivers/u3v/wire/bytes.h"

#include <stdbool.h>
#include <string.h>

#define LEADER_MAGIC 0x4C563355u  /* "U3VL" */
#define TRAILER_MAGIC 0x54563355u /* "U3VT" */
#define TRAILER_BYTES_MIN 28

void placido_u3v_leader_encode(uint8_t bytes[PLACIDO_U3V_LEADER_BYTES],
                               const placido_u3v_leader *leader) {
  memset(bytes, 0, PLACIDO_U3V_LEADER_BYTES);
  placido_write_u32(bytes, LEADER_MAGIC);
  placido_write_u16(bytes + 6, PLACIDO_U3V_LEADER_BYTES);
  placido_write_u64(bytes + 8, leader->frame_id);
  placido_write_u16(bytes + 18, leader->payload_type);
  placido_write_u64(bytes + 20, leader->timestamp_ns);
  placido_write_u32(bytes + 28, leader->pixel_format);
  placido_write_u32(bytes + 32, leader->width_px);
  placido_write_u32(bytes + 36, leader->height_px);
  placido_write_u32(bytes + 40, leader->offset_x_px);
  placido_write_u32(bytes + 44, leader->offset_y_px);
  placido_write_u16(bytes + 48, leader->padding_x_bytes);
}

void placido_u3v_trailer_encode(uint8_t bytes[PLACIDO_U3V_TRAILER_BYTES],
                                const placido_u3v_trailer *trailer) {
  memset(bytes, 0, PLACIDO_U3V_TRAILER_BYTES);
  placido_write_u32(bytes, TRAILER_MAGIC);
  placido_write_u16(bytes + 6, PLACIDO_U3V_TRAILER_BYTES);
  placido_write_u64(bytes + 8, trailer->frame_id);
  placido_write_u16(bytes + 16, trailer->status);
  placido_write_u64(bytes + 20, trailer->payload_bytes);
  placido_write_u32(bytes + 28, trailer->height_px);
}

static int check(const uint8_t *bytes, size_t size, uint32_t magic, size_t fewest, const char *what,
                 placido_error *err) {
  if (size < fewest) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the picture's %s has %zu bytes; %zu are the fewest", what, size,
                             fewest);
  }
  if (placido_read_u32(bytes) != magic) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "0x%08x stands where the picture's %s begins with 0x%08x",
                             (unsigned)placido_read_u32(bytes), what, (unsigned)magic);
  }
  return PLACIDO_OK;
}

int placido_u3v_leader_decode(placido_u3v_leader *leader, const uint8_t *bytes, size_t size,
                              placido_error *err) {
  *leader = (placido_u3v_leader){0};
  const int status = check(bytes, size, LEADER_MAGIC, PLACIDO_U3V_LEADER_BYTES, "leader", err);
  if (status) {
    return status;
  }
  *leader = (placido_u3v_leader){
      .frame_id = placido_read_u64(bytes + 8),
      .payload_type = placido_read_u16(bytes + 18),
      .timestamp_ns = placido_read_u64(bytes + 20),
      .pixel_format = placido_read_u32(bytes + 28),
      .width_px = placido_read_u32(bytes + 32),
      .height_px = placido_read_u32(bytes + 36),
      .offset_x_px = placido_read_u32(bytes + 40),
      .offset_y_px = placido_read_u32(bytes + 44),
      .padding_x_bytes = placido_read_u16(bytes + 48),
  };
  return PLACIDO_OK;
}

int placido_u3v_trailer_decode(placido_u3v_trailer *trailer, const uint8_t *bytes, size_t size,
                               placido_error *err) {
  *trailer = (placido_u3v_trailer){0};
  const int status = check(bytes, size, TRAILER_MAGIC, TRAILER_BYTES_MIN, "trailer", err);
  if (status) {
    return status;
  }
  /* What lies behind the size the trailer tells is filling up to the camera's alignment. */
  const bool tells_height = size >= PLACIDO_U3V_TRAILER_BYTES &&
                           placido_read_u16(bytes + 6) >= PLACIDO_U3V_TRAILER_BYTES;
  *trailer = (placido_u3v_trailer){
      .frame_id = placido_read_u64(bytes + 8),
      .status = placido_read_u16(bytes + 16),
      .payload_bytes = placido_read_u64(bytes + 20),
      .height_px = tells_height ? placido_read_u32(bytes + 28) : 0,
  };
  return PLACIDO_OK;
}
