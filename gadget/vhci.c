/* Two files of the kernel's: `status` lists the ports, `attach` takes "PORT SOCKET DEVICE SPEED"
 * (drivers/usb/usbip/vhci_sysfs.c). */
#include "gadget/vhci.h"

#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define PORTS_MAX 64
#define DEVICE_ID 0x10002 /* bus 1, device 2 of the side that has it: any will do */
#define STATE_FREE 4      /* VDEV_ST_NULL */

typedef struct port_list {
  int ports[PORTS_MAX];
  int count;
} port_list;

/* Free ports of the hub; `first` before all others where it is among them. */
static void read_ports(port_list *list, FILE *stream, const char *hub, int first) {
  char line[256], name[8];
  int port, state;
  while (fgets(line, sizeof line, stream) && list->count < PORTS_MAX) {
    if (sscanf(line, "%7s %d %d", name, &port, &state) == 3 && state == STATE_FREE &&
        strcmp(name, hub) == 0) {
      list->ports[list->count++] = port;
    }
  }
  for (int i = 1; i < list->count; i++) {
    if (list->ports[i] == first) {
      list->ports[i] = list->ports[0];
      list->ports[0] = first;
    }
  }
}

static int list_ports(port_list *list, const char *folder, const char *hub, int first,
                      placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  const int status = placido_path_join(path, folder, "status", err);
  if (status != PLACIDO_OK) {
    return status;
  }
  FILE *stream = fopen(path, "r");
  if (!stream) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "the kernel takes no simulated devices yet: run \"modprobe vhci_hcd\" "
                             "as root, or use --listen and \"usbip attach\" on another machine "
                             "(%s: %s)", path, strerror(errno));
  }
  read_ports(list, stream, hub, first);
  fclose(stream);
  if (list->count == 0) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "%s: every port of its kind has a simulated device already", path);
  }
  return PLACIDO_OK;
}

static const char *hub_of(enum placido_gadget_speed speed) {
  return speed == PLACIDO_GADGET_SUPER ? "ss" : "hs";
}

/* Opens the file that devices are plugged into; -1 with the error set. */
static int open_attach(const char *folder, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  if (placido_path_join(path, folder, "attach", err) != PLACIDO_OK) {
    return -1;
  }
  const int descriptor = open(path, O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) {
    placido_error_set(err, PLACIDO_SYSTEM,
                      "%s: %s (plugging in a simulated device needs root; or use --listen and "
                      "\"usbip attach\")", path, strerror(errno));
  }
  return descriptor;
}

int placido_vhci_check(const char *folder, enum placido_gadget_speed speed, placido_error *err) {
  port_list list = {.count = 0};
  const int status = list_ports(&list, folder, hub_of(speed), -1, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const int descriptor = open_attach(folder, err);
  if (descriptor < 0) {
    return PLACIDO_SYSTEM;
  }
  close(descriptor);
  return PLACIDO_OK;
}

/* 0, or the errno. */
static int write_line(int descriptor, const char *line) {
  const ssize_t written = write(descriptor, line, strlen(line));
  return written < 0 ? errno : written == (ssize_t)strlen(line) ? 0 : EIO;
}

int placido_vhci_attach(const char *folder, int *port, int socket,
                        enum placido_gadget_speed speed, placido_error *err) {
  port_list list = {.count = 0};
  char line[64];
  const int status = list_ports(&list, folder, hub_of(speed), *port, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const int descriptor = open_attach(folder, err);
  if (descriptor < 0) {
    return PLACIDO_SYSTEM;
  }
  int error = EBUSY; /* another program may have taken the port meanwhile */
  for (int i = 0; i < list.count && error == EBUSY; i++) {
    *port = list.ports[i];
    snprintf(line, sizeof line, "%d %d %d %d", *port, socket, DEVICE_ID, (int)speed);
    error = write_line(descriptor, line);
  }
  close(descriptor);
  return error == 0 ? PLACIDO_OK
                    : placido_error_set(err, PLACIDO_SYSTEM,
                                        "%s/attach: the kernel refused the device: %s", folder,
                                        strerror(error));
}
