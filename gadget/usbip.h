/* USB/IP's packets: bytes to structs and back (Documentation/usb/usbip_protocol.rst of the kernel).
 * Everything is big-endian; nothing here waits, sends or keeps state. The side of the one who has
 * the device. */
#ifndef PLACIDO_GADGET_USBIP_H
#define PLACIDO_GADGET_USBIP_H

#include "gadget/function.h"

#include <placido/status.h>
#include <stdbool.h>

#define PLACIDO_USBIP_HEADER_BYTES 48
#define PLACIDO_USBIP_TRANSFER_BYTES_MAX (16u << 20) /* the kernel's limit for all of a device */

enum placido_usbip_command {
  PLACIDO_USBIP_SUBMIT = 1,
  PLACIDO_USBIP_UNLINK = 2,
};

/* What the host wants, once a device is attached. */
typedef struct placido_usbip_request {
  enum placido_usbip_command command;
  uint32_t sequence;
  uint8_t endpoint; /* address: bit 7 for IN; 0: control */
  bool is_in;
  size_t size; /* of the transfer; of an OUT one, bytes that follow the header */
  placido_gadget_setup setup; /* of a control transfer */
  uint32_t unlinked;          /* sequence number of the transfer that is taken back */
} placido_usbip_request;

/* PLACIDO_INPUT: a command that there is not, an endpoint, a size or a direction that no transfer
 * has, or an isochronous transfer. */
int placido_usbip_request_decode(placido_usbip_request *request,
                                 const uint8_t bytes[PLACIDO_USBIP_HEADER_BYTES],
                                 placido_error *err);

/* Values of `status`, as the kernel numbers errors on every machine. */
#define PLACIDO_USBIP_STALLED (-32)   /* EPIPE */
#define PLACIDO_USBIP_UNLINKED (-104) /* ECONNRESET */

/* The header of an answer; `size` bytes were taken, or follow it. */
void placido_usbip_submitted_encode(uint8_t bytes[PLACIDO_USBIP_HEADER_BYTES], uint32_t sequence,
                                    int status, size_t size);
/* Status PLACIDO_USBIP_UNLINKED, or 0: it was answered before. */
void placido_usbip_unlinked_encode(uint8_t bytes[PLACIDO_USBIP_HEADER_BYTES], uint32_t sequence,
                                   int status);

/* Before a device is attached: the list of devices, and the wish for one. */
#define PLACIDO_USBIP_GREETING_BYTES 8
#define PLACIDO_USBIP_BUS_ID_BYTES 32
#define PLACIDO_USBIP_DEVICE_BYTES 312
#define PLACIDO_USBIP_INTERFACE_BYTES 4

enum placido_usbip_greeting {
  PLACIDO_USBIP_LIST = 0x8005,
  PLACIDO_USBIP_IMPORT = 0x8003, /* PLACIDO_USBIP_BUS_ID_BYTES follow */
};

/* PLACIDO_INPUT: another version, or neither of both. */
int placido_usbip_greeting_decode(enum placido_usbip_greeting *greeting,
                                  const uint8_t bytes[PLACIDO_USBIP_GREETING_BYTES],
                                  placido_error *err);
/* The header of the answer to a greeting; status 0: it is granted. */
void placido_usbip_reply_encode(uint8_t bytes[PLACIDO_USBIP_GREETING_BYTES],
                                enum placido_usbip_greeting greeting, uint32_t status);

/* What descriptors tell of a device, as bytes of `size`. */
typedef struct placido_usbip_description {
  const char *bus_id;
  enum placido_gadget_speed speed;
  const uint8_t *device, *configuration;
  size_t device_size, configuration_size;
} placido_usbip_description;

/* A device as both answers have it. PLACIDO_INPUT: descriptors too short for what they are. */
int placido_usbip_device_encode(uint8_t bytes[PLACIDO_USBIP_DEVICE_BYTES],
                                const placido_usbip_description *description,
                                placido_error *err);
/* Its interfaces, of which the first `capacity` bytes hold as many as the device's own description
 * says; they follow it in a list. Returns how many bytes that is; 0: they do not fit. */
size_t placido_usbip_interfaces_encode(uint8_t *bytes, size_t capacity,
                                       const placido_usbip_description *description);

#endif
