/* What every USB3 Vision camera tells of itself before its description file is read. */
#ifndef PLACIDO_DRIVERS_U3V_BOOTSTRAP_H
#define PLACIDO_DRIVERS_U3V_BOOTSTRAP_H

#include "drivers/u3v/channel.h"

typedef struct placido_u3v_bootstrap {
  char vendor[64], model[64], version[64], serial[64], user_name[64];
  uint64_t sbrm_address, sirm_address;
  uint64_t timestamp_increment_ns; /* of the camera's clock; 0: not told */
} placido_u3v_bootstrap;

/* Reads the registers. Returns PLACIDO_OK, PLACIDO_INPUT (no stream channel), or what the channel
 * returns. */
int placido_u3v_bootstrap_read(placido_u3v_bootstrap *bootstrap, placido_u3v_channel *channel,
                               placido_error *err);

/* The camera's description: the newest of its manifest that can be read, unzipped. `*xml` has
 * `*size` bytes and a 0 behind them; caller frees with placido_memory_free. At most
 * PLACIDO_U3V_XML_BYTES_MAX, zipped or not. Returns PLACIDO_OK, PLACIDO_INPUT (no description,
 * too large, not a zip), PLACIDO_MEMORY, or what the channel returns. */
#define PLACIDO_U3V_XML_BYTES_MAX (16u << 20)
int placido_u3v_description_read(char **xml, size_t *size, placido_u3v_channel *channel,
                                 placido_error *err);

#endif
