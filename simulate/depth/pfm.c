/* Depth maps as portable float maps (P. Debevec's PFM): a line of text each for the kind, the size
 * and a scale whose sign is the byte order, then rows from the lowest up. */
#include "simulate/depth/map.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A head longer than this is none. */
enum { HEAD_MAX = 128, SAMPLE_BYTES = 4 };

typedef struct head {
  long width_px, height_px;
  bool little_endian;
  size_t bytes; /* of the head; samples follow */
} head;

/* "Pf", two sizes and a scale, then a single white space. */
static bool read_head(head *read, const placido_depth_file *file) {
  char text[HEAD_MAX + 1] = "", *end;
  memcpy(text, file->bytes, file->size < HEAD_MAX ? file->size : HEAD_MAX);
  read->width_px = strtol(text + 2, &end, 10);
  read->height_px = strtol(end, &end, 10);
  char *last = end;
  double scale = strtod(last, &end);
  read->little_endian = scale < 0;
  read->bytes = (size_t)(end - text) + 1;
  return end > last && isfinite(scale) && scale != 0 && (*end == '\n' || *end == ' ') &&
         read->width_px > 0 && read->height_px > 0;
}

static float sample_at(const unsigned char *bytes, bool little_endian) {
  uint32_t bits = 0;
  float sample;
  for (int i = 0; i < SAMPLE_BYTES; i++) {
    bits = bits << 8 | bytes[little_endian ? SAMPLE_BYTES - 1 - i : i];
  }
  memcpy(&sample, &bits, sizeof sample);
  return sample;
}

int placido_depth_read_pfm(placido_image *metres, const placido_depth_file *file, const int size[2],
                           placido_error *err) {
  head read;
  *metres = (placido_image){0};
  if (!read_head(&read, file)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: its head makes no sense, expected Pf, width, "
                             "height and a scale", file->name);
  }
  int status = placido_depth_check_size(file, read.width_px, read.height_px, size, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  size_t width = (size_t)size[0], height = (size_t)size[1];
  if ((file->size - read.bytes) / SAMPLE_BYTES / width < height) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: ends before its last row", file->name);
  }
  status = placido_image_new(metres, size[0], size[1], 1, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const unsigned char *from = (const unsigned char *)file->bytes + read.bytes;
  for (size_t y = height; y-- > 0;) {
    for (size_t x = 0; x < width; x++, from += SAMPLE_BYTES) {
      metres->data[y * width + x] = sample_at(from, read.little_endian);
    }
  }
  return PLACIDO_OK;
}
