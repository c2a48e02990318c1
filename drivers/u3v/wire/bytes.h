/* Little-endian numbers in a packet's bytes, wherever they lie. */
#ifndef PLACIDO_U3V_WIRE_BYTES_H
#define PLACIDO_U3V_WIRE_BYTES_H

#include <stdint.h>

static inline uint16_t placido_read_u16(const uint8_t *bytes) {
  return (uint16_t)(bytes[0] | (unsigned)bytes[1] << 8);
}

static inline uint32_t placido_read_u32(const uint8_t *bytes) {
  return placido_read_u16(bytes) | (uint32_t)placido_read_u16(bytes + 2) << 16;
}

static inline uint64_t placido_read_u64(const uint8_t *bytes) {
  return placido_read_u32(bytes) | (uint64_t)placido_read_u32(bytes + 4) << 32;
}

static inline void placido_write_u16(uint8_t *bytes, uint16_t value) {
  bytes[0] = (uint8_t)value;
  bytes[1] = (uint8_t)(value >> 8);
}

static inline void placido_write_u32(uint8_t *bytes, uint32_t value) {
  placido_write_u16(bytes, (uint16_t)value);
  placido_write_u16(bytes + 2, (uint16_t)(value >> 16));
}

static inline void placido_write_u64(uint8_t *bytes, uint64_t value) {
  placido_write_u32(bytes, (uint32_t)value);
  placido_write_u32(bytes + 4, (uint32_t)(value >> 32));
}

#endif
