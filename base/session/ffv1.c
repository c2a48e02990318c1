/* The checksums of an FFV1 frame: slices stand one behind the other, each with a footer of its
 * size, a status byte and a CRC over slice and footer that comes out as 0 (RFC 9043, 4.8). */
#include "base/session/ffv1.h"

#include <libavutil/crc.h>

enum { SIZE_BYTES = 3, FOOTER_BYTES = SIZE_BYTES + 1 + 4 };

bool placido_ffv1_check(const uint8_t *packet, size_t size, bool *has_checksums) {
  const AVCRC *table = av_crc_get_table(AV_CRC_32_IEEE);
  bool whole = true;
  size_t left = size; /* the sizes stand at the ends, so the way is from the last slice back */
  while (left >= FOOTER_BYTES) {
    const uint8_t *footer = packet + left - FOOTER_BYTES;
    size_t slice = ((size_t)footer[0] << 16 | (size_t)footer[1] << 8 | footer[2]) + FOOTER_BYTES;
    if (slice > left) {
      break;
    }
    left -= slice;
    if (av_crc(table, 0, packet + left, slice) == 0) {
      *has_checksums = true;
    } else {
      whole = false;
    }
  }
  return (whole && left == 0) || !*has_checksums;
}
