/* The table of pixel formats (EMVA GenICam Pixel Format Naming Convention: names and codes). */
#include "drivers/u3v/wire/pixel.h"

#include <string.h>
#include <strings.h>

/* A Bayer mosaic in the four orders of its colours. */
#define BAYER(ending, gr, rg, gb, bg, bits, bits_per_pixel, packing) \
  {gr, "BayerGR" ending, bits, bits_per_pixel, packing, true},       \
      {rg, "BayerRG" ending, bits, bits_per_pixel, packing, true},   \
      {gb, "BayerGB" ending, bits, bits_per_pixel, packing, true},   \
      {bg, "BayerBG" ending, bits, bits_per_pixel, packing, true}

/* Eight bits come first among the plain ones: mires are bright, and every camera has them. */
static const placido_pixel_format formats[] = {
    {0x01080001, "Mono8", 8, 8, PLACIDO_PIXEL_PLAIN, false},
    {0x01100007, "Mono16", 16, 16, PLACIDO_PIXEL_PLAIN, false},
    {0x01100025, "Mono14", 14, 16, PLACIDO_PIXEL_PLAIN, false},
    {0x01100005, "Mono12", 12, 16, PLACIDO_PIXEL_PLAIN, false},
    {0x01100003, "Mono10", 10, 16, PLACIDO_PIXEL_PLAIN, false},
    {0x010E0104, "Mono14p", 14, 14, PLACIDO_PIXEL_LSB, false},
    {0x010C0047, "Mono12p", 12, 12, PLACIDO_PIXEL_LSB, false},
    {0x010A0046, "Mono10p", 10, 10, PLACIDO_PIXEL_LSB, false},
    {0x010C0006, "Mono12Packed", 12, 12, PLACIDO_PIXEL_PACKED, false},
    {0x010C0004, "Mono10Packed", 10, 12, PLACIDO_PIXEL_PACKED, false},
    BAYER("8", 0x01080008, 0x01080009, 0x0108000A, 0x0108000B, 8, 8, PLACIDO_PIXEL_PLAIN),
    BAYER("16", 0x0110002E, 0x0110002F, 0x01100030, 0x01100031, 16, 16, PLACIDO_PIXEL_PLAIN),
    BAYER("12", 0x01100010, 0x01100011, 0x01100012, 0x01100013, 12, 16, PLACIDO_PIXEL_PLAIN),
    BAYER("10", 0x0110000C, 0x0110000D, 0x0110000E, 0x0110000F, 10, 16, PLACIDO_PIXEL_PLAIN),
    BAYER("12p", 0x010C0057, 0x010C0059, 0x010C0055, 0x010C0053, 12, 12, PLACIDO_PIXEL_LSB),
    BAYER("10p", 0x010A0056, 0x010A0058, 0x010A0054, 0x010A0052, 10, 10, PLACIDO_PIXEL_LSB),
    BAYER("12Packed", 0x010C002A, 0x010C002B, 0x010C002C, 0x010C002D, 12, 12,
          PLACIDO_PIXEL_PACKED),
    BAYER("10Packed", 0x010C0026, 0x010C0027, 0x010C0028, 0x010C0029, 10, 12,
          PLACIDO_PIXEL_PACKED),
    {0x0210001F, "YUV422_8_UYVY", 8, 16, PLACIDO_PIXEL_UYVY, false},
    {0x02100032, "YUV422_8", 8, 16, PLACIDO_PIXEL_YUYV, false},
    {0x02100043, "YCbCr422_8_CbYCrY", 8, 16, PLACIDO_PIXEL_UYVY, false},
    {0x0210003B, "YCbCr422_8", 8, 16, PLACIDO_PIXEL_YUYV, false},
    {0x02180014, "RGB8", 8, 24, PLACIDO_PIXEL_RGB, false},
    {0x02180015, "BGR8", 8, 24, PLACIDO_PIXEL_BGR, false},
};

#define FORMAT_COUNT (sizeof formats / sizeof *formats)

const placido_pixel_format *placido_pixel_table(size_t *count) {
  *count = FORMAT_COUNT;
  return formats;
}

const placido_pixel_format *placido_pixel_by_code(uint32_t code) {
  for (size_t i = 0; i < FORMAT_COUNT; i++) {
    if (formats[i].code == code) {
      return &formats[i];
    }
  }
  return NULL;
}

const placido_pixel_format *placido_pixel_by_name(const char *name) {
  for (size_t i = 0; i < FORMAT_COUNT; i++) {
    if (strcasecmp(formats[i].name, name) == 0) {
      return &formats[i];
    }
  }
  return NULL;
}

size_t placido_pixel_row_bytes(const placido_pixel_format *format, int width_px) {
  return width_px < 1 ? 0 : ((size_t)width_px * (size_t)format->bits_per_pixel + 7) / 8;
}

bool placido_pixel_is_plain(const placido_pixel_format *format) {
  const uint16_t one = 1;
  uint8_t first;
  memcpy(&first, &one, 1); /* samples of two bytes come with the low one first */
  return format->packing == PLACIDO_PIXEL_PLAIN && (format->bits_per_pixel == 8 || first == 1);
}
