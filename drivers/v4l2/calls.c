/* The kernel's own system calls. */
#include "drivers/v4l2/calls.h"

#include "base/clock.h"

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

/* CLOCK_BOOTTIME goes on during a suspension, CLOCK_MONOTONIC stands still. */
static int64_t asleep_ns(void) {
  struct timespec since_boot = {0};
  clock_gettime(CLOCK_BOOTTIME, &since_boot);
  return (int64_t)since_boot.tv_sec * 1000000000 + since_boot.tv_nsec - placido_clock_now_ns();
}

const placido_v4l2_calls placido_v4l2_kernel = {
    .open = open_path,
    .close = close,
    .ioctl = control_device,
    .mmap = mmap,
    .munmap = munmap,
    .poll = poll,
    .read = read,
    .clock_ns = placido_clock_now_ns,
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
