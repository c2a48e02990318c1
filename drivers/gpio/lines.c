/* What both versions of libgpiod leave to the system: the list of chips, waiting, and the clock. */
#include "drivers/gpio/lines.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More chips than any computer has. */
#define CHIPS_MAX 512
#define WAIT_MAX 8

/* The number of a node "gpiochipN"; -1 where it is another. */
static int chip_number(const char *name) {
  const size_t prefix = strlen("gpiochip");
  if (strncmp(name, "gpiochip", prefix) != 0) {
    return -1;
  }
  const char *digits = name + prefix;
  const size_t length = strspn(digits, "0123456789");
  const bool is_number = length >= 1 && length <= 4 && digits[length] == '\0';
  return is_number && atoi(digits) < CHIPS_MAX ? atoi(digits) : -1;
}

int placido_gpio_list_nodes(int (*each)(void *user, const char *path), void *user) {
  bool there[CHIPS_MAX] = {false};
  DIR *directory = opendir("/dev");
  const struct dirent *entry;
  while (directory && (entry = readdir(directory))) {
    const int number = chip_number(entry->d_name);
    if (number >= 0) {
      there[number] = true;
    }
  }
  if (directory) {
    closedir(directory);
  }
  int status = 0;
  for (int i = 0; !status && i < CHIPS_MAX; i++) {
    char path[32];
    snprintf(path, sizeof path, "/dev/gpiochip%d", i);
    status = there[i] ? each(user, path) : 0;
  }
  return status;
}

int placido_gpio_wait(const int *descriptors, size_t count, int timeout_ms) {
  struct pollfd files[WAIT_MAX];
  if (count > WAIT_MAX) {
    return EINVAL;
  }
  for (size_t i = 0; i < count; i++) {
    files[i] = (struct pollfd){.fd = descriptors[i], .events = POLLIN};
  }
  if (poll(files, (nfds_t)count, timeout_ms) < 0) {
    return errno == EINTR ? 0 : placido_gpio_errno();
  }
  for (size_t i = 0; i < count; i++) {
    if (files[i].revents & (POLLERR | POLLHUP | POLLNVAL)) {
      return ENODEV;
    }
  }
  return 0;
}

int placido_gpio_make_nonblocking(int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  return flags < 0 || fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) < 0 ? placido_gpio_errno() : 0;
}

int placido_gpio_errno(void) {
  return errno > 0 ? errno : EIO;
}
