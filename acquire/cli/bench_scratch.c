/* A temporary directory that a signal removes as well. */
#include "acquire/cli/bench_scratch.h"

#include "base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

static const char *choose_folder(const struct settings *settings) {
  if (settings->output) {
    return settings->output;
  }
  const char *folder = getenv("TMPDIR");
  return folder && folder[0] != '\0' ? folder : "/tmp";
}

static int check_room(const char *folder, double bytes, placido_error *err) {
  struct statvfs found;
  if (statvfs(folder, &found) != 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write into %s: %s",
                             placido_text_tail(folder), strerror(errno));
  }
  const double room = (double)found.f_bavail * (double)found.f_frsize;
  return room >= bytes
             ? PLACIDO_OK
             : placido_error_set(err, PLACIDO_SYSTEM,
                                 "%s has room for %.0f MB, and %.0f are needed: give another "
                                 "directory with -o, or a shorter --for",
                                 placido_text_tail(folder), 1e-6 * room, 1e-6 * bytes);
}

int bench_scratch_open(placido_directory *scratch, struct bench_run *run, double bytes,
                       placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  const char *folder = choose_folder(run->settings);
  *scratch = (placido_directory){0};
  int status = check_room(folder, bytes, err);
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, folder, "placido-bench", err);
  }
  if (status == PLACIDO_OK) {
    interrupt_hold(run->outcome->interrupt);
    status = placido_directory_create(scratch, path, NULL, err);
    interrupt_release(run->outcome->interrupt, scratch);
  }
  return status;
}

void bench_scratch_close(placido_directory *scratch, struct bench_run *run) {
  const placido_directory nothing = {0};
  placido_directory_discard(scratch);
  interrupt_hold(run->outcome->interrupt);
  interrupt_release(run->outcome->interrupt, &nothing);
}

void bench_scratch_remove(const char *path) {
  placido_directory doomed = {0};
  snprintf(doomed.temporary, sizeof doomed.temporary, "%s", path);
  placido_directory_discard(&doomed);
}
