/* The stream's packets: the leader before and the trailer behind the samples of a picture. */
#ifndef PLACIDO_U3V_WIRE_PACKET_H
#define PLACIDO_U3V_WIRE_PACKET_H

#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

#define PLACIDO_U3V_LEADER_BYTES 52
#define PLACIDO_U3V_TRAILER_BYTES 32 /* as written; 28 are enough to be read */
#define PLACIDO_U3V_PAYLOAD_IMAGE 0x0001
#define PLACIDO_U3V_PAYLOAD_IMAGE_CHUNKS 0x4001

typedef struct placido_u3v_leader {
  uint64_t frame_id;
  uint16_t payload_type;
  uint64_t timestamp_ns; /* the camera's own clock */
  uint32_t pixel_format; /* PFNC code */
  uint32_t width_px, height_px, offset_x_px, offset_y_px;
  uint16_t padding_x_bytes; /* behind each row */
} placido_u3v_leader;

typedef struct placido_u3v_trailer {
  uint64_t frame_id;
  uint16_t status; /* 0: whole; 0xA100: data discarded; 0xA101: overrun */
  uint64_t payload_bytes;
  uint32_t height_px; /* rows really sent; 0 where a short trailer does not say */
} placido_u3v_trailer;

void placido_u3v_leader_encode(uint8_t bytes[PLACIDO_U3V_LEADER_BYTES],
                               const placido_u3v_leader *leader);
void placido_u3v_trailer_encode(uint8_t bytes[PLACIDO_U3V_TRAILER_BYTES],
                                const placido_u3v_trailer *trailer);

/* PLACIDO_INPUT where the bytes are not a leader (trailer), or shorter than one must be. The
 * fields are as sent, unchecked. */
int placido_u3v_leader_decode(placido_u3v_leader *leader, const uint8_t *bytes, size_t size,
                              placido_error *err);
int placido_u3v_trailer_decode(placido_u3v_trailer *trailer, const uint8_t *bytes, size_t size,
                               placido_error *err);

#endif
