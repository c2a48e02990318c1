/* Samples of a pixel format to a frame and back, in whole groups: the fewest pixels of a format
 * that end with a byte. A last part of a group is filled up with zeros beside the picture.
 *
 * Layouts after the EMVA Pixel Format Naming Convention; luminance after ITU-R BT.601. */
#include "drivers/u3v/wire/pixel.h"

#include "drivers/u3v/wire/bytes.h"

#include <string.h>

#define GROUP_PX_MAX 4
#define GROUP_BYTES_MAX 7
#define CHUNK_PX 256 /* whole groups of every layout */

static void unpack_bytes(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  memcpy(samples, bytes, groups);
}

/* Bits above the format's are a camera's filling, not light. */
static void unpack_words(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  uint16_t *out = samples;
  const unsigned mask = (1u << bits) - 1;
  for (size_t i = 0; i < groups; i++) {
    out[i] = (uint16_t)((bytes[2 * i] | (unsigned)bytes[2 * i + 1] << 8) & mask);
  }
}

static void unpack_lsb_10(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  uint16_t *out = samples;
  for (size_t i = 0; i < groups; i++, bytes += 5, out += 4) {
    out[0] = (uint16_t)(bytes[0] | (bytes[1] & 0x03u) << 8);
    out[1] = (uint16_t)(bytes[1] >> 2 | (bytes[2] & 0x0Fu) << 6);
    out[2] = (uint16_t)(bytes[2] >> 4 | (bytes[3] & 0x3Fu) << 4);
    out[3] = (uint16_t)(bytes[3] >> 6 | (unsigned)bytes[4] << 2);
  }
}

static void unpack_lsb_12(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  uint16_t *out = samples;
  for (size_t i = 0; i < groups; i++, bytes += 3, out += 2) {
    out[0] = (uint16_t)(bytes[0] | (bytes[1] & 0x0Fu) << 8);
    out[1] = (uint16_t)(bytes[1] >> 4 | (unsigned)bytes[2] << 4);
  }
}

static void unpack_lsb_14(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  uint16_t *out = samples;
  for (size_t i = 0; i < groups; i++, bytes += 7, out += 4) {
    out[0] = (uint16_t)(bytes[0] | (bytes[1] & 0x3Fu) << 8);
    out[1] = (uint16_t)(bytes[1] >> 6 | (unsigned)bytes[2] << 2 | (bytes[3] & 0x0Fu) << 10);
    out[2] = (uint16_t)(bytes[3] >> 4 | (unsigned)bytes[4] << 4 | (bytes[5] & 0x03u) << 12);
    out[3] = (uint16_t)(bytes[5] >> 2 | (unsigned)bytes[6] << 6);
  }
}

/* The upper eight bits of both pixels outside; between them the lower bits, the first's low. */
static void unpack_packed(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  uint16_t *out = samples;
  const int low_bits = bits - 8;
  const unsigned mask = (1u << low_bits) - 1;
  for (size_t i = 0; i < groups; i++, bytes += 3, out += 2) {
    out[0] = (uint16_t)((unsigned)bytes[0] << low_bits | (bytes[1] & mask));
    out[1] = (uint16_t)((unsigned)bytes[2] << low_bits | (bytes[1] >> 4 & mask));
  }
}

/* 0.299 R + 0.587 G + 0.114 B in parts of 256. */
static uint8_t luminance(unsigned red, unsigned green, unsigned blue) {
  return (uint8_t)((77 * red + 150 * green + 29 * blue + 128) >> 8);
}

static void unpack_rgb(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  uint8_t *out = samples;
  for (size_t i = 0; i < groups; i++, bytes += 3) {
    out[i] = luminance(bytes[0], bytes[1], bytes[2]);
  }
}

static void unpack_bgr(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  uint8_t *out = samples;
  for (size_t i = 0; i < groups; i++, bytes += 3) {
    out[i] = luminance(bytes[2], bytes[1], bytes[0]);
  }
}

static void unpack_odd_bytes(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  uint8_t *out = samples;
  for (size_t i = 0; i < groups; i++) {
    out[i] = bytes[2 * i + 1];
  }
}

static void unpack_even_bytes(void *samples, const uint8_t *bytes, size_t groups, int bits) {
  (void)bits;
  uint8_t *out = samples;
  for (size_t i = 0; i < groups; i++) {
    out[i] = bytes[2 * i];
  }
}

