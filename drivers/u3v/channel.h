/* The dialogue with a camera's registers: one command at a time, repeated where no answer comes,
 * waited for where the camera asks for time. */
#ifndef PLACIDO_DRIVERS_U3V_CHANNEL_H
#define PLACIDO_DRIVERS_U3V_CHANNEL_H

#include "drivers/u3v/pipe.h"

typedef struct placido_u3v_channel {
  const placido_u3v_calls *calls;
  void *pipe;
  size_t packet_bytes;                  /* of the IN endpoint: answers are read in multiples of it */
  size_t max_command_bytes, max_ack_bytes;
  int response_ms;                      /* for one answer */
  uint16_t last_id;
  uint8_t *buffer;                      /* an answer of the greatest size */
  uint64_t retry_count, pending_count;  /* since the channel was opened */
} placido_u3v_channel;

/* Gets ready to talk over an open pipe, and asks the camera for its limits. `pipe` must outlive
 * the channel. Returns PLACIDO_OK, PLACIDO_SYSTEM (no answer), PLACIDO_GONE, PLACIDO_INPUT (limits
 * that no camera has), PLACIDO_MEMORY. */
int placido_u3v_channel_open(placido_u3v_channel *channel, const placido_u3v_calls *calls,
                             void *pipe, size_t packet_bytes, placido_error *err);
void placido_u3v_channel_close(placido_u3v_channel *channel);

/* Reads (writes) `size` bytes at an address, in as many pieces as the camera's limits ask for.
 * Returns PLACIDO_OK, PLACIDO_TIMEOUT (no answer after five tries), PLACIDO_GONE,
 * PLACIDO_UNSUPPORTED (the camera has no such address or refuses: the message says which of its
 * status codes), PLACIDO_SYSTEM. */
int placido_u3v_channel_read(placido_u3v_channel *channel, uint64_t address, void *bytes,
                             size_t size, placido_error *err);
int placido_u3v_channel_write(placido_u3v_channel *channel, uint64_t address, const void *bytes,
                              size_t size, placido_error *err);

/* Little-endian numbers of 4 and 8 bytes. */
int placido_u3v_channel_read_u32(placido_u3v_channel *channel, uint64_t address, uint32_t *value,
                                 placido_error *err);
int placido_u3v_channel_read_u64(placido_u3v_channel *channel, uint64_t address, uint64_t *value,
                                 placido_error *err);
int placido_u3v_channel_write_u32(placido_u3v_channel *channel, uint64_t address, uint32_t value,
                                  placido_error *err);

#endif
