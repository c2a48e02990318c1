/* A directory of a test's own, gone when the test ends. */
#include "tests/base/scratch.h"

#include "base/file.h"

#include <dirent.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <cmocka.h>

int scratch_setup(void **state) {
  const char *parent = getenv("TMPDIR");
  char path[PLACIDO_PATH_MAX];
  placido_directory *directory = calloc(1, sizeof *directory);
  assert_non_null(directory);
  snprintf(path, sizeof path, "%s/placido-test", parent ? parent : "/tmp");
  assert_int_equal(placido_directory_create(directory, path, NULL, NULL), PLACIDO_OK);
  *state = directory;
  return 0;
}

int scratch_teardown(void **state) {
  placido_directory_discard(*state);
  free(*state);
  return 0;
}

char *scratch_path(void **state, const char *name) {
  const placido_directory *directory = *state;
  char path[PLACIDO_PATH_MAX];
  assert_int_equal(placido_path_join(path, directory->temporary, name, NULL), PLACIDO_OK);
  char *copy = strdup(path);
  assert_non_null(copy);
  return copy;
}

char *scratch_write(void **state, const char *name, const void *bytes, size_t size) {
  char *path = scratch_path(state, name);
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  assert_int_equal(fwrite(bytes, 1, size, stream), size);
  assert_int_equal(fclose(stream), 0);
  return path;
}

char *scratch_write_text(void **state, const char *name, const char *text) {
  return scratch_write(state, name, text, strlen(text));
}

size_t scratch_count(const char *path) {
  DIR *listing = opendir(path);
  assert_non_null(listing);
  size_t count = 0;
  for (struct dirent *entry; (entry = readdir(listing));) {
    count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
  }
  closedir(listing);
  return count;
}
