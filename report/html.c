/* Pieces of HTML that are safe whatever stands in the strings. */
#include "report/html.h"

#include "base/file.h"
#include "base/memory.h"

#include <stdarg.h>
#include <stdint.h>
#include <string.h>

/* A form of UTF-8 characters (RFC 3629): the ranges of the first and the second byte. */
typedef struct form {
  unsigned char low, high, second_low, second_high;
  size_t length;
} form;

/* How many bytes the UTF-8 character at `at` has; 0 where it is none. */
static size_t character_length(const unsigned char *at) {
  static const form forms[] = {
      {0x00, 0x7f, 0x00, 0x00, 1}, {0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
      {0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3}, {0xee, 0xef, 0x80, 0xbf, 3},
      {0xf0, 0xf0, 0x90, 0xbf, 4}, {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4},
  };
  size_t i = 0, count = sizeof forms / sizeof forms[0];
  while (i < count && (at[0] < forms[i].low || at[0] > forms[i].high)) {
    i++;
  }
  if (i == count) {
    return 0;
  }
  if (forms[i].length > 1 && (at[1] < forms[i].second_low || at[1] > forms[i].second_high)) {
    return 0;
  }
  for (size_t k = 2; k < forms[i].length; k++) {
    if (at[k] < 0x80 || at[k] > 0xbf) {
      return 0;
    }
  }
  return forms[i].length;
}

/* What stands for an ASCII character that HTML would take for its own; NULL where it may stay. */
static const char *reference_of(unsigned char character) {
  static const char special[] = "&<>\"'";
  static const char *const references[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
  if (character < 0x20 || character == 0x7f) {
    return " ";
  }
  const char *found = strchr(special, character);
  return found != NULL ? references[found - special] : NULL;
}

void placido_html_text(FILE *stream, const char *text) {
  const unsigned char *at = (const unsigned char *)(text != NULL ? text : "");
  while (*at != '\0') {
    size_t length = character_length(at);
    const char *reference = length == 1 ? reference_of(*at) : NULL;
    if (length == 0) {
      fputs("\xef\xbf\xbd", stream); /* U+FFFD */
      length = 1;
    } else if (reference != NULL) {
      fputs(reference, stream);
    } else {
      fwrite(at, 1, length, stream);
    }
    at += length;
  }
}

void placido_html_print(FILE *stream, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  placido_html_text(stream, text);
}

/* RFC 4648, section 4. */
static void write_base64(FILE *stream, const unsigned char *bytes, size_t size) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char out[4096];
  size_t filled = 0;
  for (size_t k = 0; k < size; k += 3) {
    size_t left = size - k;
    uint32_t word = (uint32_t)bytes[k] << 16 | (left > 1 ? (uint32_t)bytes[k + 1] << 8 : 0) |
                    (left > 2 ? bytes[k + 2] : 0);
    out[filled++] = digits[word >> 18];
    out[filled++] = digits[word >> 12 & 63];
    out[filled++] = left > 1 ? digits[word >> 6 & 63] : '=';
    out[filled++] = left > 2 ? digits[word & 63] : '=';
    if (filled == sizeof out) {
      fwrite(out, 1, filled, stream);
      filled = 0;
    }
  }
  fwrite(out, 1, filled, stream);
}

static int big_endian(const unsigned char *at) {
  return (int)((uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3]);
}

/* Width and height stand at fixed places of every PNG file (ISO/IEC 15948, 11.2.2). */
static int read_size(placido_html_size *size, const unsigned char *bytes, size_t count,
                     const char *path, placido_error *err) {
  static const unsigned char signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (count < 33 || memcmp(bytes, signature, sizeof signature) != 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: not a PNG picture", path);
  }
  *size = (placido_html_size){big_endian(bytes + 16), big_endian(bytes + 20)};
  return PLACIDO_OK;
}

int placido_html_picture(FILE *stream, placido_html_size *size, const char *folder,
                         const char *name, const char *alternative, placido_error *err) {
  char path[PLACIDO_PATH_MAX], *bytes = NULL;
  size_t count = 0;
  placido_html_size found = {0, 0};
  int status = placido_path_join(path, folder, name, err);
  if (status == PLACIDO_OK) {
    status = placido_file_read(&bytes, &count, path, 0, err);
  }
  if (status == PLACIDO_OK) {
    status = read_size(&found, (const unsigned char *)bytes, count, path, err);
  }
  if (status == PLACIDO_OK) {
    fprintf(stream, "<img width=\"%d\" height=\"%d\" alt=\"", found.width_px, found.height_px);
    placido_html_text(stream, alternative);
    fputs("\" src=\"data:image/png;base64,", stream);
    write_base64(stream, (const unsigned char *)bytes, count);
    fputs("\">\n", stream);
  }
  placido_memory_free(bytes);
  if (size != NULL) {
    *size = found;
  }
  return status;
}

void placido_html_row(FILE *stream, const char *heading, const char *value) {
  if (value == NULL || *value == '\0') {
    return;
  }
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, heading);
  fputs("</th><td>", stream);
  placido_html_text(stream, value);
  fputs("</td></tr>\n", stream);
}
