/* The device's side of USB without a wire: what a simulated device answers to each transfer.
 * A table of functions over a state; one thread; time comes from outside, so that a test can play
 * an hour in a moment. */
#ifndef PLACIDO_GADGET_FUNCTION_H
#define PLACIDO_GADGET_FUNCTION_H

#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

/* How a transfer is answered. */
enum placido_gadget_answer {
  PLACIDO_GADGET_DONE,
  PLACIDO_GADGET_LATER, /* nothing to say yet: asked again after the next tick or transfer */
  PLACIDO_GADGET_STALL,
};

enum placido_gadget_speed { PLACIDO_GADGET_HIGH = 3, PLACIDO_GADGET_SUPER = 5 }; /* as vhci counts */

typedef struct placido_gadget_setup {
  uint8_t request_type, request;
  uint16_t value, index, length;
} placido_gadget_setup;

typedef struct placido_gadget_function {
  const char *name; /* "u3v" */
  uint16_t vendor_id, product_id;

  /* Borrowed bytes of a descriptor by type and index; NULL: there is none. Type 1 device, 2
   * configuration with all that belongs to it, 3 string (index 0: languages), 15 BOS. */
  const uint8_t *(*descriptor)(void *state, uint8_t type, uint8_t index, size_t *size);

  /* Requests on endpoint 0 but the standard ones, which the core answers (descriptors, addresses,
   * configuration, interface, halt). `data` is what the host sends (request_type bit 7 clear) or
   * room for `*size` bytes of the answer, whose number is put there. */
  enum placido_gadget_answer (*control)(void *state, const placido_gadget_setup *setup,
                                        uint8_t *data, size_t *size);
  /* An alternate setting of an interface was chosen (SET_INTERFACE), or configuration (0 or 1:
   * interface 0xFF). NULL: of no interest. */
  void (*configured)(void *state, uint8_t interface, uint8_t alternate);

  /* Bytes that came on an OUT endpoint. */
  enum placido_gadget_answer (*out)(void *state, uint8_t endpoint, const uint8_t *bytes,
                                    size_t size);
  /* Fills up to `size` bytes of one transfer on an IN endpoint (address with bit 7). A transfer of
   * fewer bytes than asked for is a short one, as on the wire. */
  enum placido_gadget_answer (*in)(void *state, uint8_t endpoint, uint8_t *bytes, size_t size,
                                   size_t *sent);
  /* The host halted an endpoint or cleared the halt. */
  void (*halted)(void *state, uint8_t endpoint, int is_halted);

  /* Lets time pass until now_ns (monotonic); returns when it wants to be called next. */
  int64_t (*tick)(void *state, int64_t now_ns);

  /* Whether the device unplugs itself now, to come back as after power-up: told once. NULL: it
   * never does. */
  int (*resets)(void *state);
} placido_gadget_function;

#define PLACIDO_GADGET_INTERFACES 8 /* at most, of a device */

/* A device: a function, its state, and what the core keeps for it. Plain; zero but for the first
 * two and speed. */
typedef struct placido_gadget {
  const placido_gadget_function *function;
  void *state;
  enum placido_gadget_speed speed;
  uint8_t configuration;
  uint32_t halted_in, halted_out; /* a bit an endpoint number */
  uint8_t alternates[PLACIDO_GADGET_INTERFACES]; /* setting chosen for each interface */
} placido_gadget;

/* One transfer, with everything the core itself answers (standard requests, halts). For a control
 * transfer endpoint is 0 and `setup` given; else `setup` is NULL and the address has bit 7 for IN.
 * `bytes` has `*size` bytes sent by the host, or room for as many; then `*size` is what was taken
 * or given. An endpoint that answers a transfer with a stall is halted until the host clears it.
 */
enum placido_gadget_answer placido_gadget_transfer(placido_gadget *gadget, uint8_t endpoint,
                                                   const placido_gadget_setup *setup,
                                                   uint8_t *bytes, size_t *size);
int64_t placido_gadget_tick(placido_gadget *gadget, int64_t now_ns);

#endif
