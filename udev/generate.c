/* Writes udev's rules, hardware database or groups from the drivers' tables: generate KIND FILE. */
#include "udev/rules.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const struct {
  const char *name;
  int (*write)(FILE *file, const placido_driver *const *drivers, size_t count,
               placido_error *err);
} kinds[] = {
    {"rules", placido_udev_rules},
    {"hwdb", placido_udev_hwdb},
    {"groups", placido_udev_groups},
};

static int write_file(size_t kind, const char *path, placido_error *err) {
  FILE *file = fopen(path, "we");
  if (!file) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", path, strerror(errno));
  }
  size_t count;
  const placido_driver *const *drivers = placido_driver_table(&count);
  const int status = kinds[kind].write(file, drivers, count, err);
  if (fclose(file) != 0 && status == PLACIDO_OK) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", path, strerror(errno));
  }
  return status;
}

int main(int argc, char **argv) {
  placido_error err = {.text = "usage: generate rules|hwdb|groups FILE"};
  int status = PLACIDO_INPUT;
  for (size_t i = 0; argc == 3 && i < sizeof kinds / sizeof *kinds; i++) {
    if (strcmp(argv[1], kinds[i].name) == 0) {
      status = write_file(i, argv[2], &err);
    }
  }
  if (status != PLACIDO_OK) {
    fprintf(stderr, "%s\n", err.text);
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
