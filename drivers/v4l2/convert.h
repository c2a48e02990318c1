/* The pixel formats of cameras, and how each becomes a grey frame. */
#ifndef PLACIDO_DRIVERS_V4L2_CONVERT_H
#define PLACIDO_DRIVERS_V4L2_CONVERT_H

#include <placido/frame.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One row of the table of formats, which stands in order of preference for mires: grey as the
 * sensor gave it first, compressed last. */
typedef struct placido_v4l2_format {
  uint32_t fourcc;
  const char *name;         /* as in a device's address: GREY, Y10P, SRGGB8 ... */
  int bits;                 /* significant bits: 8 gives MONO8, more MONO16 */
  int group_px, group_bits; /* so many pixels of a row stand in so many bits; 0: compressed */
  bool is_mosaic;           /* a Bayer mosaic: red, green and blue by turns */
  /* One row of samples in the machine's order; `row` has the bytes of whole groups. */
  void (*unpack)(uint16_t *samples, const uint8_t *row, int width_px);
} placido_v4l2_format;

/* The table, `*count` rows. */
const placido_v4l2_format *placido_v4l2_formats(size_t *count);
/* A row, or NULL. Names are compared without regard to case. */
const placido_v4l2_format *placido_v4l2_format_of(uint32_t fourcc);
const placido_v4l2_format *placido_v4l2_format_named(const char *name);

/* The fewest bytes a row of the format has; 0 where it is compressed. */
size_t placido_v4l2_row_bytes(const placido_v4l2_format *format, int width_px);

/* Makes a frame of `size` bytes as the camera gave them, rows `stride_bytes` apart (at least
 * placido_v4l2_row_bytes). Rows that `size` does not hold wholly are black, and the frame is
 * flagged PLACIDO_FRAME_TRUNCATED; other flags are cleared.
 *
 * Grey formats: the samples as they are. YUYV and its kin: the luma Y' as it was sent (BT.601,
 * usually 16 to 235). A Bayer mosaic: luminance (R + 2 G + B) / 4 at every pixel, by the binomial
 * kernel (1 2 1; 2 4 2; 1 2 1) / 16 over the mosaic: whatever colour stands in its centre, red,
 * green and blue get exactly these weights, so the four orders of the mosaic need no distinction,
 * edges do not move, and a uniform field stays uniform. Borders are mirrored at the outermost
 * pixel, which keeps the colours' order. Rows below a truncation count as black.
 *
 * Returns PLACIDO_OK, PLACIDO_INPUT (size), PLACIDO_MEMORY, PLACIDO_UNSUPPORTED (compressed). */
int placido_v4l2_convert(placido_frame *frame, const placido_v4l2_format *format, int width_px,
                         int height_px, const uint8_t *bytes, size_t size, size_t stride_bytes,
                         placido_error *err);

#endif
