/* Plugging a socket that speaks USB/IP into this machine's own kernel (module vhci_hcd). */
#ifndef PLACIDO_GADGET_VHCI_H
#define PLACIDO_GADGET_VHCI_H

#include "gadget/function.h"

#include <placido/status.h>

#define PLACIDO_VHCI_FOLDER "/sys/devices/platform/vhci_hcd.0"

/* Whether the kernel would take a device of that speed now. Returns as placido_vhci_attach. */
int placido_vhci_check(const char *folder, enum placido_gadget_speed speed, placido_error *err);

/* Gives the socket to a free port of the speed's hub, to `*port` itself where that is free (-1: any
 * will do); puts the port there. The kernel keeps the socket: the caller may close its own
 * descriptor. Returns PLACIDO_OK, PLACIDO_UNSUPPORTED (no such module), PLACIDO_SYSTEM (no
 * permission; no port is free): the message says what helps. */
int placido_vhci_attach(const char *folder, int *port, int socket,
                        enum placido_gadget_speed speed, placido_error *err);

#endif
