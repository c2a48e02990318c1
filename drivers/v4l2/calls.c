/* The kernel's own system calls. */
#include "drivers/v4l2/calls.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

/* A signal in every call would be an endless loop otherwise. */
#define INTERRUPTIONS_MAX 100

static int open_path(const char *path, int flags) {
  return open(path, flags);
}

static int control_device(int fd, unsigned long request, void *argument) {
  return ioctl(fd, request, argument);
}

static int64_t clock_of(clockid_t clock) {
  struct timespec now = {0};
  clock_gettime(clock, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int64_t monotonic_ns(void) {
  return clock_of(CLOCK_MONOTONIC);
}

/* CLOCK_BOOTTIME goes on during a suspension, CLOCK_MONOTONIC stands still. */
static int64_t asleep_ns(void) {
  return clock_of(CLOCK_BOOTTIME) - clock_of(CLOCK_MONOTONIC);
}

const placido_v4l2_calls placido_v4l2_kernel = {
    .open = open_path,
    .close = close,
    .ioctl = control_device,
    .mmap = mmap,
    .munmap = munmap,
    .poll = poll,
    .read = read,
    .clock_ns = monotonic_ns,
    .asleep_ns = asleep_ns,
    .root = "",
};

int placido_v4l2_ioctl(const placido_v4l2_calls *calls, int fd, unsigned long request,
                       void *argument) {
  for (int i = 0; i < INTERRUPTIONS_MAX; i++) {
    if (calls->ioctl(fd, request, argument) == 0) {
      return 0;
    }
    if (errno != EINTR) {
      return errno ? errno : EIO;
    }
  }
  return EINTR;
}
