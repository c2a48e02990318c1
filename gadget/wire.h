/* A socket that carries USB/IP: what came in whole, what still has to go out. */
#ifndef PLACIDO_GADGET_WIRE_H
#define PLACIDO_GADGET_WIRE_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Zero but for the socket; without one it is -1. */
typedef struct placido_gadget_wire {
  int socket;
  uint8_t *in;   /* where the next `in_wanted` bytes go */
  size_t in_wanted, in_got;
  uint8_t *out;  /* one answer: header and data leave together */
  size_t out_capacity, out_size, out_sent;
} placido_gadget_wire;

/* Takes a socket over. */
void placido_gadget_wire_open(placido_gadget_wire *wire, int socket);
/* Closes the socket; keeps the memory. */
void placido_gadget_wire_hang_up(placido_gadget_wire *wire);
void placido_gadget_wire_free(placido_gadget_wire *wire);

/* Says where the next `size` bytes belong. */
void placido_gadget_wire_expect(placido_gadget_wire *wire, uint8_t *bytes, size_t size);
/* Reads what is there without waiting. PLACIDO_OK: what was expected is whole; PLACIDO_TIMEOUT: it
 * is not yet; PLACIDO_GONE: the other side hung up. */
int placido_gadget_wire_receive(placido_gadget_wire *wire);

/* Room for an answer of `size` bytes, borrowed until it is sent; NULL with the error set: no
 * memory. Only while nothing is left to be sent. */
uint8_t *placido_gadget_wire_room(placido_gadget_wire *wire, size_t size, placido_error *err);
/* Sends the first `size` bytes of it, as far as they go without waiting. */
void placido_gadget_wire_send(placido_gadget_wire *wire, size_t size);
/* Sends more of what is left. PLACIDO_OK, PLACIDO_GONE. */
int placido_gadget_wire_flush(placido_gadget_wire *wire);
bool placido_gadget_wire_is_busy(const placido_gadget_wire *wire);

#endif
