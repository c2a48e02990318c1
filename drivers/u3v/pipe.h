/* The bytes below a USB3 Vision camera: what libusb does for us, or a script in tests. */
#ifndef PLACIDO_DRIVERS_U3V_PIPE_H
#define PLACIDO_DRIVERS_U3V_PIPE_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How a transfer ended. */
enum placido_u3v_end {
  PLACIDO_U3V_DONE,      /* whole or short: `received` tells */
  PLACIDO_U3V_TIMED_OUT, /* `received` bytes came all the same */
  PLACIDO_U3V_STALLED,   /* the endpoint is halted until it is reset */
  PLACIDO_U3V_OVERFLOW,  /* the camera sent more than was asked for */
  PLACIDO_U3V_CANCELLED,
  PLACIDO_U3V_GONE,      /* unplugged */
  PLACIDO_U3V_FAILED,    /* what else the bus or the kernel says; no memory for USB left */
};

/* One asynchronous bulk read. The caller zeroes it, sets bytes and size, and leaves it and the
 * bytes in place while it is pending. */
typedef struct placido_u3v_transfer {
  uint8_t *bytes;
  size_t size;
  size_t received;
  enum placido_u3v_end end; /* once it is pending no longer */
  bool is_pending;
  void *own;                /* the pipe's; released by `forget` */
} placido_u3v_transfer;

/* A USB device that says it is a USB3 Vision camera. Strings are bounded, ended, and of printable
 * characters, whatever the device sent. */
typedef struct placido_u3v_found {
  char place[32];  /* bus and ports: 4-1.2; stays for as long as the plug stays where it is */
  char vendor[64], model[64], serial[64], version[64], user_name[64], guid[64];
  uint16_t vendor_id, product_id;
  uint8_t control_interface, control_out, control_in;
  uint8_t stream_interface, stream_in;
  int control_packet_bytes, stream_packet_bytes; /* of the IN endpoints, 1 to 1,024 */
  int speed_mbit;                                /* 12, 480, 5000 ...; 0: unknown */
} placido_u3v_found;

typedef struct placido_u3v_calls {
  /* Calls `found` for every such device; stops with its value where that is not 0. `context` is
   * this struct's. */
  int (*each)(void *context, int (*found)(void *user, const placido_u3v_found *device), void *user,
              placido_error *err);
  /* Opens the device and claims both interfaces. PLACIDO_GONE where it is not there any longer,
   * PLACIDO_SYSTEM (no permission: says how to get it; busy). */
  int (*open)(void *context, void **pipe, const placido_u3v_found *device, placido_error *err);
  void (*close)(void *pipe); /* nothing is pending; NULL is legal */

  /* Whole within timeout_ms or not at all. */
  enum placido_u3v_end (*write)(void *pipe, const uint8_t *bytes, size_t size, int timeout_ms);
  /* One answer on the control channel; at most `size` bytes. */
  enum placido_u3v_end (*read)(void *pipe, uint8_t *bytes, size_t size, size_t *received,
                               int timeout_ms);

  /* Starts a read of the stream endpoint, behind those that are pending. Anything but DONE: it is
   * not pending. */
  enum placido_u3v_end (*submit)(void *pipe, placido_u3v_transfer *transfer);
  /* Asks a pending transfer to end; `wait` tells when it has. */
  void (*cancel)(void *pipe, placido_u3v_transfer *transfer);
  /* Waits until some transfer has ended, or for timeout_ms; 0: only looks. */
  void (*wait)(void *pipe, int timeout_ms);
  void (*forget)(void *pipe, placido_u3v_transfer *transfer); /* not pending; zeroed is legal */

  /* Halts an endpoint and clears the halt, so that both sides begin anew (USB3 Vision). Endpoint 0
   * stands for both of the control channel. */
  enum placido_u3v_end (*reset)(void *pipe, uint8_t endpoint);

  int64_t (*clock_ns)(void *context); /* monotonic */
  void (*sleep_ms)(void *context, int duration_ms);
  void *context;
} placido_u3v_calls;

/* libusb's. Every open pipe has a context of its own, so that nothing is shared. */
const placido_u3v_calls *placido_u3v_libusb(void);

#endif
