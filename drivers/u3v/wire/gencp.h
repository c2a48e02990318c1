/* The control channel's packets (GenCP 1.x as USB3 Vision carries it): bytes to structs and back.
 * Everything is little-endian; nothing here waits, sends or keeps state. */
#ifndef PLACIDO_U3V_WIRE_GENCP_H
#define PLACIDO_U3V_WIRE_GENCP_H

#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

#define PLACIDO_GENCP_HEADER_BYTES 12
#define PLACIDO_GENCP_READ_BYTES 24          /* a whole read command */
#define PLACIDO_GENCP_WRITE_HEADER_BYTES 20  /* of a write command, before the data */
#define PLACIDO_GENCP_WANTS_ACK 0x4000u      /* in `flags` */

enum placido_gencp_command {
  PLACIDO_GENCP_READ = 0x0800,
  PLACIDO_GENCP_READ_ACK = 0x0801,
  PLACIDO_GENCP_WRITE = 0x0802,
  PLACIDO_GENCP_WRITE_ACK = 0x0803,
  PLACIDO_GENCP_PENDING_ACK = 0x0805,
};

/* What an acknowledge says; the codes of GenCP and USB3 Vision. */
enum placido_gencp_status {
  PLACIDO_GENCP_SUCCESS = 0x0000,
  PLACIDO_GENCP_NOT_IMPLEMENTED = 0x8001,
  PLACIDO_GENCP_INVALID_PARAMETER = 0x8002,
  PLACIDO_GENCP_INVALID_ADDRESS = 0x8003,
  PLACIDO_GENCP_WRITE_PROTECT = 0x8004,
  PLACIDO_GENCP_BAD_ALIGNMENT = 0x8005,
  PLACIDO_GENCP_ACCESS_DENIED = 0x8006,
  PLACIDO_GENCP_BUSY = 0x8007,
  PLACIDO_GENCP_MESSAGE_TIMEOUT = 0x800B,
  PLACIDO_GENCP_INVALID_HEADER = 0x800E,
  PLACIDO_GENCP_WRONG_CONFIGURATION = 0x800F,
  PLACIDO_GENCP_GENERIC_ERROR = 0x8FFF,
};

/* A packet taken apart; `data` points into the bytes it was taken from. */
typedef struct placido_gencp_packet {
  uint16_t flags;      /* of a command; of an acknowledge: its status */
  uint16_t command;    /* enum placido_gencp_command, or what else was sent */
  uint16_t request_id;
  uint64_t address;    /* of a read or write command */
  uint16_t count;      /* bytes asked for (read), written (write acknowledge), or the new time-out
                        * in ms (pending acknowledge) */
  const uint8_t *data; /* what is written or was read; NULL: none */
  size_t data_size;
} placido_gencp_packet;

/* Writes the packet into `bytes`; returns its size, or 0 where it does not fit into `capacity` or
 * its length field (65,535). An acknowledge of a failure carries no data. */
size_t placido_gencp_encode(uint8_t *bytes, size_t capacity, const placido_gencp_packet *packet);

/* Takes `size` bytes apart. PLACIDO_INPUT: no GenCP packet, or one shorter than it says; bytes
 * behind the packet are passed over. A command this version does not know has all its payload
 * in `data`. */
int placido_gencp_decode(placido_gencp_packet *packet, const uint8_t *bytes, size_t size,
                         placido_error *err);

/* A sentence for a status code; never NULL. */
const char *placido_gencp_status_text(uint16_t status);

#endif
