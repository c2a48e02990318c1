/* How a picture comes in transfers: the sizes that host and camera agree on, in the registers of
 * the stream interface (SIRM). */
#ifndef PLACIDO_DRIVERS_U3V_LAYOUT_H
#define PLACIDO_DRIVERS_U3V_LAYOUT_H

#include "drivers/u3v/channel.h"

/* Leader, `transfer_count` transfers of `transfer_bytes`, a last one of `final_bytes` (0: none),
 * trailer. All but `required_bytes` are what is asked of the bus: multiples of the camera's
 * alignment and of whole packets. */
typedef struct placido_u3v_layout {
  size_t required_bytes; /* of the picture with all that comes with it */
  size_t leader_bytes, trailer_bytes, transfer_bytes, final_bytes;
  size_t transfer_count;
} placido_u3v_layout;

/* Reads what the camera requires and writes the sizes; `picture_bytes` is what the samples need.
 * The stream must be off. Returns PLACIDO_OK, PLACIDO_INPUT (the camera asks for sizes that make no
 * sense), or what the channel returns. */
int placido_u3v_layout_agree(placido_u3v_layout *layout, placido_u3v_channel *channel,
                             uint64_t sirm_address, size_t picture_bytes, placido_error *err);

/* Bytes of the block that a picture is received into. */
size_t placido_u3v_layout_block_bytes(const placido_u3v_layout *layout);

/* Transfers of one picture, leader and trailer included, and the size of each. */
size_t placido_u3v_layout_transfers(const placido_u3v_layout *layout);
size_t placido_u3v_layout_transfer_bytes(const placido_u3v_layout *layout, size_t index);

#endif
