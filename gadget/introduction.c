/* What passes between a simulated device and a host before the host has it. */
#include "gadget/introduction.h"

#include <string.h>

#define INTERFACES_BYTES_MAX (32 * PLACIDO_USBIP_INTERFACE_BYTES)

static placido_usbip_description describe(placido_gadget *gadget) {
  placido_usbip_description description = {.bus_id = PLACIDO_GADGET_BUS_ID,
                                           .speed = gadget->speed};
  const placido_gadget_function *function = gadget->function;
  description.device = function->descriptor(gadget->state, 1, 0, &description.device_size);
  description.configuration =
      function->descriptor(gadget->state, 2, 0, &description.configuration_size);
  return description;
}

int placido_gadget_introduce(placido_gadget_wire *wire, placido_gadget *gadget,
                             enum placido_usbip_greeting greeting, placido_error *err) {
  const placido_usbip_description description = describe(gadget);
  const bool is_list = greeting == PLACIDO_USBIP_LIST;
  uint8_t *answer = placido_gadget_wire_room(
      wire,
      PLACIDO_USBIP_GREETING_BYTES + 4 + PLACIDO_USBIP_DEVICE_BYTES + INTERFACES_BYTES_MAX, err);
  if (!answer) {
    return PLACIDO_MEMORY;
  }
  size_t size = PLACIDO_USBIP_GREETING_BYTES;
  placido_usbip_reply_encode(answer, greeting, 0);
  if (is_list) {
    memcpy(answer + size, "\0\0\0\1", 4); /* one device */
    size += 4;
  }
  const int status = placido_usbip_device_encode(answer + size, &description, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  size += PLACIDO_USBIP_DEVICE_BYTES;
  if (is_list) {
    size += placido_usbip_interfaces_encode(answer + size, INTERFACES_BYTES_MAX, &description);
  }
  placido_gadget_wire_send(wire, size);
  return PLACIDO_OK;
}

int placido_gadget_turn_away(placido_gadget_wire *wire, placido_error *err) {
  uint8_t *answer = placido_gadget_wire_room(wire, PLACIDO_USBIP_GREETING_BYTES, err);
  if (!answer) {
    return PLACIDO_MEMORY;
  }
  placido_usbip_reply_encode(answer, PLACIDO_USBIP_IMPORT, 1);
  placido_gadget_wire_send(wire, PLACIDO_USBIP_GREETING_BYTES);
  return PLACIDO_OK;
}
