/* From a camera's bytes to grey samples: one row of the table for each pixel format.
 *
 * Layouts after the kernel's documentation, "Image Formats" of the Video for Linux API:
 * Y10P and Y12P are MIPI CSI-2 RAW10 and RAW12, Y10B is a bit stream with the highest bit first. */
#include "drivers/v4l2/convert.h"

#include "base/memory.h"

#include <linux/videodev2.h>
#include <string.h>
#include <strings.h>

/* Younger than the oldest kernel headers that are built with. */
#define FOURCC_Y12P v4l2_fourcc('Y', '1', '2', 'P')

static void unpack_bytes(uint16_t *samples, const uint8_t *row, int width_px) {
  for (int x = 0; x < width_px; x++) {
    samples[x] = row[x];
  }
}

static void unpack_even_bytes(uint16_t *samples, const uint8_t *row, int width_px) {
  for (int x = 0; x < width_px; x++) {
    samples[x] = row[2 * x];
  }
}

static void unpack_odd_bytes(uint16_t *samples, const uint8_t *row, int width_px) {
  for (int x = 0; x < width_px; x++) {
    samples[x] = row[2 * x + 1];
  }
}

/* Little-endian words; bits above the format's are a driver's padding, not light. */
static void unpack_words(uint16_t *samples, const uint8_t *row, int width_px, unsigned mask) {
  for (int x = 0; x < width_px; x++) {
    samples[x] = (uint16_t)((row[2 * x] | (unsigned)row[2 * x + 1] << 8) & mask);
  }
}

static void unpack_words_10(uint16_t *samples, const uint8_t *row, int width_px) {
  unpack_words(samples, row, width_px, 0x3ff);
}

static void unpack_words_12(uint16_t *samples, const uint8_t *row, int width_px) {
  unpack_words(samples, row, width_px, 0xfff);
}

static void unpack_words_16(uint16_t *samples, const uint8_t *row, int width_px) {
  unpack_words(samples, row, width_px, 0xffff);
}

static void unpack_big_words(uint16_t *samples, const uint8_t *row, int width_px) {
  for (int x = 0; x < width_px; x++) {
    samples[x] = (uint16_t)((unsigned)row[2 * x] << 8 | row[2 * x + 1]);
  }
}

/* Four pixels in five bytes: the upper eight bits of each, then the lower two of all, the first
 * pixel's lowest. */
static void unpack_mipi_10(uint16_t *samples, const uint8_t *row, int width_px) {
  for (int x = 0; x < width_px; x++) {
    const uint8_t *group = row + x / 4 * 5;
    samples[x] = (uint16_t)((unsigned)group[x % 4] << 2 | (group[4] >> x % 4 * 2 & 3));
  }
}

/* Two pixels in three bytes: the upper eight bits of each, then the lower four of both. */
static void unpack_mipi_12(uint16_t *samples, const uint8_t *row, int width_px) {
  for (int x = 0; x < width_px; x++) {
    const uint8_t *group = row + x / 2 * 3;
    samples[x] = (uint16_t)((unsigned)group[x % 2] << 4 | (group[2] >> x % 2 * 4 & 15));
  }
}

/* Four pixels in five bytes, one after another, the highest bit first. */
static void unpack_stream_10(uint16_t *samples, const uint8_t *row, int width_px) {
  for (int x = 0; x < width_px; x++) {
    const uint8_t *pair = row + x / 4 * 5 + x % 4;
    samples[x] = (uint16_t)(((unsigned)pair[0] << 8 | pair[1]) >> (6 - x % 4 * 2) & 0x3ff);
  }
}