static void pack_bytes(uint8_t *bytes, const uint16_t *samples, size_t groups, int bits) {
  (void)bits;
  for (size_t i = 0; i < groups; i++) {
    bytes[i] = (uint8_t)samples[i];
  }
}

static void pack_words(uint8_t *bytes, const uint16_t *samples, size_t groups, int bits) {
  (void)bits;
  for (size_t i = 0; i < groups; i++) {
    placido_write_u16(bytes + 2 * i, samples[i]);
  }
}

static void pack_lsb(uint8_t *bytes, const uint16_t *samples, size_t groups, int bits) {
  const int group_px = bits == 12 ? 2 : 4;
  for (size_t i = 0; i < groups; i++, samples += group_px) {
    uint64_t group = 0;
    for (int k = 0; k < group_px; k++) {
      group |= (uint64_t)samples[k] << k * bits;
    }
    for (int k = 0; k < group_px * bits; k += 8) {
      *bytes++ = (uint8_t)(group >> k);
    }
  }
}

static void pack_packed(uint8_t *bytes, const uint16_t *samples, size_t groups, int bits) {
  const int low_bits = bits - 8;
  const unsigned mask = (1u << low_bits) - 1;
  for (size_t i = 0; i < groups; i++, bytes += 3, samples += 2) {
    bytes[0] = (uint8_t)(samples[0] >> low_bits);
    bytes[1] = (uint8_t)((samples[0] & mask) | (samples[1] & mask) << 4);
    bytes[2] = (uint8_t)(samples[1] >> low_bits);
  }
}

/* How samples lie in bytes. `unpack` gives bytes where there are 8 bits, words where more. */
static const struct layout {
  enum placido_pixel_packing packing;
  int bits_min, bits_max;
  size_t group_px, group_bytes;
  void (*unpack)(void *samples, const uint8_t *bytes, size_t groups, int bits);
  void (*pack)(uint8_t *bytes, const uint16_t *samples, size_t groups, int bits);
} layouts[] = {
    {PLACIDO_PIXEL_PLAIN, 8, 8, 1, 1, unpack_bytes, pack_bytes},
    {PLACIDO_PIXEL_PLAIN, 9, 16, 1, 2, unpack_words, pack_words},
    {PLACIDO_PIXEL_LSB, 10, 10, 4, 5, unpack_lsb_10, pack_lsb},
    {PLACIDO_PIXEL_LSB, 12, 12, 2, 3, unpack_lsb_12, pack_lsb},
    {PLACIDO_PIXEL_LSB, 14, 14, 4, 7, unpack_lsb_14, pack_lsb},
    {PLACIDO_PIXEL_PACKED, 10, 12, 2, 3, unpack_packed, pack_packed},
    {PLACIDO_PIXEL_RGB, 8, 8, 1, 3, unpack_rgb, NULL},
    {PLACIDO_PIXEL_BGR, 8, 8, 1, 3, unpack_bgr, NULL},
    {PLACIDO_PIXEL_UYVY, 8, 8, 1, 2, unpack_odd_bytes, NULL},
    {PLACIDO_PIXEL_YUYV, 8, 8, 1, 2, unpack_even_bytes, NULL},
};

static const struct layout *layout_of(const placido_pixel_format *format) {
  for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
    if (layouts[i].packing == format->packing && layouts[i].bits_min <= format->bits &&
        format->bits <= layouts[i].bits_max) {
      return &layouts[i];
    }
  }
  return NULL;
}

static void unpack_row(uint8_t *out, const struct layout *layout,
                       const placido_pixel_format *format, const uint8_t *row, int width_px) {
  const size_t sample_bytes = format->bits > 8 ? 2 : 1;
  const size_t groups = (size_t)width_px / layout->group_px;
  const size_t rest_px = (size_t)width_px % layout->group_px;
  layout->unpack(out, row, groups, format->bits);
  if (rest_px > 0) {
    uint8_t group[GROUP_BYTES_MAX] = {0};
    uint16_t samples[GROUP_PX_MAX] = {0};
    const size_t done_bytes = groups * layout->group_bytes;
    memcpy(group, row + done_bytes, placido_pixel_row_bytes(format, width_px) - done_bytes);
    layout->unpack(samples, group, 1, format->bits);
    memcpy(out + groups * layout->group_px * sample_bytes, samples, rest_px * sample_bytes);
  }
}

