/* What every USB device answers by itself: the standard requests on endpoint 0 (USB 2.0, section
 * 9.4; USB 3.2, section 9.4) and the halts of its endpoints. */
#include "gadget/function.h"

#include <string.h>

#define IN 0x80u
#define TYPE_MASK 0x60u /* of request_type; 0: a standard request */

enum recipient { DEVICE = 0, INTERFACE = 1, ENDPOINT = 2 };

enum descriptor {
  DESCRIPTOR_DEVICE = 1,
  DESCRIPTOR_CONFIGURATION = 2,
  DESCRIPTOR_INTERFACE = 4,
  DESCRIPTOR_ENDPOINT = 5,
  DESCRIPTOR_QUALIFIER = 6,
};

#define QUALIFIER_BYTES 10
#define FEATURE_HALT 0

/* A standard request; `*size` as for placido_gadget_transfer. */
typedef struct request_row {
  uint8_t request_type, request;
  enum placido_gadget_answer (*answer)(placido_gadget *gadget, const placido_gadget_setup *setup,
                                       uint8_t *bytes, size_t *size);
} request_row;

/* Puts as much of an answer as the host asked for. */
static enum placido_gadget_answer give(uint8_t *bytes, size_t *size, const uint8_t *answer,
                                       size_t answer_size) {
  *size = answer_size < *size ? answer_size : *size;
  if (*size > 0) {
    memcpy(bytes, answer, *size);
  }
  return PLACIDO_GADGET_DONE;
}

/* A device of high speed tells with it what it were at full speed: the same. */
static enum placido_gadget_answer give_qualifier(placido_gadget *gadget, uint8_t *bytes,
                                                 size_t *size) {
  size_t device_size = 0;
  const uint8_t *device =
      gadget->function->descriptor(gadget->state, DESCRIPTOR_DEVICE, 0, &device_size);
  if (gadget->speed != PLACIDO_GADGET_HIGH || !device || device_size < 18) {
    return PLACIDO_GADGET_STALL;
  }
  uint8_t qualifier[QUALIFIER_BYTES] = {QUALIFIER_BYTES, DESCRIPTOR_QUALIFIER};
  memcpy(qualifier + 2, device + 2, 6); /* version, class, subclass, protocol, packet size */
  qualifier[8] = device[17];            /* configurations */
  return give(bytes, size, qualifier, sizeof qualifier);
}

static enum placido_gadget_answer get_descriptor(placido_gadget *gadget,
                                                 const placido_gadget_setup *setup, uint8_t *bytes,
                                                 size_t *size) {
  const uint8_t type = (uint8_t)(setup->value >> 8), index = (uint8_t)(setup->value & 0xFF);
  if (type == DESCRIPTOR_QUALIFIER) {
    return give_qualifier(gadget, bytes, size);
  }
  size_t descriptor_size = 0;
  const uint8_t *descriptor =
      gadget->function->descriptor(gadget->state, type, index, &descriptor_size);
  return descriptor ? give(bytes, size, descriptor, descriptor_size) : PLACIDO_GADGET_STALL;
}

/* The descriptor behind the one at `at` in the configuration; its size where there is no more. */
static size_t next_descriptor(const uint8_t *bytes, size_t size, size_t at) {
  const size_t length = bytes[at];
  return length < 2 || at + length + 2 > size ? size : at + length;
}

/* Where the interface's alternate setting begins in the configuration; its size: nowhere. */
static size_t find_interface(const uint8_t *bytes, size_t size, uint8_t interface,
                             uint8_t alternate) {
  size_t at = 0;
  while (at < size && !(bytes[at] >= 9 && bytes[at + 1] == DESCRIPTOR_INTERFACE &&
                        bytes[at + 2] == interface && bytes[at + 3] == alternate)) {
    at = next_descriptor(bytes, size, at);
  }
  return at;
}

static uint32_t *halts_of(placido_gadget *gadget, uint8_t endpoint) {
  return endpoint & IN ? &gadget->halted_in : &gadget->halted_out;
}

static uint32_t halt_bit(uint8_t endpoint) {
  return 1u << (endpoint & 0x0F);
}

