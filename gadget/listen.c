/* TCP for a device that other machines may fetch. */
#include "gadget/listen.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

int placido_gadget_listen(int *listener, const char *address, int port, placido_error *err) {
  struct sockaddr_in name = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  const int yes = 1;
  *listener = -1;
  if (inet_pton(AF_INET, address, &name.sin_addr) != 1) {
    return placido_error_set(err, PLACIDO_INPUT, "\"%s\" is no IPv4 address", address);
  }
  const int opened = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (opened < 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "no TCP socket: %s", strerror(errno));
  }
  if (setsockopt(opened, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      bind(opened, (const struct sockaddr *)&name, sizeof name) != 0 || listen(opened, 4) != 0) {
    placido_error_set(err, PLACIDO_SYSTEM, "cannot listen on %s, TCP port %d: %s", address, port,
                      strerror(errno));
    close(opened);
    return PLACIDO_SYSTEM;
  }
  *listener = opened;
  return PLACIDO_OK;
}

int placido_gadget_listen_port(int listener) {
  struct sockaddr_in name = {0};
  socklen_t size = sizeof name;
  if (listener < 0 || getsockname(listener, (struct sockaddr *)&name, &size) != 0) {
    return 0;
  }
  return ntohs(name.sin_port);
}

int placido_gadget_listen_accept(int listener) {
  const int client = accept(listener, NULL, NULL);
  const int yes = 1;
  if (client >= 0) {
    /* Without this an answer waits up to 40 ms for the acknowledgement of the one before. */
    (void)setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  }
  return client;
}