int placido_pixel_to_frame(placido_frame *frame, const placido_pixel_format *format,
                           const uint8_t *samples, size_t size, int width_px, int height_px,
                           size_t row_bytes, placido_error *err) {
  const struct layout *layout = layout_of(format);
  if (!layout) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "pictures of pixel format %s of %d bits",
                             format->name, format->bits);
  }
  const int status = placido_frame_resize(frame, width_px, height_px,
                                          format->bits > 8 ? PLACIDO_MONO16 : PLACIDO_MONO8, err);
  if (status) {
    return status;
  }
  const size_t needed = placido_pixel_row_bytes(format, width_px);
  if (row_bytes < needed || size < needed ||
      (size - needed) / row_bytes < (size_t)height_px - 1) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%zu bytes in rows of %zu are too few for %d x %d pixels of %s", size,
                             row_bytes, width_px, height_px, format->name);
  }
  frame->bits = format->bits;
  for (int y = 0; y < height_px; y++) {
    unpack_row(frame->data + (size_t)y * frame->stride_bytes, layout, format,
               samples + (size_t)y * row_bytes, width_px);
  }
  return PLACIDO_OK;
}

/* Up to CHUNK_PX samples of a frame's row from x on, scaled to `bits`. Returns how many. */
static size_t scale_chunk(uint16_t samples[CHUNK_PX], const placido_frame *frame,
                          const uint8_t *row, size_t x, int bits) {
  const size_t left_px = (size_t)frame->width_px - x;
  const size_t count = left_px < CHUNK_PX ? left_px : CHUNK_PX;
  if (frame->format == PLACIDO_MONO16) {
    memcpy(samples, row + 2 * x, 2 * count);
  } else {
    for (size_t i = 0; i < count; i++) {
      samples[i] = row[x + i];
    }
  }
  const int up = bits > frame->bits ? bits - frame->bits : 0;
  const int down = frame->bits > bits ? frame->bits - bits : 0;
  const unsigned mask = (1u << bits) - 1;
  for (size_t i = 0; i < count; i++) {
    samples[i] = (uint16_t)((unsigned)samples[i] << up >> down & mask);
  }
  memset(samples + count, 0, (CHUNK_PX - count) * sizeof *samples);
  return count;
}

static void pack_row(uint8_t *out, const struct layout *layout, const placido_pixel_format *format,
                     const placido_frame *frame, const uint8_t *row) {
  size_t left_bytes = placido_pixel_row_bytes(format, frame->width_px);
  for (size_t x = 0; x < (size_t)frame->width_px; x += CHUNK_PX) {
    uint16_t samples[CHUNK_PX];
    uint8_t bytes[CHUNK_PX * 2];
    const size_t count = scale_chunk(samples, frame, row, x, format->bits);
    const size_t groups = (count + layout->group_px - 1) / layout->group_px;
    const size_t packed = groups * layout->group_bytes;
    const size_t used = packed < left_bytes ? packed : left_bytes;
    layout->pack(bytes, samples, groups, format->bits);
    memcpy(out, bytes, used);
    out += used;
    left_bytes -= used;
  }
}

int placido_pixel_from_frame(uint8_t *samples, const placido_pixel_format *format,
                             const placido_frame *frame, placido_error *err) {
  const struct layout *layout = layout_of(format);
  if (!layout || !layout->pack || format->is_bayer || frame->format == PLACIDO_RGB8) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "a %s picture cannot be made a picture of pixel format %s",
                             frame->format == PLACIDO_RGB8 ? "colour" : "grey", format->name);
  }
  const size_t row_bytes = placido_pixel_row_bytes(format, frame->width_px);
  const bool is_same = format->bits == 8 && frame->format == PLACIDO_MONO8;
  for (int y = 0; y < frame->height_px; y++) {
    const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    uint8_t *out = samples + (size_t)y * row_bytes;
    if (is_same) {
      memcpy(out, row, row_bytes);
    } else {
      pack_row(out, layout, format, frame, row);
    }
  }
  return PLACIDO_OK;
}
