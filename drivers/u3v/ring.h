/* A ring of pictures on their way: asynchronous transfers that wait for the camera in the order in
 * which it sends. */
#ifndef PLACIDO_DRIVERS_U3V_RING_H
#define PLACIDO_DRIVERS_U3V_RING_H

#include "drivers/u3v/layout.h"
#include "drivers/u3v/pipe.h"
#include "drivers/u3v/request.h"

/* Room for one picture: the transfers that bring it, and the block its samples come into. */
typedef struct placido_u3v_slot {
  placido_u3v_transfer *transfers; /* leader, samples, trailer */
  uint8_t *leader, *trailer;
  uint8_t *block;      /* of placido_memory_new_aligned: may be swapped for another */
  size_t block_bytes;
  int64_t arrival_ns;  /* when the leader was first seen to have come; 0: not yet */
} placido_u3v_slot;

/* Pictures and transfers are counted on and on; the place in the ring is the rest. */
typedef struct placido_u3v_ring {
  const placido_u3v_calls *calls;
  void *pipe;
  placido_u3v_layout layout;
  size_t slot_count, slot_transfers; /* transfers of a slot */
  placido_u3v_slot slots[PLACIDO_U3V_BUFFERS_MAX];
  placido_u3v_transfer *transfers;   /* of all slots */
  uint8_t *packets;                  /* leaders and trailers of all slots */
  uint64_t taken;                    /* pictures given back; the next one is the head */
  uint64_t submitted, ended;         /* transfers */
  size_t flying_bytes, flying_max;   /* what the kernel holds for us */
} placido_u3v_ring;

/* `pipe` must outlive the ring. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_u3v_ring_new(placido_u3v_ring **ring, const placido_u3v_calls *calls, void *pipe,
                         const placido_u3v_layout *layout, int slots, placido_error *err);

/* Submits what is free, as far as the kernel's memory for USB goes. DONE, or why the first transfer
 * of all cannot be submitted. */
enum placido_u3v_end placido_u3v_ring_fill(placido_u3v_ring *ring);

/* The picture that is to come next, and whether one of its transfers has not been submitted or is
 * pending. */
placido_u3v_slot *placido_u3v_ring_head(placido_u3v_ring *ring);
bool placido_u3v_ring_is_pending(const placido_u3v_ring *ring, size_t transfer_of_head);

/* How the first transfer ended that ended badly, pictures behind the head's included; DONE: none
 * did. */
enum placido_u3v_end placido_u3v_ring_fault(const placido_u3v_ring *ring);

/* Notes the time at which leaders were first seen to have come. */
void placido_u3v_ring_stamp(placido_u3v_ring *ring);

/* Gives the head back to be filled anew. */
void placido_u3v_ring_next(placido_u3v_ring *ring);

/* Cancels what is pending and frees the ring; NULL is legal. False: the kernel did not give a
 * transfer back within a second. Then its transfers and blocks are never freed, because they may
 * still be written to, and the pipe must not be closed. */
bool placido_u3v_ring_free(placido_u3v_ring *ring);

#endif
