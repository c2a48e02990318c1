/* Faults in their time, and frames as a bad cable leaves them; the same each time. */
#include "drivers/replay/strike.h"

#include <string.h>

void placido_strikes_rewind(placido_strikes *strikes) {
  memset(strikes->progress, 0, sizeof strikes->progress);
}

placido_strike placido_strikes_at(placido_strikes *strikes, int64_t frame, int64_t t_ns) {
  placido_strike strike = {0};
  for (size_t i = 0; i < strikes->faults.count; i++) {
    const placido_fault *fault = &strikes->faults.list[i];
    if (!strikes->progress[i].has_begun && (fault->is_by_time ? t_ns : frame) >= fault->at) {
      strikes->progress[i].has_begun = true;
      strikes->progress[i].first = frame;
    }
    if (!strikes->progress[i].has_begun || frame - strikes->progress[i].first >= fault->frames) {
      continue;
    }
    strike.any[fault->kind] = true;
    if (fault->kind == PLACIDO_FAULT_DELAY) {
      strike.delay_ns += fault->duration_ns;
    } else if (fault->kind == PLACIDO_FAULT_DISCONNECT) {
      strike.absence_ns = fault->duration_ns;
    }
  }
  return strike;
}

/* The samples of every second row of the middle third, turned over: of 16-bit samples the unused
 * bits stay 0. */
static void garble(placido_frame *frame) {
  const size_t row_bytes = (size_t)frame->width_px * placido_format_bytes(frame->format);
  const uint16_t used = (uint16_t)((1u << frame->bits) - 1);
  for (int y = frame->height_px / 3; y <= frame->height_px * 2 / 3 && y < frame->height_px;
       y += 2) {
    uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    for (size_t i = 0; i < row_bytes; i += frame->format == PLACIDO_MONO16 ? 2 : 1) {
      if (frame->format == PLACIDO_MONO16) {
        uint16_t sample;
        memcpy(&sample, row + i, sizeof sample);
        sample ^= used;
        memcpy(row + i, &sample, sizeof sample);
      } else {
        row[i] ^= 0xff;
      }
    }
  }
}

void placido_strike_spoil(const placido_strike *strike, placido_frame *frame) {
  if (strike->any[PLACIDO_FAULT_CORRUPT]) {
    garble(frame);
    frame->flags |= PLACIDO_FRAME_CORRUPT;
  }
  if (strike->any[PLACIDO_FAULT_TRUNCATE]) {
    const size_t there = (size_t)(frame->height_px / 2);
    memset(frame->data + there * frame->stride_bytes, 0,
           ((size_t)frame->height_px - there) * frame->stride_bytes);
    frame->flags |= PLACIDO_FRAME_TRUNCATED;
  }
}
