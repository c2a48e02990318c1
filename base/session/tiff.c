/* Grey frames as TIFF 6.0, baseline: one strip, uncompressed, least significant byte first. */
#include "base/session/tiff.h"

#include "base/file.h"
#include "base/text.h"

#include <stdint.h>

enum { HEADER = 8, ENTRY = 12, ENTRIES = 9, DIRECTORY = 2 + ENTRIES * ENTRY + 4 };
enum { SHORT = 3, LONG = 4 };

static void put_16(FILE *stream, uint32_t value) {
  fputc((int)(value & 0xff), stream);
  fputc((int)(value >> 8 & 0xff), stream);
}

static void put_32(FILE *stream, uint32_t value) {
  put_16(stream, value);
  put_16(stream, value >> 16);
}

/* A short stands in the first half of the value's four bytes. */
static void put_entry(FILE *stream, uint32_t tag, uint32_t type, uint32_t value) {
  put_16(stream, tag);
  put_16(stream, type);
  put_32(stream, 1);
  put_32(stream, value);
}

static void put_directory(FILE *stream, const placido_frame *frame, uint32_t size) {
  const uint32_t bits = frame->format == PLACIDO_MONO16 ? 16 : 8;
  put_16(stream, ENTRIES);
  put_entry(stream, 256, LONG, (uint32_t)frame->width_px);
  put_entry(stream, 257, LONG, (uint32_t)frame->height_px);
  put_entry(stream, 258, SHORT, bits);
  put_entry(stream, 259, SHORT, 1); /* not compressed */
  put_entry(stream, 262, SHORT, 1); /* black is zero */
  put_entry(stream, 273, LONG, HEADER + DIRECTORY); /* where the strip is */
  put_entry(stream, 277, SHORT, 1); /* samples a pixel */
  put_entry(stream, 278, LONG, (uint32_t)frame->height_px); /* rows of the strip */
  put_entry(stream, 279, LONG, size);
  put_32(stream, 0); /* no further image */
}

static void put_row(FILE *stream, const placido_frame *frame, int y) {
  const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  if (frame->format == PLACIDO_MONO8) {
    fwrite(row, 1, (size_t)frame->width_px, stream);
    return;
  }
  const uint16_t *samples = (const uint16_t *)(const void *)row;
  for (int x = 0; x < frame->width_px; x++) {
    put_16(stream, samples[x]);
  }
}

int placido_tiff_save(const placido_frame *frame, const char *path, placido_error *err) {
  const uint64_t size = (uint64_t)frame->width_px * (uint64_t)frame->height_px *
                        placido_format_bytes(frame->format);
  if (frame->format == PLACIDO_RGB8 || size > UINT32_MAX - HEADER - DIRECTORY) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %s cannot be a TIFF file",
                             placido_text_tail(path),
                             frame->format == PLACIDO_RGB8 ? "a colour frame"
                                                           : "a frame of over 4 GB");
  }
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  fwrite("II*\0", 1, 4, file.stream);
  put_32(file.stream, HEADER);
  put_directory(file.stream, frame, (uint32_t)size);
  for (int y = 0; y < frame->height_px; y++) {
    put_row(file.stream, frame, y);
  }
  return placido_file_commit(&file, err); /* looks whether every write went well */
}
