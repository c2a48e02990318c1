/* Whether a Matroska file has its end: the lengths of its two outermost elements (RFC 8794,
 * sections 4 to 6). */
#include "base/session/matroska.h"

#include "base/text.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define ID_HEADER 0x1a45dfa3u
#define ID_SEGMENT 0x18538067u

/* An element's length: the leading byte's highest set bit tells how many bytes it has; all other
 * bits set mean "unknown". */
static bool read_length(FILE *stream, uint64_t *length, bool *known) {
  int first = fgetc(stream);
  if (first <= 0) {
    return false;
  }
  int bytes = 1;
  while (!(first & (0x80 >> (bytes - 1)))) {
    bytes++;
  }
  *length = (uint64_t)first & (0xffu >> bytes);
  for (int i = 1; i < bytes; i++) {
    int next = fgetc(stream);
    if (next == EOF) {
      return false;
    }
    *length = *length << 8 | (uint64_t)next;
  }
  *known = *length != ((uint64_t)1 << (7 * bytes)) - 1;
  return true;
}

static bool read_element(FILE *stream, uint32_t id, uint64_t *length, bool *known) {
  uint32_t found = 0;
  for (int i = 0; i < 4; i++) {
    found = found << 8 | ((uint32_t)fgetc(stream) & 0xffu);
  }
  return found == id && read_length(stream, length, known);
}

int placido_matroska_check_end(bool *finished, const char *path, placido_error *err) {
  *finished = false;
  FILE *stream = fopen(path, "rb");
  struct stat found;
  if (!stream || fstat(fileno(stream), &found) != 0) {
    int cause = errno;
    if (stream) {
      fclose(stream);
    }
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot read %s: %s", placido_text_tail(path),
                             strerror(cause));
  }
  uint64_t length;
  bool known;
  bool valid = read_element(stream, ID_HEADER, &length, &known) && known &&
               length < (uint64_t)found.st_size &&
               fseek(stream, (long)length, SEEK_CUR) == 0 &&
               read_element(stream, ID_SEGMENT, &length, &known);
  if (valid) {
    *finished = known && length <= (uint64_t)found.st_size - (uint64_t)ftell(stream);
  }
  fclose(stream);
  if (!valid) {
    return placido_error_set(err, PLACIDO_INPUT, "%s is not a Matroska file, or torn at its start",
                             placido_text_tail(path));
  }
  return PLACIDO_OK;
}
