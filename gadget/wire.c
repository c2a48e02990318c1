/* A socket that carries USB/IP, without ever waiting for it. */
#include "gadget/wire.h"

#include "base/memory.h"

#include <errno.h>
#include <sys/socket.h>
#include <unistd.h>

void placido_gadget_wire_open(placido_gadget_wire *wire, int socket) {
  wire->socket = socket;
  wire->in_wanted = wire->in_got = 0;
  wire->out_size = wire->out_sent = 0;
}

void placido_gadget_wire_hang_up(placido_gadget_wire *wire) {
  if (wire->socket >= 0) {
    close(wire->socket);
  }
  placido_gadget_wire_open(wire, -1);
}

void placido_gadget_wire_free(placido_gadget_wire *wire) {
  placido_gadget_wire_hang_up(wire);
  placido_memory_free(wire->out);
  wire->out = NULL;
  wire->out_capacity = 0;
}

void placido_gadget_wire_expect(placido_gadget_wire *wire, uint8_t *bytes, size_t size) {
  wire->in = bytes;
  wire->in_wanted = size;
  wire->in_got = 0;
}

int placido_gadget_wire_receive(placido_gadget_wire *wire) {
  while (wire->in_got < wire->in_wanted) {
    const ssize_t got = recv(wire->socket, wire->in + wire->in_got,
                             wire->in_wanted - wire->in_got, MSG_DONTWAIT);
    if (got > 0) {
      wire->in_got += (size_t)got;
    } else if (got == 0) {
      return PLACIDO_GONE;
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return PLACIDO_TIMEOUT;
    } else if (errno != EINTR) {
      return PLACIDO_GONE;
    }
  }
  return PLACIDO_OK;
}

uint8_t *placido_gadget_wire_room(placido_gadget_wire *wire, size_t size, placido_error *err) {
  if (size > wire->out_capacity) {
    uint8_t *grown = placido_memory_grow(wire->out, size, 1, err);
    if (!grown) {
      return NULL;
    }
    wire->out = grown;
    wire->out_capacity = size;
  }
  return wire->out;
}

void placido_gadget_wire_send(placido_gadget_wire *wire, size_t size) {
  wire->out_size = size;
  wire->out_sent = 0;
  (void)placido_gadget_wire_flush(wire); /* a socket that is gone tells so when it is read */
}

int placido_gadget_wire_flush(placido_gadget_wire *wire) {
  while (wire->out_sent < wire->out_size) {
    const ssize_t sent = send(wire->socket, wire->out + wire->out_sent,
                              wire->out_size - wire->out_sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) {
      wire->out_sent += (size_t)sent;
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return PLACIDO_OK;
    } else if (errno != EINTR) {
      wire->out_size = wire->out_sent = 0;
      return PLACIDO_GONE;
    }
  }
  wire->out_size = wire->out_sent = 0;
  return PLACIDO_OK;
}

bool placido_gadget_wire_is_busy(const placido_gadget_wire *wire) {
  return wire->out_sent < wire->out_size;
}
