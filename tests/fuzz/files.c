/* A folder of files for one process: a reader that takes a path finds there what was made up. */
#include "tests/fuzz/files.h"

#include "base/file.h"
#include "base/memory.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SEPARATOR 0x1e

void fuzz_require(bool truth, const char *text, const char *file, int line) {
  if (!truth) {
    fprintf(stderr, "%s:%d: not true: %s\n", file, line, text);
    abort();
  }
}

bool fuzz_check(int status, const placido_error *err) {
  FUZZ_REQUIRE(status <= PLACIDO_OK && status >= PLACIDO_GONE);
  if (status == PLACIDO_OK) {
    return true;
  }
  FUZZ_REQUIRE(err->status == status);
  FUZZ_REQUIRE(err->text[0] != '\0');
  for (const unsigned char *c = (const unsigned char *)err->text; *c; c++) {
    FUZZ_REQUIRE(*c >= ' ' && *c != 0x7f);
  }
  return false;
}

static char folder[64];

void fuzz_remove(const char *path) {
  if (unlink(path) == 0) {
    return;
  }
  DIR *directory = opendir(path);
  for (struct dirent *entry; directory && (entry = readdir(directory));) {
    char file[PLACIDO_PATH_MAX];
    if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 &&
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name) < (int)sizeof file) {
      fuzz_remove(file);
    }
  }
  if (directory) {
    closedir(directory);
  }
  rmdir(path);
}

static void remove_folder(void) {
  fuzz_remove(folder);
}

const char *fuzz_path(const char *name) {
  static char paths[4][PLACIDO_PATH_MAX];
  static unsigned turn;
  if (!folder[0]) {
    snprintf(folder, sizeof folder, "%s/placido-fuzz-XXXXXX", access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    FUZZ_REQUIRE(mkdtemp(folder) != NULL);
    atexit(remove_folder);
  }
  char *path = paths[turn++ % 4];
  snprintf(path, PLACIDO_PATH_MAX, "%s/%s", folder, name);
  return path;
}

const char *fuzz_file(const char *name, const void *bytes, size_t size) {
  const char *path = fuzz_path(name);
  int descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  FUZZ_REQUIRE(descriptor >= 0);
  FUZZ_REQUIRE(size == 0 || write(descriptor, bytes, size) == (ssize_t)size);
  close(descriptor);
  return path;
}

bool fuzz_same(const char *first, const char *second) {
  char *texts[2];
  size_t sizes[2];
  FUZZ_REQUIRE(placido_file_read(&texts[0], &sizes[0], first, 0, NULL) == PLACIDO_OK);
  FUZZ_REQUIRE(placido_file_read(&texts[1], &sizes[1], second, 0, NULL) == PLACIDO_OK);
  bool same = sizes[0] == sizes[1] && memcmp(texts[0], texts[1], sizes[0]) == 0;
  placido_memory_free(texts[0]);
  placido_memory_free(texts[1]);
  return same;
}

const uint8_t *fuzz_part(size_t *part_size, const uint8_t **data, size_t *size) {
  const uint8_t *part = *data;
  const uint8_t *end = *size > 0 ? memchr(part, SEPARATOR, *size) : NULL;
  *part_size = end ? (size_t)(end - part) : *size;
  size_t used = *part_size + (end != NULL);
  *data += used;
  *size -= used;
  return part;
}

uint8_t fuzz_byte(const uint8_t **data, size_t *size) {
  if (*size == 0) {
    return 0;
  }
  (*size)--;
  return *(*data)++;
}
