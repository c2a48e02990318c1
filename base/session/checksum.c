/* The checksum of a frame's samples: raw and FFVHUFF video have none of their own, so that a
 * flipped bit would pass for a sample. */
#include "base/session/checksum.h"

#include <libavutil/crc.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* The same bytes whatever the machine's order is. */
static uint32_t add_swapped(const AVCRC *table, uint32_t crc, const uint8_t *row, size_t size) {
  for (size_t i = 0; i < size; i += sizeof(uint16_t)) {
    uint16_t sample;
    memcpy(&sample, row + i, sizeof sample);
    const uint8_t bytes[] = {(uint8_t)(sample & 0xff), (uint8_t)(sample >> 8)};
    crc = av_crc(table, crc, bytes, sizeof bytes);
  }
  return crc;
}

static bool is_little_endian(void) {
  const uint16_t one = 1;
  uint8_t first;
  memcpy(&first, &one, sizeof first);
  return first == 1;
}

uint32_t placido_frame_checksum(const placido_frame *frame) {
  const AVCRC *table = av_crc_get_table(AV_CRC_32_IEEE_LE);
  const size_t size = (size_t)frame->width_px * placido_format_bytes(frame->format);
  const bool swapped = frame->format == PLACIDO_MONO16 && !is_little_endian();
  uint32_t crc = UINT32_MAX;
  for (int y = 0; y < frame->height_px; y++) {
    const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    crc = swapped ? add_swapped(table, crc, row, size) : av_crc(table, crc, row, size);
  }
  return crc ^ UINT32_MAX;
}
