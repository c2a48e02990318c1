/* The kernel's and udev's messages of devices as the alarm of a watch. */
#include "drivers/driver.h"
#include "drivers/hotplug/watch.h"

#include "base/memory.h"

#include <libudev.h>
#include <poll.h>
#include <unistd.h>

/* Messages taken at a time: what comes beyond them rings again. */
#define MESSAGES_MAX 1000
/* A rest where the descriptor is ready and gives nothing. */
#define REST_MS 50

struct alarm {
  struct udev *udev;
  struct udev_monitor *monitor;
};

static void alarm_close(void *state) {
  struct alarm *alarm = state;
  udev_monitor_unref(alarm->monitor); /* NULL is legal */
  udev_unref(alarm->udev);
  placido_memory_free(alarm);
}

static bool alarm_wait(void *state, int timeout_ms) {
  struct alarm *alarm = state;
  struct pollfd file = {.fd = udev_monitor_get_fd(alarm->monitor), .events = POLLIN};
  if (poll(&file, 1, timeout_ms) <= 0) {
    return false; /* also where a signal came: the watch looks at the clock */
  }
  int taken = 0;
  struct udev_device *device;
  while (taken < MESSAGES_MAX && (device = udev_monitor_receive_device(alarm->monitor))) {
    udev_device_unref(device);
    taken++;
  }
  if (taken == 0) {
    poll(NULL, 0, REST_MS);
  }
  return true; /* without a message as well: the queue may have run over */
}

/* Only what a driver could be meant by rings. */
static bool set_filter(struct udev_monitor *monitor) {
  size_t count;
  const placido_driver *const *drivers = placido_driver_table(&count);
  bool fine = true;
  for (size_t i = 0; i < count; i++) {
    const placido_match *match = drivers[i]->matches;
    for (; match && match->subsystem; match++) {
      fine = fine && udev_monitor_filter_add_match_subsystem_devtype(
                         monitor, match->subsystem,
                         match->usb_class >= 0 ? "usb_device" : NULL) >= 0;
    }
  }
  return fine;
}

/* udev's messages come when it has made names and permissions; where it does not run (a container,
 * a small system), the kernel's own have to do. */
static const char *source(void) {
  return access("/run/udev/control", F_OK) == 0 ? "udev" : "kernel";
}

placido_alarm placido_alarm_open(void) {
  const placido_alarm none = {.wait = NULL};
  struct alarm *alarm = placido_memory_new(1, sizeof *alarm, NULL);
  if (!alarm) {
    return none;
  }
  alarm->udev = udev_new();
  alarm->monitor = alarm->udev ? udev_monitor_new_from_netlink(alarm->udev, source()) : NULL;
  if (!alarm->monitor || !set_filter(alarm->monitor) ||
      udev_monitor_enable_receiving(alarm->monitor) < 0) {
    alarm_close(alarm);
    return none;
  }
  return (placido_alarm){.wait = alarm_wait, .close = alarm_close, .state = alarm};
}
