/* A ring of pictures on their way: asynchronous transfers that wait for the camera in the order in
 * which it sends.
 *
 * The kernel keeps 16 MiB for all USB transfers of all programs (usbfs_memory_mb); half of it is
 * taken here at most, and less where it is refused. */
#include "drivers/u3v/ring.h"

#include "base/memory.h"

#define FLYING_MAX_BYTES ((size_t)8 << 20)
#define CANCEL_NS_MAX 1000000000
#define CANCEL_WAIT_MS 10

static placido_u3v_transfer *transfer_at(const placido_u3v_ring *ring, uint64_t number) {
  return &ring->transfers[number % (ring->slot_count * ring->slot_transfers)];
}

static void free_memory(placido_u3v_ring *ring) {
  for (size_t i = 0; i < ring->slot_count; i++) {
    placido_memory_free(ring->slots[i].block);
  }
  placido_memory_free(ring->transfers);
  placido_memory_free(ring->packets);
  placido_memory_free(ring);
}

static int allocate(placido_u3v_ring *ring, placido_error *err) {
  const placido_u3v_layout *layout = &ring->layout;
  const size_t packet_bytes = layout->leader_bytes + layout->trailer_bytes;
  ring->transfers =
      placido_memory_new(ring->slot_count * ring->slot_transfers, sizeof *ring->transfers, err);
  ring->packets = placido_memory_new(ring->slot_count, packet_bytes, err);
  if (!ring->transfers || !ring->packets) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < ring->slot_count; i++) {
    placido_u3v_slot *slot = &ring->slots[i];
    slot->transfers = ring->transfers + i * ring->slot_transfers;
    slot->leader = ring->packets + i * packet_bytes;
    slot->trailer = slot->leader + layout->leader_bytes;
    slot->block_bytes = placido_u3v_layout_block_bytes(layout);
    slot->block = placido_memory_new_aligned(slot->block_bytes, err);
    if (!slot->block) {
      return PLACIDO_MEMORY;
    }
  }
  return PLACIDO_OK;
}

int placido_u3v_ring_new(placido_u3v_ring **ring, const placido_u3v_calls *calls, void *pipe,
                         const placido_u3v_layout *layout, int slots, placido_error *err) {
  *ring = NULL;
  placido_u3v_ring *made = placido_memory_new(1, sizeof *made, err);
  if (!made) {
    return PLACIDO_MEMORY;
  }
  made->calls = calls;
  made->pipe = pipe;
  made->layout = *layout;
  made->slot_count = (size_t)slots;
  made->slot_transfers = placido_u3v_layout_transfers(layout);
  made->flying_max = FLYING_MAX_BYTES;
  if (allocate(made, err)) {
    free_memory(made);
    return PLACIDO_MEMORY;
  }
  *ring = made;
  return PLACIDO_OK;
}

/* Where a transfer of a slot puts its bytes. */
static uint8_t *place_of(const placido_u3v_ring *ring, const placido_u3v_slot *slot,
                         size_t index) {
  if (index == 0) {
    return slot->leader;
  }
  return index + 1 == ring->slot_transfers
             ? slot->trailer
             : slot->block + (index - 1) * ring->layout.transfer_bytes;
}

/* Submits the next transfer. */
static enum placido_u3v_end submit(placido_u3v_ring *ring) {
  const size_t index = (size_t)(ring->submitted % ring->slot_transfers);
  placido_u3v_slot *slot =
      &ring->slots[ring->submitted / ring->slot_transfers % ring->slot_count];
  placido_u3v_transfer *transfer = transfer_at(ring, ring->submitted);
  transfer->bytes = place_of(ring, slot, index);
  transfer->size = placido_u3v_layout_transfer_bytes(&ring->layout, index);
  transfer->received = 0;
  slot->arrival_ns = index == 0 ? 0 : slot->arrival_ns;
  const enum placido_u3v_end end = ring->calls->submit(ring->pipe, transfer);
  if (end == PLACIDO_U3V_DONE) {
    ring->submitted++;
    ring->flying_bytes += transfer->size;
  }
  return end;
}

