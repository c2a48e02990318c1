/* The wire of a simulated device: one loop, one thread, that moves USB/IP packets between a gadget
 * and a kernel: this machine's own, or one that fetches the device over TCP (`usbip attach`). */
#ifndef PLACIDO_GADGET_SERVER_H
#define PLACIDO_GADGET_SERVER_H

#include "gadget/function.h"
#include "gadget/introduction.h"

#include <placido/status.h>
#include <stdbool.h>

typedef struct placido_gadget_server placido_gadget_server;

typedef struct placido_gadget_server_options {
  placido_gadget *gadget; /* borrowed */

  /* The kernel of this machine; or a TCP port to listen on (0: any free one), at an IPv4 address
   * (NULL: 127.0.0.1, for this machine alone). One host at a time. */
  bool is_local;
  int tcp_port;
  const char *address;
  /* Gives one end of a socket to a kernel, as placido_vhci_attach; NULL: that one. */
  int (*plug)(void *user, int socket, enum placido_gadget_speed speed, placido_error *err);

  /* A descriptor that is watched beside the wire (-1: none), and what is called when it can be
   * read. PLACIDO_END: it is watched no longer; any other status but PLACIDO_OK ends
   * placido_gadget_server_run with it. */
  int descriptor;
  int (*readable)(void *user, placido_error *err);
  /* Called once a turn with the time. NULL: nobody wants to know. Returns when it wants to be
   * called next at the latest. */
  int64_t (*turned)(void *user, int64_t now_ns);
  void *user;
} placido_gadget_server_options;

/* Plugs the device in, or starts to listen. Returns PLACIDO_OK, PLACIDO_SYSTEM,
 * PLACIDO_UNSUPPORTED, PLACIDO_MEMORY. */
int placido_gadget_server_open(placido_gadget_server **server,
                               const placido_gadget_server_options *options, placido_error *err);
/* Unplugs it. NULL is legal. */
void placido_gadget_server_close(placido_gadget_server *server);

/* The TCP port in use; 0: none. */
int placido_gadget_server_port(const placido_gadget_server *server);
/* Whether a kernel has the device. */
bool placido_gadget_server_is_attached(const placido_gadget_server *server);

/* One turn of the loop: waits for at most timeout_ms (-1: for ever) for something to do, and does
 * it. PLACIDO_GONE: this machine's kernel let go of the device; else what failed. */
int placido_gadget_server_turn(placido_gadget_server *server, int timeout_ms, placido_error *err);
/* Turns until the monotonic time until_ns, or until stopped. */
int placido_gadget_server_run(placido_gadget_server *server, int64_t until_ns, placido_error *err);
void placido_gadget_server_stop(placido_gadget_server *server);

/* Pulls the plug, and puts it in again after away_ns. Over TCP the other machine has to ask for the
 * device again, and is not heard until then. */
void placido_gadget_server_unplug(placido_gadget_server *server, int64_t away_ns);

#endif
