/* What of an image file can be told without decoding it: its kind, and whether its end is there.
 * PNG: ISO/IEC 15948; JPEG: ITU-T T.81 annex B; TIFF 6.0; PNM: netpbm's pgm(5), ppm(5). */
#include "base/image_check.h"

#include "base/text.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

#define SIDE_MAX_PX 65536
#define PIXELS_MAX ((uint64_t)1 << 28) /* a few bytes must not ask for gigabytes */
/* Deflate makes at most a thousand bytes of one (258 of two bits), which are 8 pixels each at most:
 * 8256. */
#define PIXELS_PER_BYTE 10000u

static int refuse(const char *name, const char *reason, placido_error *err) {
  return placido_error_set(err, PLACIDO_INPUT, "%s: %s", placido_text_tail(name), reason);
}

/* Whether an image of this size may be decoded from a file of so many bytes. */
static int check_size(uint64_t width, uint64_t height, size_t size, const char *name,
                      placido_error *err) {
  if (width < 1 || height < 1) {
    return refuse(name, "the image has a width or height of 0", err);
  }
  if (width > SIDE_MAX_PX || height > SIDE_MAX_PX) {
    return refuse(name, "the image is wider or higher than 65536 pixels", err);
  }
  if (width * height > PIXELS_MAX) {
    return refuse(name, "the image has more than 268,435,456 pixels", err);
  }
  return width * height / PIXELS_PER_BYTE > size
             ? refuse(name, "the image has more pixels than its few bytes can hold", err)
             : PLACIDO_OK;
}

