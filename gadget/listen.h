/* TCP for a device that other machines may fetch. */
#ifndef PLACIDO_GADGET_LISTEN_H
#define PLACIDO_GADGET_LISTEN_H

#include <placido/status.h>

/* Listens on a TCP port (0: any free one) of an IPv4 address; `*listener` is the caller's to close.
 * Returns PLACIDO_OK, PLACIDO_INPUT (no address), PLACIDO_SYSTEM. */
int placido_gadget_listen(int *listener, const char *address, int port, placido_error *err);
/* The port that it listens on; 0: none. */
int placido_gadget_listen_port(int listener);
/* Who has called; -1: nobody any longer. */
int placido_gadget_listen_accept(int listener);

#endif
