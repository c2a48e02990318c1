/* Whatever a USB device sends: as packets, as samples, and as the answers to all that a camera is
 * asked before it streams. */
#include "base/memory.h"
#include "drivers/u3v/bootstrap.h"
#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "drivers/u3v/wire/packet.h"
#include "drivers/u3v/wire/pixel.h"
#include "tests/fuzz/target.h"

#include <stdlib.h>
#include <string.h>

/* What is left of the input, and the command that was sent last. */
struct device {
  const uint8_t *data;
  size_t size;
  int64_t clock_ns;
  placido_gencp_packet command;
};

static size_t take(struct device *device, uint8_t *bytes, size_t size) {
  const size_t taken = size < device->size ? size : device->size;
  memcpy(bytes, device->data, taken);
  device->data += taken;
  device->size -= taken;
  return taken;
}

static enum placido_u3v_end device_write(void *pipe, const uint8_t *bytes, size_t size,
                                         int timeout_ms) {
  struct device *device = pipe;
  (void)timeout_ms;
  device->clock_ns += 1000000;
  if (placido_gencp_decode(&device->command, bytes, size, NULL)) {
    abort();
  }
  return device->size > 0 ? PLACIDO_U3V_DONE : PLACIDO_U3V_GONE;
}

/* An answer as it should be, but for the data, which are the input's. */
static size_t answer(struct device *device, uint8_t *bytes, size_t size, uint16_t status) {
  static const uint8_t zeros[65536];
  const placido_gencp_packet packet = {
      .flags = status,
      .command = (uint16_t)(device->command.command + 1),
      .request_id = device->command.request_id,
      .count = (uint16_t)device->command.data_size,
      .data = zeros,
      .data_size = device->command.count,
  };
  const size_t length = placido_gencp_encode(bytes, size, &packet);
  if (length > PLACIDO_GENCP_HEADER_BYTES && device->command.command == PLACIDO_GENCP_READ) {
    take(device, bytes + PLACIDO_GENCP_HEADER_BYTES, length - PLACIDO_GENCP_HEADER_BYTES);
  }
  return length;
}

/* One byte of the input tells how the device answers: below 8 as the transfer ends, below 128 with
 * so many bytes of the input, else properly; 254: asks for time, 255: refuses. */
static enum placido_u3v_end device_read(void *pipe, uint8_t *bytes, size_t size, size_t *received,
                                        int timeout_ms) {
  struct device *device = pipe;
  *received = 0;
  uint8_t kind;
  device->clock_ns += 1000000;
  if (take(device, &kind, 1) == 0) {
    return PLACIDO_U3V_GONE;
  }
  if (kind < 8) {
    device->clock_ns += kind == PLACIDO_U3V_TIMED_OUT ? timeout_ms * INT64_C(1000000) : 0;
    return kind <= PLACIDO_U3V_FAILED ? (enum placido_u3v_end)kind : PLACIDO_U3V_FAILED;
  }
  if (kind < 128) {
    *received = take(device, bytes, kind < size ? kind : size);
  } else if (kind == 254) {
    const placido_gencp_packet packet = {.command = PLACIDO_GENCP_PENDING_ACK,
                                         .request_id = device->command.request_id,
                                         .count = 0xffff};
    *received = placido_gencp_encode(bytes, size, &packet);
  } else {
    *received = answer(device, bytes, size, kind == 255 ? PLACIDO_GENCP_INVALID_ADDRESS : 0);
  }
  return PLACIDO_U3V_DONE;
}

static enum placido_u3v_end device_reset(void *pipe, uint8_t endpoint) {
  (void)pipe;
  return endpoint ? PLACIDO_U3V_FAILED : PLACIDO_U3V_DONE;
}

static int64_t device_clock_ns(void *context) {
  const struct device *device = context;
  return device->clock_ns;
}

static void device_sleep_ms(void *context, int duration_ms) {
  struct device *device = context;
  device->clock_ns += duration_ms * INT64_C(1000000);
}

static void talk(const uint8_t *data, size_t size) {
  struct device device = {.data = data, .size = size};
  const placido_u3v_calls calls = {.write = device_write,
                                   .read = device_read,
                                   .reset = device_reset,
                                   .clock_ns = device_clock_ns,
                                   .sleep_ms = device_sleep_ms,
                                   .context = &device};
  placido_u3v_channel channel;
  if (placido_u3v_channel_open(&channel, &calls, &device, 64, NULL)) {
    return;
  }
  placido_u3v_bootstrap bootstrap;
  char *xml;
  size_t xml_size;
  placido_error err;
  placido_u3v_bootstrap_read(&bootstrap, &channel, &err);
  if (placido_u3v_description_read(&xml, &xml_size, &channel, &err) == PLACIDO_OK &&
      xml[xml_size] != '\0') {
    abort();
  }
  placido_memory_free(xml);
  placido_u3v_channel_write(&channel, bootstrap.sirm_address, &bootstrap, 200, &err);
  placido_u3v_channel_close(&channel);
}

static void decode(const uint8_t *data, size_t size) {
  placido_gencp_packet packet;
  placido_u3v_leader leader;
  placido_u3v_trailer trailer;
  if (placido_gencp_decode(&packet, data, size, NULL) == PLACIDO_OK &&
      packet.data_size > size - PLACIDO_GENCP_HEADER_BYTES) {
    abort();
  }
  placido_u3v_leader_decode(&leader, data, size, NULL);
  placido_u3v_trailer_decode(&trailer, data, size, NULL);
}

/* A picture of the size and format that the first bytes tell, and the same back. */
static void convert(const uint8_t *data, size_t size) {
  if (size < 8) {
    return;
  }
  size_t count;
  const placido_pixel_format *table = placido_pixel_table(&count);
  const placido_pixel_format *format = &table[data[0] % count];
  const int width = placido_read_u16(data + 2), height = placido_read_u16(data + 4);
  placido_frame frame = {0};
  if ((size_t)width * (size_t)height < 1u << 20 &&
      placido_pixel_to_frame(&frame, format, data + 8, size - 8, width, height,
                             placido_read_u16(data + 6), NULL) == PLACIDO_OK) {
    const placido_pixel_format *other = &table[data[1] % count];
    uint8_t *samples = malloc(placido_pixel_row_bytes(other, width) * (size_t)height);
    if (samples) {
      placido_pixel_from_frame(samples, other, &frame, NULL);
    }
    free(samples);
  }
  placido_frame_free(&frame);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  decode(data, size);
  convert(data, size);
  talk(data, size);
  return 0;
}