static uint32_t big_endian(const unsigned char *p) {
  return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* The table of PNG's checksum, ISO/IEC 15948 annex D. */
static void fill_crc_table(uint32_t table[256]) {
  for (uint32_t n = 0; n < 256; n++) {
    uint32_t c = n;
    for (int bit = 0; bit < 8; bit++) {
      c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    }
    table[n] = c;
  }
}

static uint32_t crc(const uint32_t table[256], const unsigned char *bytes, size_t size) {
  uint32_t c = 0xffffffffu;
  for (size_t i = 0; i < size; i++) {
    c = table[(c ^ bytes[i]) & 0xff] ^ (c >> 8);
  }
  return c ^ 0xffffffffu;
}

/* Walks the chunks: each whole, its checksum right, the last one IEND. */
static int check_png(placido_image_kind *kind, const unsigned char *bytes, size_t size,
                     const char *name, placido_error *err) {
  const size_t header = 8, frame = 12; /* the signature; length, type and checksum of a chunk */
  if (size < header + frame + 13 || memcmp(bytes + header + 4, "IHDR", 4) != 0) {
    return refuse(name, "the PNG file has no header", err);
  }
  const int status = check_size(big_endian(bytes + 16), big_endian(bytes + 20), size, name, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const unsigned char alpha_bit = 4, palette = 3;
  kind->alpha = (bytes[25] & alpha_bit) || bytes[25] == palette;
  uint32_t table[256];
  fill_crc_table(table);
  for (size_t at = header; size - at >= frame;) {
    size_t length = big_endian(bytes + at);
    if (length > size - at - frame) {
      break;
    }
    const unsigned char *type = bytes + at + 4;
    if (crc(table, type, length + 4) != big_endian(type + 4 + length)) {
      return refuse(name, "the PNG file is damaged (a checksum is wrong)", err);
    }
    if (memcmp(type, "IEND", 4) == 0) {
      return PLACIDO_OK;
    }
    at += length + frame;
  }
  return refuse(name, "the PNG file is cut off", err);
}

/* Whether a JPEG segment is a frame's header: SOF0 to SOF15 but for DHT, JPG and DAC. */
static bool is_frame_header(unsigned char marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/* The segments up to the first scan (a thumbnail with its own end may be among them), and behind it
 * the end of the image. Within a scan, 0xff is never followed by 0xd9. */
static int check_jpeg(placido_image_kind *kind, const unsigned char *bytes, size_t size,
                      const char *name, placido_error *err) {
  (void)kind;
  const unsigned char scan = 0xda, end = 0xd9;
  size_t at = 2;
  while (size - at >= 4 && bytes[at] == 0xff && bytes[at + 1] != scan) {
    size_t length = (size_t)bytes[at + 2] << 8 | bytes[at + 3];
    size_t step = bytes[at + 1] == 0xff ? 1 : length + 2; /* 0xff may be repeated as a filler */
    if (step > size - at) {
      break;
    }
    if (step >= 9 && is_frame_header(bytes[at + 1])) {
      const uint32_t sides = big_endian(bytes + at + 5); /* lines, then samples a line */
      const int status = check_size(sides & 0xffff, sides >> 16, size, name, err);
      if (status != PLACIDO_OK) {
        return status;
      }
    }
    at += step;
  }
  if (size - at >= 4 && bytes[at] == 0xff && bytes[at + 1] == scan) {
    for (; at + 1 < size; at++) {
      if (bytes[at] == 0xff && bytes[at + 1] == end) {
        return PLACIDO_OK;
      }
    }
  }
  return refuse(name, "the JPEG file is cut off or damaged", err);
}

/* A TIFF file's first directory, in the layout of TIFF 6.0 or in that of BigTIFF, whose numbers are
 * wider. */
typedef struct tiff {
  const unsigned char *bytes;
  size_t size, entries, entry_count; /* where the entries begin, and how many there are */
  bool little, big;
} tiff;

static uint64_t tiff_number(const tiff *t, size_t at, size_t width) {
  uint64_t number = 0;
  for (size_t i = 0; i < width; i++) {
    number = number << 8 | t->bytes[at + (t->little ? width - 1 - i : i)];
  }
  return number;
}

/* False where the directory is not wholly within the file. The offset of the next one is part of
 * it. */
static bool tiff_open(tiff *t, const unsigned char *bytes, size_t size) {
  *t = (tiff){.bytes = bytes, .size = size, .little = bytes[0] == 'I'};
  t->big = bytes[t->little ? 2 : 3] == 43;
  const size_t head = t->big ? 16 : 8, offset_bytes = t->big ? 8 : 4, count_bytes = t->big ? 8 : 2;
  if (size < head) {
    return false;
  }
  uint64_t directory = tiff_number(t, head - offset_bytes, offset_bytes);
  if (directory > size || size - directory < count_bytes + offset_bytes) {
    return false;
  }
  t->entries = (size_t)directory + count_bytes;
  uint64_t count = tiff_number(t, (size_t)directory, count_bytes);
  t->entry_count = (size_t)count;
  return count <= (size - t->entries - offset_bytes) / (t->big ? 20 : 12);
}

/* The numbers of a tag: how many, where, and how wide each is. None where the tag is not there, or
 * its values are no whole numbers. False where they are not within the file. */
typedef struct tiff_values {
  size_t at, width;
  uint64_t count;
} tiff_values;

static bool tiff_find(tiff_values *values, const tiff *t, unsigned tag) {
  static const unsigned char widths[] = {[3] = 2, [4] = 4, [13] = 4, [16] = 8}; /* by type */
  const size_t entry_bytes = t->big ? 20 : 12, word = t->big ? 8 : 4;
  *values = (tiff_values){0};
  for (size_t i = 0; i < t->entry_count; i++) {
    size_t at = t->entries + i * entry_bytes, type = (size_t)tiff_number(t, at + 2, 2);
    if (tiff_number(t, at, 2) != tag || type >= sizeof widths || widths[type] == 0) {
      continue;
    }
    uint64_t count = tiff_number(t, at + 4, word), first = at + 4 + word;
    if (count > word / widths[type]) {
      first = tiff_number(t, at + 4 + word, word);
      if (first > t->size || count > (t->size - first) / widths[type]) {
        return false;
      }
    }
    *values = (tiff_values){.at = (size_t)first, .width = widths[type], .count = count};
    return true;
  }
  return true;
}

/* The tag's first number; `otherwise` where it has none. */
static uint64_t tiff_first(const tiff *t, unsigned tag, uint64_t otherwise) {
  tiff_values values;
  return tiff_find(&values, t, tag) && values.count > 0 ? tiff_number(t, values.at, values.width)
                                                        : otherwise;
}

/* Whether all strips, or tiles, end within the file. */
static bool tiff_whole(const tiff *t, unsigned offset_tag, unsigned bytes_tag) {
  tiff_values offsets, counts;
  if (!tiff_find(&offsets, t, offset_tag) || !tiff_find(&counts, t, bytes_tag)) {
    return false;
  }
  for (uint64_t i = 0; i < offsets.count && i < counts.count; i++) {
    uint64_t at = tiff_number(t, offsets.at + (size_t)i * offsets.width, offsets.width);
    uint64_t length = tiff_number(t, counts.at + (size_t)i * counts.width, counts.width);
    if (at > t->size || length > t->size - at) {
      return false;
    }
  }
  return true;
}

static int check_tiff(placido_image_kind *kind, const unsigned char *bytes, size_t size,
                      const char *name, placido_error *err) {
  const unsigned width = 256, height = 257, strip_offsets = 273, strip_bytes = 279,
                 tile_offsets = 324, tile_bytes = 325, extra_samples = 338, associated = 1;
  tiff t;
  kind->keeps_own_orientation = true;
  if (!tiff_open(&t, bytes, size) || !tiff_whole(&t, strip_offsets, strip_bytes) ||
      !tiff_whole(&t, tile_offsets, tile_bytes)) {
    return refuse(name, "the TIFF file is cut off", err);
  }
  kind->multiplied = tiff_first(&t, extra_samples, 0) == associated;
  return check_size(tiff_first(&t, width, 0), tiff_first(&t, height, 0), size, name, err);
}

/* The next number of a PNM header, -1 where there is none; # opens a comment. */
static long pnm_number(const unsigned char *bytes, size_t size, size_t *at) {
  while (*at < size && (isspace(bytes[*at]) || bytes[*at] == '#')) {
    if (bytes[*at] == '#') {
      while (*at < size && bytes[*at] != '\n') {
        ++*at;
      }
    } else {
      ++*at;
    }
  }
  long number = -1;
  for (; *at < size && isdigit(bytes[*at]) && number < 10000000; ++*at) {
    number = (number < 0 ? 0 : number * 10) + (bytes[*at] - '0');
  }
  return number;
}

static int check_pnm(placido_image_kind *kind, const unsigned char *bytes, size_t size,
                     const char *name, placido_error *err) {
  bool bitmap = bytes[1] == '1' || bytes[1] == '4', colour = bytes[1] == '3' || bytes[1] == '6';
  size_t at = 2;
  long width = pnm_number(bytes, size, &at), height = pnm_number(bytes, size, &at);
  long white = bitmap ? 1 : pnm_number(bytes, size, &at);
  if (width < 1 || height < 1 || width > SIDE_MAX_PX || height > SIDE_MAX_PX || white < 1 ||
      white > 65535) {
    return refuse(name, "the PNM file's header makes no sense", err);
  }
  bool text = bytes[1] <= '3';
  size_t row = bitmap ? ((size_t)width + 7) / 8
                      : (size_t)width * (colour ? 3 : 1) * (white > 255 ? 2 : 1);
  if (!text && size - at < 1 + row * (size_t)height) {
    return refuse(name, "the PNM file is cut off", err);
  }
  kind->full_scale = bitmap ? 0 : (int)white;
  return check_size((uint64_t)width, (uint64_t)height, size, name, err);
}

int placido_image_check(placido_image_kind *kind, const unsigned char *bytes, size_t size,
                        const char *name, placido_error *err) {
  static const struct {
    const char *magic;
    size_t length;
    int (*check)(placido_image_kind *, const unsigned char *, size_t, const char *,
                 placido_error *);
  } kinds[] = {
      {"\x89PNG\r\n\x1a\n", 8, check_png}, {"\xff\xd8\xff", 3, check_jpeg},
      {"II*\0", 4, check_tiff},            {"MM\0*", 4, check_tiff},
      {"II+\0", 4, check_tiff},            {"MM\0+", 4, check_tiff},
      {"P1", 2, check_pnm},                {"P2", 2, check_pnm},
      {"P3", 2, check_pnm},                {"P4", 2, check_pnm},
      {"P5", 2, check_pnm},                {"P6", 2, check_pnm},
  };
  *kind = (placido_image_kind){0};
  if (size == 0) {
    return refuse(name, "the file is empty, an image is expected", err);
  }
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    if (size >= kinds[i].length && memcmp(bytes, kinds[i].magic, kinds[i].length) == 0) {
      return kinds[i].check(kind, bytes, size, name, err);
    }
  }
  return refuse(name, "not an image (PNG, TIFF, PGM, PPM and JPEG are read)", err);
}
