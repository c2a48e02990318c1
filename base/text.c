/* Text that goes to a person as one line: no control characters, no half characters. */
#include "base/text.h"

#include <stdbool.h>
#include <string.h>

/* A message has room for 512 bytes; the file's name may take less than half of them. */
#define SHOWN_BYTES 200

/* How many bytes the UTF-8 character that opens with `lead` has. */
static size_t utf8_bytes(unsigned char lead) {
  if (lead >= 0xf0) {
    return 4;
  }
  if (lead >= 0xe0) {
    return 3;
  }
  return lead >= 0xc0 ? 2 : 1;
}

/* False where the last character is a whole one. */
static bool cut_half_character(char *text) {
  size_t length = strlen(text), start = length;
  while (start > 0 && ((unsigned char)text[start - 1] & 0xc0) == 0x80) {
    start--;
  }
  const bool half = start > 0 && utf8_bytes((unsigned char)text[start - 1]) > length - start + 1;
  if (half) {
    text[start - 1] = '\0';
  }
  return half;
}

void placido_text_line(char *text) {
  while (cut_half_character(text)) { /* of bytes that are no UTF-8 there may be several */
  }
  for (char *c = text; *c; c++) {
    unsigned char byte = (unsigned char)*c;
    if (byte < 0x20 || byte == 0x7f) {
      *c = ' ';
    } else if (byte == 0xc2 && (unsigned char)c[1] >= 0x80 && (unsigned char)c[1] < 0xa0) {
      c[0] = c[1] = ' '; /* U+0080 to U+009F: control characters too */
    }
  }
}

void placido_text_quote(FILE *stream, const char *text) {
  fputc('"', stream);
  for (; *text; text++) {
    if (*text == '"') {
      fputc('"', stream);
    }
    fputc((unsigned char)*text < ' ' ? ' ' : *text, stream);
  }
  fputc('"', stream);
}

const char *placido_text_tail(const char *path) {
  size_t length = strlen(path);
  if (length <= SHOWN_BYTES) {
    return path;
  }
  const char *tail = path + length - SHOWN_BYTES;
  while (((unsigned char)*tail & 0xc0) == 0x80) {
    tail++;
  }
  return tail;
}
