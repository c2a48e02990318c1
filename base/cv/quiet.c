/* libpng and libjpeg print to standard error, and OpenCV has no way to stop them: while they
 * decode, a pipe stands in its place. */
#include "base/cv/quiet.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/types.h>
#include <unistd.h>

/* Neither end may wait: what does not fit into the pipe is lost, an empty one is read at once. */
static int make_pipe(int ends[2]) {
  if (pipe(ends) != 0) {
    return -1;
  }
  for (int i = 0; i < 2; i++) {
    if (fcntl(ends[i], F_SETFL, O_NONBLOCK) != 0 || fcntl(ends[i], F_SETFD, FD_CLOEXEC) != 0) {
      close(ends[0]);
      close(ends[1]);
      return -1;
    }
  }
  return 0;
}

void placido_quiet_begin(placido_quiet *quiet) {
  *quiet = (placido_quiet){.standard_error = -1, .reading = -1};
  int ends[2];
  fflush(stderr);
  if (make_pipe(ends) != 0) {
    return;
  }
  quiet->reading = ends[0];
  quiet->standard_error = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (quiet->standard_error >= 0) {
    dup2(ends[1], STDERR_FILENO);
  }
  close(ends[1]);
}

void placido_quiet_end(placido_quiet *quiet, char *said, size_t size) {
  ssize_t length = 0;
  fflush(stderr);
  if (quiet->standard_error >= 0) {
    dup2(quiet->standard_error, STDERR_FILENO);
    close(quiet->standard_error);
  }
  if (quiet->reading >= 0) {
    length = read(quiet->reading, said, size - 1);
    close(quiet->reading);
  }
  said[length > 0 ? length : 0] = '\0';
}