static void clear_halts_of(placido_gadget *gadget, const uint8_t *bytes, size_t size, size_t at) {
  for (at = next_descriptor(bytes, size, at);
       at < size && bytes[at + 1] != DESCRIPTOR_INTERFACE; at = next_descriptor(bytes, size, at)) {
    if (bytes[at + 1] == DESCRIPTOR_ENDPOINT && bytes[at] >= 3) {
      *halts_of(gadget, bytes[at + 2]) &= ~halt_bit(bytes[at + 2]);
    }
  }
}

static enum placido_gadget_answer set_interface(placido_gadget *gadget,
                                                const placido_gadget_setup *setup, uint8_t *bytes,
                                                size_t *size) {
  (void)bytes;
  const uint8_t interface = (uint8_t)setup->index, alternate = (uint8_t)setup->value;
  size_t all_size = 0;
  const uint8_t *all =
      gadget->function->descriptor(gadget->state, DESCRIPTOR_CONFIGURATION, 0, &all_size);
  const size_t at = all ? find_interface(all, all_size, interface, alternate) : all_size;
  if (at >= all_size || interface >= PLACIDO_GADGET_INTERFACES) {
    return PLACIDO_GADGET_STALL;
  }
  clear_halts_of(gadget, all, all_size, at);
  gadget->alternates[interface] = alternate;
  if (gadget->function->configured) {
    gadget->function->configured(gadget->state, interface, alternate);
  }
  *size = 0;
  return PLACIDO_GADGET_DONE;
}

static enum placido_gadget_answer get_interface(placido_gadget *gadget,
                                                const placido_gadget_setup *setup, uint8_t *bytes,
                                                size_t *size) {
  if (setup->index >= PLACIDO_GADGET_INTERFACES) {
    return PLACIDO_GADGET_STALL;
  }
  return give(bytes, size, &gadget->alternates[setup->index], 1);
}

static enum placido_gadget_answer set_configuration(placido_gadget *gadget,
                                                    const placido_gadget_setup *setup,
                                                    uint8_t *bytes, size_t *size) {
  (void)bytes;
  size_t all_size = 0;
  const uint8_t *all =
      gadget->function->descriptor(gadget->state, DESCRIPTOR_CONFIGURATION, 0, &all_size);
  if (setup->value != 0 && (!all || all_size < 9 || setup->value != all[5])) {
    return PLACIDO_GADGET_STALL;
  }
  gadget->configuration = (uint8_t)setup->value;
  gadget->halted_in = gadget->halted_out = 0;
  memset(gadget->alternates, 0, sizeof gadget->alternates);
  if (gadget->function->configured) {
    gadget->function->configured(gadget->state, 0xFF, gadget->configuration);
  }
  *size = 0;
  return PLACIDO_GADGET_DONE;
}

static enum placido_gadget_answer get_configuration(placido_gadget *gadget,
                                                    const placido_gadget_setup *setup,
                                                    uint8_t *bytes, size_t *size) {
  (void)setup;
  return give(bytes, size, &gadget->configuration, 1);
}

static enum placido_gadget_answer get_status(placido_gadget *gadget,
                                             const placido_gadget_setup *setup, uint8_t *bytes,
                                             size_t *size) {
  uint8_t status[2] = {0};
  const uint8_t endpoint = (uint8_t)setup->index;
  if (setup->request_type == (IN | ENDPOINT)) {
    status[0] = (*halts_of(gadget, endpoint) & halt_bit(endpoint)) != 0;
  }
  return give(bytes, size, status, sizeof status);
}

static enum placido_gadget_answer change_halt(placido_gadget *gadget,
                                              const placido_gadget_setup *setup, size_t *size,
                                              int is_halted) {
  const uint8_t endpoint = (uint8_t)setup->index;
  *size = 0;
  if (setup->value != FEATURE_HALT) {
    return PLACIDO_GADGET_STALL;
  }
  if ((endpoint & 0x0F) == 0) {
    return PLACIDO_GADGET_DONE; /* endpoint 0 forgets a halt with the next request anyway */
  }
  if (is_halted) {
    *halts_of(gadget, endpoint) |= halt_bit(endpoint);
  } else {
    *halts_of(gadget, endpoint) &= ~halt_bit(endpoint);
  }
  if (gadget->function->halted) {
    gadget->function->halted(gadget->state, endpoint, is_halted);
  }
  return PLACIDO_GADGET_DONE;
}

