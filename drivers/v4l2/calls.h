/* The system calls a camera is driven through: the kernel's, or a script's in tests. */
#ifndef PLACIDO_DRIVERS_V4L2_CALLS_H
#define PLACIDO_DRIVERS_V4L2_CALLS_H

#include <poll.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* Each behaves as the system call of its name: -1 (MAP_FAILED) and errno where it fails. */
typedef struct placido_v4l2_calls {
  int (*open)(const char *path, int flags);
  int (*close)(int fd);
  int (*ioctl)(int fd, unsigned long request, void *argument);
  void *(*mmap)(void *address, size_t length, int protection, int flags, int fd, off_t offset);
  int (*munmap)(void *address, size_t length);
  int (*poll)(struct pollfd *files, nfds_t count, int timeout_ms);
  ssize_t (*read)(int fd, void *bytes, size_t size);
  int64_t (*clock_ns)(void);  /* CLOCK_MONOTONIC, as the kernel stamps frames */
  int64_t (*asleep_ns)(void); /* how long the computer has been suspended since it was started */
  const char *root;           /* stands before /sys and /dev */
} placido_v4l2_calls;

extern const placido_v4l2_calls placido_v4l2_kernel;

/* An ioctl, repeated where a signal interrupted it. Returns 0 or the positive errno. */
int placido_v4l2_ioctl(const placido_v4l2_calls *calls, int fd, unsigned long request,
                       void *argument);

#endif