#define BAYER(order, fourcc, depth, px, in_bits, function)                               \
  {fourcc, "S" order #depth, depth, px, in_bits, true, function}
#define BAYER_PACKED(order, fourcc, depth, px, in_bits, function)                        \
  {fourcc, "S" order #depth "P", depth, px, in_bits, true, function}

static const placido_v4l2_format formats[] = {
    {V4L2_PIX_FMT_GREY, "GREY", 8, 1, 8, false, unpack_bytes},
    {V4L2_PIX_FMT_Y16, "Y16", 16, 1, 16, false, unpack_words_16},
    {V4L2_PIX_FMT_Y16_BE, "Y16_BE", 16, 1, 16, false, unpack_big_words},
    {V4L2_PIX_FMT_Y12, "Y12", 12, 1, 16, false, unpack_words_12},
    {V4L2_PIX_FMT_Y10, "Y10", 10, 1, 16, false, unpack_words_10},
    {FOURCC_Y12P, "Y12P", 12, 2, 24, false, unpack_mipi_12},
    {V4L2_PIX_FMT_Y10P, "Y10P", 10, 4, 40, false, unpack_mipi_10},
    {V4L2_PIX_FMT_Y10BPACK, "Y10B", 10, 4, 40, false, unpack_stream_10},
    {V4L2_PIX_FMT_YUYV, "YUYV", 8, 2, 32, false, unpack_even_bytes},
    {V4L2_PIX_FMT_YVYU, "YVYU", 8, 2, 32, false, unpack_even_bytes},
    {V4L2_PIX_FMT_UYVY, "UYVY", 8, 2, 32, false, unpack_odd_bytes},
    {V4L2_PIX_FMT_VYUY, "VYUY", 8, 2, 32, false, unpack_odd_bytes},
    BAYER("RGGB", V4L2_PIX_FMT_SRGGB8, 8, 1, 8, unpack_bytes),
    BAYER("GRBG", V4L2_PIX_FMT_SGRBG8, 8, 1, 8, unpack_bytes),
    BAYER("GBRG", V4L2_PIX_FMT_SGBRG8, 8, 1, 8, unpack_bytes),
    BAYER("BGGR", V4L2_PIX_FMT_SBGGR8, 8, 1, 8, unpack_bytes),
    BAYER("RGGB", V4L2_PIX_FMT_SRGGB12, 12, 1, 16, unpack_words_12),
    BAYER("GRBG", V4L2_PIX_FMT_SGRBG12, 12, 1, 16, unpack_words_12),
    BAYER("GBRG", V4L2_PIX_FMT_SGBRG12, 12, 1, 16, unpack_words_12),
    BAYER("BGGR", V4L2_PIX_FMT_SBGGR12, 12, 1, 16, unpack_words_12),
    BAYER("RGGB", V4L2_PIX_FMT_SRGGB10, 10, 1, 16, unpack_words_10),
    BAYER("GRBG", V4L2_PIX_FMT_SGRBG10, 10, 1, 16, unpack_words_10),
    BAYER("GBRG", V4L2_PIX_FMT_SGBRG10, 10, 1, 16, unpack_words_10),
    BAYER("BGGR", V4L2_PIX_FMT_SBGGR10, 10, 1, 16, unpack_words_10),
    BAYER_PACKED("RGGB", V4L2_PIX_FMT_SRGGB12P, 12, 2, 24, unpack_mipi_12),
    BAYER_PACKED("GRBG", V4L2_PIX_FMT_SGRBG12P, 12, 2, 24, unpack_mipi_12),
    BAYER_PACKED("GBRG", V4L2_PIX_FMT_SGBRG12P, 12, 2, 24, unpack_mipi_12),
    BAYER_PACKED("BGGR", V4L2_PIX_FMT_SBGGR12P, 12, 2, 24, unpack_mipi_12),
    BAYER_PACKED("RGGB", V4L2_PIX_FMT_SRGGB10P, 10, 4, 40, unpack_mipi_10),
    BAYER_PACKED("GRBG", V4L2_PIX_FMT_SGRBG10P, 10, 4, 40, unpack_mipi_10),
    BAYER_PACKED("GBRG", V4L2_PIX_FMT_SGBRG10P, 10, 4, 40, unpack_mipi_10),
    BAYER_PACKED("BGGR", V4L2_PIX_FMT_SBGGR10P, 10, 4, 40, unpack_mipi_10),
    {V4L2_PIX_FMT_MJPEG, "MJPEG", 8, 0, 0, false, NULL},
    {V4L2_PIX_FMT_JPEG, "JPEG", 8, 0, 0, false, NULL},
};

#define FORMAT_COUNT (sizeof formats / sizeof *formats)

const placido_v4l2_format *placido_v4l2_formats(size_t *count) {
  *count = FORMAT_COUNT;
  return formats;
}

const placido_v4l2_format *placido_v4l2_format_of(uint32_t fourcc) {
  for (size_t i = 0; i < FORMAT_COUNT; i++) {
    if (formats[i].fourcc == fourcc) {
      return &formats[i];
    }
  }
  return NULL;
}

const placido_v4l2_format *placido_v4l2_format_named(const char *name) {
  for (size_t i = 0; i < FORMAT_COUNT; i++) {
    if (strcasecmp(formats[i].name, name) == 0) {
      return &formats[i];
    }
  }
  return NULL;
}

size_t placido_v4l2_row_bytes(const placido_v4l2_format *format, int width_px) {
  if (format->group_px == 0) {
    return 0;
  }
  size_t groups = ((size_t)width_px + (size_t)format->group_px - 1) / (size_t)format->group_px;
  return groups * (size_t)format->group_bits / 8;
}

/* One row of the frame from samples of the width of uint16_t. */
static void store_row(placido_frame *frame, int y, const uint16_t *samples) {
  uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
  if (frame->format == PLACIDO_MONO16) {
    memcpy(row, samples, (size_t)frame->width_px * sizeof *samples);
    return;
  }
  for (int x = 0; x < frame->width_px; x++) {
    row[x] = (uint8_t)samples[x];
  }
}

/* The camera's picture: what its bytes are, and how many rows of them are whole. */
struct source {
  const placido_v4l2_format *format;
  const uint8_t *bytes;
  size_t stride_bytes;
  int width_px, whole_rows;
};

static void load_row(uint16_t *samples, const struct source *source, int y) {
  if (y < source->whole_rows) {
    source->format->unpack(samples, source->bytes + (size_t)y * source->stride_bytes,
                           source->width_px);
  } else {
    memset(samples, 0, (size_t)source->width_px * sizeof *samples);
  }
}

/* -1 and n lie where 1 and n - 2 do: a mirror that keeps the order of the mosaic's colours. */
static int mirrored(int i, int n) {
  if (n == 1) {
    return 0;
  }
  return i < 0 ? -i : i >= n ? 2 * (n - 1) - i : i;
}

/* (1 2 1) along row y of the mosaic; `samples` is scratch. */
static void sum_along_row(uint16_t *sums, uint16_t *samples, const struct source *source, int y) {
  const int width = source->width_px;
  load_row(samples, source, y);
  for (int x = 0; x < width; x++) {
    const unsigned left = samples[mirrored(x - 1, width)], right = samples[mirrored(x + 1, width)];
    sums[x] = (uint16_t)(left + 2u * samples[x] + right);
  }
}

/* Luminance of a mosaic; `scratch` holds four rows: samples, and sums of three rows by turns. */
static void filter_mosaic(placido_frame *frame, const struct source *source, uint16_t *scratch) {
  const int width = frame->width_px, height = frame->height_px;
  uint16_t *samples = scratch;
#define SUMS(y) (scratch + (size_t)(1 + (y) % 3) * (size_t)width)
  sum_along_row(SUMS(0), samples, source, 0);
  for (int y = 0; y < height; y++) {
    if (y + 1 < height) {
      sum_along_row(SUMS(y + 1), samples, source, y + 1);
    }
    const uint16_t *above = SUMS(mirrored(y - 1, height)), *here = SUMS(y);
    const uint16_t *below = SUMS(mirrored(y + 1, height));
    for (int x = 0; x < width; x++) {
      samples[x] = (uint16_t)((above[x] + 2u * here[x] + below[x] + 8) >> 4);
    }
    store_row(frame, y, samples);
  }
#undef SUMS
}

/* Grey bytes are a frame's already: half of the work with a fast camera. */
static void copy_rows(placido_frame *frame, const struct source *source) {
  for (int y = 0; y < frame->height_px; y++) {
    uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    if (y < source->whole_rows) {
      memcpy(row, source->bytes + (size_t)y * source->stride_bytes, (size_t)frame->width_px);
    } else {
      memset(row, 0, (size_t)frame->width_px);
    }
  }
}

int placido_v4l2_convert(placido_frame *frame, const placido_v4l2_format *format, int width_px,
                         int height_px, const uint8_t *bytes, size_t size, size_t stride_bytes,
                         placido_error *err) {
  if (!format->unpack) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "%s pictures are compressed",
                             format->name);
  }
  int status = placido_frame_resize(frame, width_px, height_px,
                                    format->bits > 8 ? PLACIDO_MONO16 : PLACIDO_MONO8, err);
  if (status) {
    return status;
  }
  const size_t row_bytes = placido_v4l2_row_bytes(format, width_px);
  const size_t whole = size < row_bytes ? 0 : (size - row_bytes) / stride_bytes + 1;
  const bool is_whole = whole >= (size_t)height_px;
  const struct source source = {.format = format,
                                .bytes = bytes,
                                .stride_bytes = stride_bytes,
                                .width_px = width_px,
                                .whole_rows = is_whole ? height_px : (int)whole};
  frame->bits = format->bits;
  frame->flags = is_whole ? 0 : PLACIDO_FRAME_TRUNCATED;
  if (!format->is_mosaic && format->unpack == unpack_bytes) {
    copy_rows(frame, &source);
    return PLACIDO_OK;
  }
  uint16_t *scratch = placido_memory_new(4 * (size_t)width_px, sizeof *scratch, err);
  if (!scratch) {
    return PLACIDO_MEMORY;
  }
  if (format->is_mosaic) {
    filter_mosaic(frame, &source, scratch);
  }
  for (int y = 0; !format->is_mosaic && y < height_px; y++) {
    load_row(scratch, &source, y);
    store_row(frame, y, scratch);
  }
  placido_memory_free(scratch);
  return PLACIDO_OK;
}