enum placido_u3v_end placido_u3v_ring_fill(placido_u3v_ring *ring) {
  while (ring->ended < ring->submitted && !transfer_at(ring, ring->ended)->is_pending) {
    ring->flying_bytes -= transfer_at(ring, ring->ended)->size;
    ring->ended++;
  }
  const uint64_t end_of_room = (ring->taken + ring->slot_count) * ring->slot_transfers;
  while (ring->submitted < end_of_room) {
    const size_t index = (size_t)(ring->submitted % ring->slot_transfers);
    const size_t bytes = placido_u3v_layout_transfer_bytes(&ring->layout, index);
    if (ring->flying_bytes > 0 && ring->flying_bytes + bytes > ring->flying_max) {
      return PLACIDO_U3V_DONE;
    }
    const enum placido_u3v_end end = submit(ring);
    if (end == PLACIDO_U3V_FAILED && ring->flying_bytes > 0) {
      ring->flying_max = ring->flying_bytes; /* the kernel has no more: go on with these */
      return PLACIDO_U3V_DONE;
    }
    if (end != PLACIDO_U3V_DONE) {
      return end;
    }
  }
  return PLACIDO_U3V_DONE;
}

placido_u3v_slot *placido_u3v_ring_head(placido_u3v_ring *ring) {
  return &ring->slots[ring->taken % ring->slot_count];
}

bool placido_u3v_ring_is_pending(const placido_u3v_ring *ring, size_t transfer_of_head) {
  const uint64_t number = ring->taken * ring->slot_transfers + transfer_of_head;
  return number >= ring->submitted || transfer_at(ring, number)->is_pending;
}

enum placido_u3v_end placido_u3v_ring_fault(const placido_u3v_ring *ring) {
  for (uint64_t i = ring->taken * ring->slot_transfers; i < ring->submitted; i++) {
    const placido_u3v_transfer *transfer = transfer_at(ring, i);
    if (!transfer->is_pending && transfer->end != PLACIDO_U3V_DONE) {
      return transfer->end;
    }
  }
  return PLACIDO_U3V_DONE;
}

void placido_u3v_ring_stamp(placido_u3v_ring *ring) {
  const int64_t now_ns = ring->calls->clock_ns(ring->calls->context);
  for (uint64_t picture = ring->taken; picture * ring->slot_transfers < ring->submitted;
       picture++) {
    placido_u3v_slot *slot = &ring->slots[picture % ring->slot_count];
    if (slot->arrival_ns == 0 && !slot->transfers[0].is_pending) {
      slot->arrival_ns = now_ns;
    }
  }
}

void placido_u3v_ring_next(placido_u3v_ring *ring) {
  ring->taken++;
}

static bool is_any_pending(const placido_u3v_ring *ring) {
  for (size_t i = 0; i < ring->slot_count * ring->slot_transfers; i++) {
    if (ring->transfers[i].is_pending) {
      return true;
    }
  }
  return false;
}

bool placido_u3v_ring_free(placido_u3v_ring *ring) {
  if (!ring) {
    return true;
  }
  const placido_u3v_calls *calls = ring->calls;
  const size_t count = ring->slot_count * ring->slot_transfers;
  /* From the last: a transfer that is next in line could begin to fill while others go. */
  for (size_t i = 0; i < count; i++) {
    placido_u3v_transfer *transfer = transfer_at(ring, ring->submitted + count - 1 - i);
    if (transfer->is_pending) {
      calls->cancel(ring->pipe, transfer);
    }
  }
  const int64_t deadline_ns = calls->clock_ns(calls->context) + CANCEL_NS_MAX;
  while (is_any_pending(ring)) {
    if (calls->clock_ns(calls->context) >= deadline_ns) {
      placido_memory_free(ring); /* but neither transfers nor what they point to */
      return false;
    }
    calls->wait(ring->pipe, CANCEL_WAIT_MS);
  }
  for (size_t i = 0; i < count; i++) {
    calls->forget(ring->pipe, &ring->transfers[i]);
  }
  free_memory(ring);
  return true;
}
