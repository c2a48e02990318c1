/* One exposure of a camera: room for its samples. */
#include <placido/frame.h>

#include "base/memory.h"

#include <stdint.h>

#define SIDE_MAX_PX 65536

size_t placido_format_bytes(enum placido_format format) {
  static const size_t bytes[] = {[PLACIDO_MONO8] = 1, [PLACIDO_MONO16] = 2, [PLACIDO_RGB8] = 3};
  return bytes[format];
}

int placido_frame_resize(placido_frame *frame, int width_px, int height_px,
                         enum placido_format format, placido_error *err) {
  if (width_px < 1 || height_px < 1 || width_px > SIDE_MAX_PX || height_px > SIDE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a frame of %d x %d pixels: each side must be 1 to %d", width_px,
                             height_px, SIDE_MAX_PX);
  }
  size_t stride = (size_t)width_px * placido_format_bytes(format);
  if ((size_t)height_px > PTRDIFF_MAX / stride) {
    return placido_error_set(err, PLACIDO_MEMORY, "a frame of %d x %d pixels is too large",
                             width_px, height_px);
  }
  size_t bytes = stride * (size_t)height_px;
  if (frame->capacity < bytes) {
    uint8_t *data = placido_memory_new_aligned(bytes, err);
    if (!data) {
      return PLACIDO_MEMORY;
    }
    if (frame->capacity > 0) {
      placido_memory_free(frame->data);
    }
    frame->data = data;
    frame->capacity = bytes;
  }
  frame->width_px = width_px;
  frame->height_px = height_px;
  frame->stride_bytes = stride;
  frame->format = format;
  frame->bits = format == PLACIDO_MONO16 ? 16 : 8;
  return PLACIDO_OK;
}

void placido_frame_free(placido_frame *frame) {
  if (!frame) {
    return;
  }
  if (frame->capacity > 0) {
    placido_memory_free(frame->data);
  }
  *frame = (placido_frame){0};
}
