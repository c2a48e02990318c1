/* Text files of others: any line ending, a byte order mark, decimal commas. */
#include "exchange/text.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLANKS " \t\r\f\v"
#define NUMBER_MAX 64
#define FILE_MAX ((size_t)256 << 20)

int placido_reader_open(placido_reader *reader, const char *path, placido_error *err) {
  size_t size;
  *reader = (placido_reader){.path = path};
  int status = placido_file_read(&reader->text, &size, path, FILE_MAX, err);
  if (status) {
    return status;
  }
  if (memchr(reader->text, '\0', size)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s: is no text: a topographer's export or a CSV is expected",
                             placido_text_tail(path));
  }
  reader->end = reader->text + size;
  reader->next = reader->text + (strncmp(reader->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0);
  return PLACIDO_OK;
}

void placido_reader_close(placido_reader *reader) {
  placido_memory_free(reader->text);
  *reader = (placido_reader){0};
}

char *placido_text_trim(char *text) {
  text += strspn(text, BLANKS);
  size_t length = strlen(text);
  while (length > 0 && strchr(BLANKS, text[length - 1])) {
    length--;
  }
  text[length] = '\0';
  return text;
}

char *placido_reader_next(placido_reader *reader) {
  if (reader->next >= reader->end) {
    return NULL;
  }
  char *line = reader->next, *end = line + strcspn(line, "\n");
  reader->next = end + 1;
  *end = '\0'; /* behind the last line stands the file's own zero byte */
  reader->line++;
  return placido_text_trim(line);
}

int placido_reader_refuse(const placido_reader *reader, placido_error *err, const char *format,
                          ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return placido_error_set(err, PLACIDO_INPUT, "%s:%d: %s", placido_text_tail(reader->path),
                           reader->line, text);
}

bool placido_text_number(const char *text, bool comma, double *value) {
  char copy[NUMBER_MAX];
  size_t length = strlen(text);
  /* strtod alone would also take hexadecimal, "inf" and "nan" */
  if (length == 0 || length >= sizeof copy || text[strspn(text, "+-0123456789.,eE")] != '\0') {
    return false;
  }
  memcpy(copy, text, length + 1);
  char *mark = strchr(copy, ',');
  if (mark && (!comma || strchr(copy, '.'))) {
    return false;
  }
  if (mark) {
    *mark = '.';
  }
  char *end;
  *value = strtod(copy, &end);
  return end != copy && *end == '\0' && isfinite(*value);
}
