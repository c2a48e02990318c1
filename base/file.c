/* Files that appear whole or not at all: a temporary name beside the place, then a rename. */
#include "base/file.h"

#include "base/memory.h"
#include "base/temporary.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define READ_LIMIT ((size_t)1 << 30)
#define READ_STEP ((size_t)1 << 16)

int placido_path_join(char *out, const char *folder, const char *name, placido_error *err) {
  const char *slash = folder[0] && folder[strlen(folder) - 1] == '/' ? "" : "/";
  int length = snprintf(out, PLACIDO_PATH_MAX, "%s%s%s", folder, slash, name);
  if (length < 0 || length >= PLACIDO_PATH_MAX) {
    out[0] = '\0';
    return placido_error_set(err, PLACIDO_INPUT, "the path ...%s/%s is too long",
                             placido_text_tail(folder), name);
  }
  return PLACIDO_OK;
}

int placido_temporary_name(char *out, const char *path, int attempt, const char *ending,
                           placido_error *err) {
  int length = snprintf(out, PLACIDO_PATH_MAX, "%s.%ld-%d.%s", path, (long)getpid(), attempt,
                        ending);
  if (length < 0 || length >= PLACIDO_PATH_MAX) {
    out[0] = '\0';
    return placido_error_set(err, PLACIDO_INPUT, "the path ...%s is too long",
                             placido_text_tail(path));
  }
  return PLACIDO_OK;
}

void placido_temporary_hide(char *text) {
  char mark[32];
  int length = snprintf(mark, sizeof mark, ".%ld-", (long)getpid());
  for (char *at = text; length > 0 && (at = strstr(at, mark));) {
    const char *end = at + length;
    end += strspn(end, "0123456789");
    if (strncmp(end, ".tmp", 4) == 0) {
      memmove(at, end + 4, strlen(end + 4) + 1);
    } else {
      at++;
    }
  }
}

static int refuse_write(const char *path, int cause, placido_error *err) {
  return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", placido_text_tail(path),
                           strerror(cause));
}

/* Not mkstemp: its files can be read by their owner only, and stay so after the rename. */
int placido_file_create(placido_file *file, const char *path, placido_error *err) {
  *file = (placido_file){0};
  struct stat found;
  if (stat(path, &found) == 0 && S_ISDIR(found.st_mode)) {
    return refuse_write(path, EISDIR, err);
  }
  int descriptor = -1;
  for (int attempt = 0; descriptor < 0; attempt++) {
    int status = placido_temporary_name(file->temporary, path, attempt, "tmp", err);
    if (status) {
      return status;
    }
    descriptor = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && (errno != EEXIST || attempt >= PLACIDO_TEMPORARY_ATTEMPTS)) {
      file->temporary[0] = '\0';
      return refuse_write(path, errno, err);
    }
  }
  snprintf(file->path, sizeof file->path, "%s", path);
  file->stream = fdopen(descriptor, "wb");
  if (!file->stream) {
    int cause = errno;
    close(descriptor);
    placido_file_discard(file);
    return refuse_write(path, cause, err);
  }
  return PLACIDO_OK;
}

/* Without fsync: a result lost in a power cut can be computed again; a recording, which cannot, is
 * put on the disk by the session's writer. */
int placido_file_commit(placido_file *file, placido_error *err) {
  bool failed = fflush(file->stream) != 0 || ferror(file->stream);
  int cause = failed ? errno : 0;
  if (fclose(file->stream) != 0 && !failed) {
    failed = true;
    cause = errno;
  }
  file->stream = NULL;
  if (!failed && rename(file->temporary, file->path) != 0) {
    failed = true;
    cause = errno;
  }
  if (failed) {
    placido_file_discard(file);
    return refuse_write(file->path, cause, err);
  }
  file->temporary[0] = '\0';
  return PLACIDO_OK;
}

void placido_file_discard(placido_file *file) {
  if (!file) {
    return;
  }
  if (file->stream) {
    fclose(file->stream);
    file->stream = NULL;
  }
  if (file->temporary[0]) {
    unlink(file->temporary);
    file->temporary[0] = '\0';
  }
}

static int refuse_read(const char *path, int cause, placido_error *err) {
  return placido_error_set(err, PLACIDO_SYSTEM, "cannot read %s: %s", placido_text_tail(path),
                           strerror(cause));
}

/* Opens without waiting: a named pipe to which nobody writes is empty, not a reason to hang. What
 * is read from it afterwards may be waited for, as always. */
static FILE *open_at_once(const char *path) {
  int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    return NULL;
  }
  int flags = fcntl(descriptor, F_GETFL);
  FILE *stream = NULL;
  if (flags >= 0 && fcntl(descriptor, F_SETFL, flags & ~O_NONBLOCK) == 0) {
    stream = fdopen(descriptor, "rb");
  }
  if (!stream) {
    int cause = errno;
    close(descriptor);
    errno = cause;
  }
  return stream;
}

/* Opens a file for reading and guesses its size (pipes have none). */
static int open_for_reading(FILE **stream, size_t *expected, const char *path,
                            placido_error *err) {
  *expected = READ_STEP;
  *stream = open_at_once(path);
  if (!*stream) {
    return refuse_read(path, errno, err);
  }
  struct stat found;
  int cause = fstat(fileno(*stream), &found) != 0 ? errno : 0;
  if (!cause && S_ISDIR(found.st_mode)) {
    cause = EISDIR;
  }
  if (cause) {
    fclose(*stream);
    *stream = NULL;
    return refuse_read(path, cause, err);
  }
  if (S_ISREG(found.st_mode) && found.st_size > 0) {
    *expected = (size_t)found.st_size + 1;
  }
  return PLACIDO_OK;
}

/* Reads to the end of the stream; `room` is the first allocation's size. */
static int read_to_end(char **text, size_t *size, FILE *stream, size_t room, size_t limit,
                       const char *path, placido_error *err) {
  for (;;) {
    if (room > limit + 1) {
      room = limit + 1;
    }
    char *grown = placido_memory_grow(*text, room + 1, 1, err);
    if (!grown) {
      return PLACIDO_MEMORY;
    }
    *text = grown;
    *size += fread(*text + *size, 1, room - *size, stream);
    (*text)[*size] = '\0';
    if (ferror(stream)) {
      return refuse_read(path, errno, err);
    }
    if (*size > limit) {
      return placido_error_set(err, PLACIDO_INPUT, "%s is larger than %zu bytes",
                               placido_text_tail(path), limit);
    }
    if (*size < room) {
      return PLACIDO_OK;
    }
    room *= 2;
  }
}

int placido_file_read(char **text, size_t *size, const char *path, size_t limit,
                      placido_error *err) {
  *text = NULL;
  *size = 0;
  FILE *stream;
  size_t expected;
  int status = open_for_reading(&stream, &expected, path, err);
  if (status) {
    return status;
  }
  status = read_to_end(text, size, stream, expected, limit ? limit : READ_LIMIT, path, err);
  fclose(stream);
  if (status) {
    placido_memory_free(*text);
    *text = NULL;
    *size = 0;
  }
  return status;
}
