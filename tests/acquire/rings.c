/* A small picture of rings whose contrast a test knows. */
#include "tests/acquire/rings.h"

#include <stdlib.h>

void rings_draw(placido_frame *frame, int contrast) {
  const int middle = frame->width_px / 2;
  for (int y = 0; y < frame->height_px; y++) {
    for (int x = 0; x < frame->width_px; x++) {
      const int dx = abs(x - middle), dy = abs(y - middle);
      const int ring = (dx > dy ? dx : dy) / 4 % 2;
      frame->data[(size_t)y * frame->stride_bytes + (size_t)x] =
          (uint8_t)(100 + (ring ? contrast : 0));
    }
  }
}
