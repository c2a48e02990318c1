/* The transfers that a host has begun and the device has not answered yet. */
#ifndef PLACIDO_GADGET_TRANSFERS_H
#define PLACIDO_GADGET_TRANSFERS_H

#include "gadget/usbip.h"
#include "gadget/wire.h"

#define PLACIDO_GADGET_TRANSFERS_MAX 1024 /* at a time: no driver begins as many */
#define PLACIDO_GADGET_WAITING_BYTES_MAX (64u << 20) /* that the host sent with them */

typedef struct placido_gadget_pending {
  placido_usbip_request request;
  uint8_t *bytes; /* of an OUT transfer; owned */
} placido_gadget_pending;

/* In the order in which they were begun. Zero to start with. */
typedef struct placido_gadget_transfers {
  placido_gadget_pending *list;
  size_t count, waiting_bytes;
} placido_gadget_transfers;

/* Adds a transfer, with room for its bytes where it is an OUT one (`*bytes`; else NULL). The
 * caller fills them before the next answer. Returns PLACIDO_OK, PLACIDO_INPUT (more than any driver
 * begins), PLACIDO_MEMORY. */
int placido_gadget_transfers_add(placido_gadget_transfers *transfers,
                                 const placido_usbip_request *request, uint8_t **bytes,
                                 placido_error *err);
/* Takes one back; false where it is not there: answered before. */
bool placido_gadget_transfers_unlink(placido_gadget_transfers *transfers, uint32_t sequence);
void placido_gadget_transfers_clear(placido_gadget_transfers *transfers);
void placido_gadget_transfers_free(placido_gadget_transfers *transfers);

/* Answers what the gadget can answer now, those of an endpoint in their order, until the wire is
 * busy. Returns PLACIDO_OK, PLACIDO_MEMORY. */
int placido_gadget_transfers_answer(placido_gadget_transfers *transfers, placido_gadget *gadget,
                                    placido_gadget_wire *wire, placido_error *err);

#endif
