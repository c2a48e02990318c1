/* Plays a fuzz target's corpus without a fuzzer: every file as it is, cut at every place, and with
 * one byte changed, so that each test run treads the damaged paths as well. */
#include "tests/fuzz/target.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of a long file only some places are cut or changed: a run stays within seconds. */
#ifndef PLACES_MAX
#define PLACES_MAX 400
#endif

static void play_damaged(const uint8_t *bytes, size_t size) {
  const size_t step = size / PLACES_MAX + 1;
  for (size_t place = 0; place < size; place += step) {
    /* A block of its own size each time, so that a sanitizer sees every byte read behind it. */
    uint8_t *copy = malloc(size);
    uint8_t *cut = malloc(place + 1);
    if (copy && cut) {
      memcpy(cut, bytes, place);
      LLVMFuzzerTestOneInput(cut, place);
      memcpy(copy, bytes, size);
      copy[place] ^= (uint8_t)(1u << place % 8);
      LLVMFuzzerTestOneInput(copy, size);
      copy[place] = 0xFF;
      LLVMFuzzerTestOneInput(copy, size);
    }
    free(copy);
    free(cut);
  }
}

static int play_file(const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file) {
    return 0;
  }
  static uint8_t bytes[1 << 20];
  const size_t size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  uint8_t *copy = malloc(size + 1);
  if (!copy) {
    return 0;
  }
  memcpy(copy, bytes, size);
  LLVMFuzzerTestOneInput(copy, size);
  play_damaged(copy, size);
  free(copy);
  return 1;
}

static int play_directory(const char *path) {
  DIR *directory = opendir(path);
  if (!directory) {
    return 0;
  }
  int count = 0;
  for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
    char file[4096];
    if (entry->d_name[0] != '.' &&
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name) < (int)sizeof file) {
      count += play_file(file);
    }
  }
  closedir(directory);
  return count;
}

int main(int argc, char **argv) {
  int count = 0;
  for (int i = 1; i < argc; i++) {
    count += play_directory(argv[i]);
  }
  printf("%d files played\n", count);
  return count > 0 ? 0 : 1;
}
