/* A file of JSON lines that grows while a recording runs. */
#include "base/session/lines.h"

#include "base/text.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static int refuse(const placido_lines *lines, placido_error *err) {
  return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s",
                           placido_text_tail(lines->path), strerror(errno));
}

int placido_lines_create(placido_lines *lines, const char *folder, const char *name,
                         placido_error *err) {
  *lines = (placido_lines){0};
  int status = placido_path_join(lines->path, folder, name, err);
  if (status) {
    return status;
  }
  lines->stream = fopen(lines->path, "wb");
  return lines->stream ? PLACIDO_OK : refuse(lines, err);
}

int placido_lines_append(placido_lines *lines, json_t *object, placido_error *err) {
  if (!object) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: a text that is not UTF-8 cannot be written",
                             placido_text_tail(lines->path));
  }
  errno = 0;
  int dumped = json_dumpf(object, lines->stream, JSON_COMPACT | JSON_REAL_PRECISION(17));
  json_decref(object);
  if (dumped != 0 || fputc('\n', lines->stream) == EOF || fflush(lines->stream) != 0) {
    return refuse(lines, err);
  }
  return PLACIDO_OK;
}

int placido_lines_sync(placido_lines *lines, placido_error *err) {
  return fdatasync(fileno(lines->stream)) == 0 ? PLACIDO_OK : refuse(lines, err);
}

int placido_lines_close(placido_lines *lines, placido_error *err) {
  FILE *stream = lines->stream;
  lines->stream = NULL;
  return !stream || fclose(stream) == 0 ? PLACIDO_OK : refuse(lines, err);
}
