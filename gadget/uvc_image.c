/* The view as the mode wants it: cut or binned, eight bits, by the exposure, grey or YUY2. */
#include "gadget/uvc_image.h"

#include <string.h>

/* Rows of the view become rows of eight bits, `width_px` of them from column `x` on; binned ones
 * are the mean of two pixels in two rows. */
static void cut_bytes(uint8_t *row, const placido_frame *seen, int x, int y, int width_px) {
  memcpy(row, seen->data + (size_t)y * seen->stride_bytes + x, (size_t)width_px);
}

static const uint16_t *words_at(const placido_frame *seen, int x, int y) {
  return (const uint16_t *)(const void *)(seen->data + (size_t)y * seen->stride_bytes) + x;
}

static void cut_words(uint8_t *row, const placido_frame *seen, int x, int y, int width_px) {
  const uint16_t *from = words_at(seen, x, y);
  for (int i = 0; i < width_px; i++) {
    row[i] = (uint8_t)(from[i] >> (seen->bits - 8));
  }
}

static void bin_bytes(uint8_t *row, const placido_frame *seen, int x, int y, int width_px) {
  const uint8_t *upper = seen->data + (size_t)y * seen->stride_bytes + x;
  const uint8_t *lower = upper + seen->stride_bytes;
  for (int i = 0; i < width_px; i++) {
    row[i] = (uint8_t)((upper[2 * i] + upper[2 * i + 1] + lower[2 * i] + lower[2 * i + 1] + 2) / 4);
  }
}

static void bin_words(uint8_t *row, const placido_frame *seen, int x, int y, int width_px) {
  const uint16_t *upper = words_at(seen, x, y), *lower = words_at(seen, x, y + 1);
  for (int i = 0; i < width_px; i++) {
    const int sum = upper[2 * i] + upper[2 * i + 1] + lower[2 * i] + lower[2 * i + 1];
    row[i] = (uint8_t)(sum / 4 >> (seen->bits - 8));
  }
}

/* Spreads samples that lie in the second half of the row over the whole: in place, as no byte is
 * written before it was read. */
static void spread(uint8_t *row, int width_px) {
  for (int i = 0; i < width_px; i++) {
    row[2 * i] = row[width_px + i];
    row[2 * i + 1] = 128;
  }
}

void placido_uvc_image_make(uint8_t *image, const placido_frame *seen,
                            const placido_uvc_size *size, enum placido_uvc_format format,
                            const uint8_t levels[256]) {
  void (*const ways[2][2])(uint8_t *, const placido_frame *, int, int, int) = {
      {cut_bytes, bin_bytes}, {cut_words, bin_words}};
  void (*const take)(uint8_t *, const placido_frame *, int, int, int) =
      ways[seen->format == PLACIDO_MONO16][size->is_binned];
  const int step = size->is_binned ? 2 : 1, width_px = size->width_px;
  const int x = (seen->width_px - width_px * step) / 2;
  const int y = (seen->height_px - size->height_px * step) / 2;
  const size_t row_bytes = (size_t)width_px * (format == PLACIDO_UVC_YUY2 ? 2 : 1);
  for (int i = 0; i < size->height_px; i++) {
    uint8_t *row = image + (size_t)i * row_bytes;
    uint8_t *samples = row + row_bytes - (size_t)width_px;
    take(samples, seen, x, y + i * step, width_px);
    for (int j = 0; levels && j < width_px; j++) {
      samples[j] = levels[samples[j]];
    }
    if (format == PLACIDO_UVC_YUY2) {
      spread(row, width_px);
    }
  }
}

void placido_uvc_levels_make(uint8_t levels[256], int exposure, int gain, int brightness) {
  for (int i = 0; i < 256; i++) {
    const int64_t level = ((int64_t)i * exposure * gain + 800) / 1600 + brightness;
    levels[i] = (uint8_t)(level < 0 ? 0 : level > 255 ? 255 : level);
  }
}
