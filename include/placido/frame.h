/* One exposure of a camera: size, format, time and samples. The first narrow waist: drivers fill
 * it, sessions store it, the reconstruction reads it. */
#ifndef PLACIDO_FRAME_H
#define PLACIDO_FRAME_H

#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

enum placido_format {
  PLACIDO_MONO8,  /* one byte a sample */
  PLACIDO_MONO16, /* two bytes in the machine's order, `bits` of them used, right-aligned */
  PLACIDO_RGB8,   /* three bytes a pixel: red, green, blue */
};

/* Always the caller's: start with `placido_frame frame = {0}`, let drivers and readers fill it as
 * often as wanted, end with placido_frame_free. */
typedef struct placido_frame {
  int width_px, height_px;
  size_t stride_bytes; /* from one row to the next */
  enum placido_format format;
  int bits;         /* significant bits of a sample, 8 to 16 */
  int64_t t_ns;     /* monotonic time of the exposure; 0 where unknown */
  uint64_t seq;     /* the device's own counter */
  uint32_t flags;   /* PLACIDO_FRAME_... */
  uint8_t *data;    /* height_px * stride_bytes bytes */
  size_t capacity;  /* bytes allocated at data; 0: data is borrowed and never freed */
} placido_frame;

#define PLACIDO_FRAME_TRUNCATED 1u /* rows are missing; they are black */
#define PLACIDO_FRAME_CORRUPT 2u   /* the device or the checksum reported an error */

/* Makes room for width × height pixels of the format and sets the sizes and bits (8 or 16).
 * Sizes range from 1 to 65,536 a side. The samples are not initialised. Memory that is large
 * enough is kept. Returns PLACIDO_OK, PLACIDO_INPUT (size), PLACIDO_MEMORY. */
int placido_frame_resize(placido_frame *frame, int width_px, int height_px,
                         enum placido_format format, placido_error *err);

/* Bytes of one pixel of the format. */
size_t placido_format_bytes(enum placido_format format);

/* Frees the samples and zeroes the struct. */
void placido_frame_free(placido_frame *frame);

#endif
