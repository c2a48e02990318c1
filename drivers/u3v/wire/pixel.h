/* Pixel formats by their codes and names (EMVA PFNC), and how their samples become a frame. */
#ifndef PLACIDO_U3V_WIRE_PIXEL_H
#define PLACIDO_U3V_WIRE_PIXEL_H

#include <placido/frame.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum placido_pixel_packing {
  PLACIDO_PIXEL_PLAIN,  /* whole bytes, little-endian: a MONO frame's samples as they are */
  PLACIDO_PIXEL_LSB,    /* "p": bits follow each other from the lowest */
  PLACIDO_PIXEL_PACKED, /* GigE Vision's "Packed": two pixels in three bytes, high bytes outside */
  PLACIDO_PIXEL_RGB, PLACIDO_PIXEL_BGR, PLACIDO_PIXEL_UYVY, PLACIDO_PIXEL_YUYV,
};

typedef struct placido_pixel_format {
  uint32_t code;
  const char *name; /* as cameras and GenICam spell it: Mono12p */
  int bits;         /* significant, of a sample: 8 to 16 */
  int bits_per_pixel;
  enum placido_pixel_packing packing;
  bool is_bayer;
} placido_pixel_format;

/* NULL where the code (name) is not in the table. */
const placido_pixel_format *placido_pixel_by_code(uint32_t code);
const placido_pixel_format *placido_pixel_by_name(const char *name);
/* The table, `*count` rows, best for a topographer first: plain mono before packed before Bayer
 * before colour. */
const placido_pixel_format *placido_pixel_table(size_t *count);

/* Bytes of a row of `width_px` pixels, padding not counted; partial bytes are filled up. */
size_t placido_pixel_row_bytes(const placido_pixel_format *format, int width_px);

/* Whether a frame can hold the samples just as they came. */
bool placido_pixel_is_plain(const placido_pixel_format *format);

/* Samples to a MONO8 or MONO16 frame (right-aligned). Colour becomes luminance (BT.601 weights, as
 * the kernel's cameras are read); a Bayer mosaic gives every pixel's own sample, unscaled.
 * `row_bytes` is the distance of rows in `samples`, which has `size` bytes. PLACIDO_INPUT where
 * these are too few. */
int placido_pixel_to_frame(placido_frame *frame, const placido_pixel_format *format,
                           const uint8_t *samples, size_t size, int width_px, int height_px,
                           size_t row_bytes, placido_error *err);

/* The other way, for a simulated camera: a MONO8 or MONO16 frame to samples of a mono format
 * (PLAIN, LSB or PACKED; 8 to 16 bits), scaled by shifts. `samples` has room for height_px *
 * placido_pixel_row_bytes. PLACIDO_UNSUPPORTED for other formats. */
int placido_pixel_from_frame(uint8_t *samples, const placido_pixel_format *format,
                             const placido_frame *frame, placido_error *err);

#endif