static enum placido_gadget_answer set_halt(placido_gadget *gadget,
                                           const placido_gadget_setup *setup, uint8_t *bytes,
                                           size_t *size) {
  (void)bytes;
  return change_halt(gadget, setup, size, 1);
}

static enum placido_gadget_answer clear_halt(placido_gadget *gadget,
                                             const placido_gadget_setup *setup, uint8_t *bytes,
                                             size_t *size) {
  (void)bytes;
  return change_halt(gadget, setup, size, 0);
}

/* Addresses, power saving and delays: of no effect on a device without a wire. */
static enum placido_gadget_answer accept(placido_gadget *gadget, const placido_gadget_setup *setup,
                                         uint8_t *bytes, size_t *size) {
  (void)gadget;
  (void)bytes;
  *size = setup->length < *size ? setup->length : *size;
  return PLACIDO_GADGET_DONE;
}

static const request_row requests[] = {
    {IN | DEVICE, 0, get_status},
    {IN | INTERFACE, 0, get_status},
    {IN | ENDPOINT, 0, get_status},
    {ENDPOINT, 1, clear_halt},
    {ENDPOINT, 3, set_halt},
    {DEVICE, 1, accept},    /* CLEAR_FEATURE: U1, U2, remote wake-up */
    {DEVICE, 3, accept},    /* SET_FEATURE */
    {INTERFACE, 1, accept}, /* of function suspend */
    {INTERFACE, 3, accept},
    {DEVICE, 5, accept}, /* SET_ADDRESS */
    {IN | DEVICE, 6, get_descriptor},
    {IN | DEVICE, 8, get_configuration},
    {DEVICE, 9, set_configuration},
    {IN | INTERFACE, 10, get_interface},
    {INTERFACE, 11, set_interface},
    {DEVICE, 0x30, accept}, /* SET_SEL */
    {DEVICE, 0x31, accept}, /* SET_ISOCH_DELAY */
};

static enum placido_gadget_answer control(placido_gadget *gadget,
                                          const placido_gadget_setup *setup, uint8_t *bytes,
                                          size_t *size) {
  if (*size > setup->length) {
    *size = setup->length;
  }
  if ((setup->request_type & TYPE_MASK) == 0) {
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
      if (requests[i].request_type == setup->request_type &&
          requests[i].request == setup->request) {
        return requests[i].answer(gadget, setup, bytes, size);
      }
    }
  }
  return gadget->function->control ? gadget->function->control(gadget->state, setup, bytes, size)
                                   : PLACIDO_GADGET_STALL;
}

enum placido_gadget_answer placido_gadget_transfer(placido_gadget *gadget, uint8_t endpoint,
                                                   const placido_gadget_setup *setup,
                                                   uint8_t *bytes, size_t *size) {
  const placido_gadget_function *function = gadget->function;
  enum placido_gadget_answer answer = PLACIDO_GADGET_STALL;
  size_t sent = 0;
  if (setup) {
    answer = control(gadget, setup, bytes, size);
  } else if (*halts_of(gadget, endpoint) & halt_bit(endpoint)) {
    answer = PLACIDO_GADGET_STALL;
  } else if (endpoint & IN) {
    answer = function->in ? function->in(gadget->state, endpoint, bytes, *size, &sent)
                          : PLACIDO_GADGET_STALL;
    *size = sent < *size ? sent : *size;
  } else {
    answer = function->out ? function->out(gadget->state, endpoint, bytes, *size)
                           : PLACIDO_GADGET_STALL;
  }
  if (answer == PLACIDO_GADGET_DONE) {
    return answer;
  }
  *size = 0;
  if (answer == PLACIDO_GADGET_STALL && !setup) {
    *halts_of(gadget, endpoint) |= halt_bit(endpoint); /* until the host clears it */
  }
  return answer;
}

int64_t placido_gadget_tick(placido_gadget *gadget, int64_t now_ns) {
  return gadget->function->tick ? gadget->function->tick(gadget->state, now_ns) : INT64_MAX;
}
