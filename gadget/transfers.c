/* The transfers that a host has begun, answered endpoint by endpoint in their order. */
#include "gadget/transfers.h"

#include "base/memory.h"

#include <string.h>

int placido_gadget_transfers_add(placido_gadget_transfers *transfers,
                                 const placido_usbip_request *request, uint8_t **bytes,
                                 placido_error *err) {
  const size_t size = request->is_in ? 0 : request->size;
  *bytes = NULL;
  if (!transfers->list) {
    transfers->list =
        placido_memory_new(PLACIDO_GADGET_TRANSFERS_MAX, sizeof *transfers->list, err);
    if (!transfers->list) {
      return PLACIDO_MEMORY;
    }
  }
  if (transfers->count == PLACIDO_GADGET_TRANSFERS_MAX ||
      transfers->waiting_bytes + size > PLACIDO_GADGET_WAITING_BYTES_MAX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "USB/IP: %zu transfers with %zu bytes wait: more than a host begins",
                             transfers->count, transfers->waiting_bytes);
  }
  if (size > 0) {
    *bytes = placido_memory_new(size, 1, err);
    if (!*bytes) {
      return PLACIDO_MEMORY;
    }
  }
  transfers->list[transfers->count++] =
      (placido_gadget_pending){.request = *request, .bytes = *bytes};
  transfers->waiting_bytes += size;
  return PLACIDO_OK;
}

static void remove_at(placido_gadget_transfers *transfers, size_t i) {
  placido_gadget_pending *gone = &transfers->list[i];
  transfers->waiting_bytes -= gone->request.is_in ? 0 : gone->request.size;
  placido_memory_free(gone->bytes);
  transfers->count--;
  memmove(gone, gone + 1, (transfers->count - i) * sizeof *gone);
}

bool placido_gadget_transfers_unlink(placido_gadget_transfers *transfers, uint32_t sequence) {
  for (size_t i = 0; i < transfers->count; i++) {
    if (transfers->list[i].request.sequence == sequence) {
      remove_at(transfers, i);
      return true;
    }
  }
  return false;
}

void placido_gadget_transfers_clear(placido_gadget_transfers *transfers) {
  while (transfers->count > 0) {
    remove_at(transfers, transfers->count - 1);
  }
}

void placido_gadget_transfers_free(placido_gadget_transfers *transfers) {
  placido_gadget_transfers_clear(transfers);
  placido_memory_free(transfers->list);
  transfers->list = NULL;
}

/* Asks the gadget, and sends its answer; `*is_answered` is false where it has none yet. */
static int answer_one(const placido_gadget_pending *pending, placido_gadget *gadget,
                      placido_gadget_wire *wire, bool *is_answered, placido_error *err) {
  const placido_usbip_request *request = &pending->request;
  const placido_gadget_setup *setup = request->endpoint == 0 ? &request->setup : NULL;
  size_t size = request->size;
  uint8_t *answer = placido_gadget_wire_room(
      wire, PLACIDO_USBIP_HEADER_BYTES + (request->is_in ? size : 0), err);
  *is_answered = false;
  if (!answer) {
    return PLACIDO_MEMORY;
  }
  /* A transfer without data has an address all the same: functions copy without asking. */
  uint8_t *bytes = pending->bytes ? pending->bytes : answer + PLACIDO_USBIP_HEADER_BYTES;
  const enum placido_gadget_answer how =
      placido_gadget_transfer(gadget, request->endpoint, setup, bytes, &size);
  if (how == PLACIDO_GADGET_LATER) {
    return PLACIDO_OK;
  }
  placido_usbip_submitted_encode(answer, request->sequence,
                                 how == PLACIDO_GADGET_STALL ? PLACIDO_USBIP_STALLED : 0, size);
  placido_gadget_wire_send(wire, PLACIDO_USBIP_HEADER_BYTES + (request->is_in ? size : 0));
  *is_answered = true;
  return PLACIDO_OK;
}

/* A bit for each endpoint and direction; control has one for both. */
static uint32_t endpoint_bit(uint8_t endpoint) {
  return 1u << ((endpoint & 0x0F) | (endpoint & 0x80 ? 16 : 0));
}

int placido_gadget_transfers_answer(placido_gadget_transfers *transfers, placido_gadget *gadget,
                                    placido_gadget_wire *wire, placido_error *err) {
  uint32_t waiting = 0; /* endpoints whose first transfer has no answer yet */
  for (size_t i = 0; i < transfers->count && !placido_gadget_wire_is_busy(wire);) {
    const placido_gadget_pending *pending = &transfers->list[i];
    const uint32_t bit = endpoint_bit(pending->request.endpoint);
    bool is_answered = false;
    if (!(waiting & bit)) {
      const int status = answer_one(pending, gadget, wire, &is_answered, err);
      if (status != PLACIDO_OK) {
        return status;
      }
      waiting |= bit;
    }
    if (is_answered) { /* which may be what another one has been waiting for */
      remove_at(transfers, i);
      waiting = 0;
      i = 0;
    } else {
      i++;
    }
  }
  return PLACIDO_OK;
}
