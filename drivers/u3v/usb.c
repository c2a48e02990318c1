/* The pipe to a camera over libusb. Events are handled inside `wait` and the transfers that block:
 * there are no threads here. */
#include "drivers/u3v/usb.h"

#include "base/clock.h"
#include "base/memory.h"

#include <string.h>

#define RESET_TIMEOUT_MS 1000

typedef struct usb_pipe {
  libusb_context *usb;
  libusb_device_handle *handle;
  placido_u3v_found device;
  int has_ended; /* some transfer, since the last look */
} usb_pipe;

/* What a transfer has of its own. */
typedef struct flight {
  struct libusb_transfer *usb;
  usb_pipe *pipe;
  placido_u3v_transfer *transfer;
} flight;

static enum placido_u3v_end end_of_error(int code) {
  static const struct {
    int code;
    enum placido_u3v_end end;
  } ends[] = {
      {LIBUSB_SUCCESS, PLACIDO_U3V_DONE},          {LIBUSB_ERROR_TIMEOUT, PLACIDO_U3V_TIMED_OUT},
      {LIBUSB_ERROR_PIPE, PLACIDO_U3V_STALLED},    {LIBUSB_ERROR_OVERFLOW, PLACIDO_U3V_OVERFLOW},
      {LIBUSB_ERROR_NO_DEVICE, PLACIDO_U3V_GONE},
  };
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    if (ends[i].code == code) {
      return ends[i].end;
    }
  }
  return PLACIDO_U3V_FAILED;
}

static enum placido_u3v_end end_of_transfer(enum libusb_transfer_status status) {
  static const enum placido_u3v_end ends[] = {
      [LIBUSB_TRANSFER_COMPLETED] = PLACIDO_U3V_DONE,
      [LIBUSB_TRANSFER_ERROR] = PLACIDO_U3V_FAILED,
      [LIBUSB_TRANSFER_TIMED_OUT] = PLACIDO_U3V_TIMED_OUT,
      [LIBUSB_TRANSFER_CANCELLED] = PLACIDO_U3V_CANCELLED,
      [LIBUSB_TRANSFER_STALL] = PLACIDO_U3V_STALLED,
      [LIBUSB_TRANSFER_NO_DEVICE] = PLACIDO_U3V_GONE,
      [LIBUSB_TRANSFER_OVERFLOW] = PLACIDO_U3V_OVERFLOW,
  };
  return (size_t)status < sizeof ends / sizeof *ends ? ends[status] : PLACIDO_U3V_FAILED;
}

static int64_t usb_clock_ns(void *context) {
  (void)context;
  return placido_clock_now_ns();
}

static void usb_sleep_ms(void *context, int duration_ms) {
  (void)context;
  placido_clock_monotonic.sleep_ms(duration_ms);
}

static void usb_close(void *pointer) {
  usb_pipe *pipe = pointer;
  if (!pipe) {
    return;
  }
  if (pipe->handle) {
    libusb_release_interface(pipe->handle, pipe->device.stream_interface);
    libusb_release_interface(pipe->handle, pipe->device.control_interface);
    libusb_close(pipe->handle);
  }
  if (pipe->usb) {
    libusb_exit(pipe->usb);
  }
  placido_memory_free(pipe);
}

/* A sentence for what libusb says of an attempt to get at the camera. */
static int refused(const placido_u3v_found *device, int code, placido_error *err) {
  switch (code) {
  case LIBUSB_ERROR_NO_DEVICE:
  case LIBUSB_ERROR_NOT_FOUND:
    return placido_error_set(err, PLACIDO_GONE,
                             "the camera %s %s is not at USB place %s any longer", device->vendor,
                             device->model, device->place);
  case LIBUSB_ERROR_ACCESS:
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "no permission to use the camera %s %s at USB place %s: install "
                             "Placido's udev rules and plug it in anew, or join the group plugdev",
                             device->vendor, device->model, device->place);
  case LIBUSB_ERROR_BUSY:
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "the camera %s %s at USB place %s is in use by another program",
                             device->vendor, device->model, device->place);
  case LIBUSB_ERROR_NO_MEM:
    return placido_error_set(err, PLACIDO_MEMORY, "no memory for the camera %s %s",
                             device->vendor, device->model);
  default:
    return placido_error_set(err, PLACIDO_SYSTEM, "the camera %s %s at USB place %s: %s",
                             device->vendor, device->model, device->place,
                             libusb_strerror(code));
  }
}

/* Returns libusb's code. */
static int open_handle(usb_pipe *pipe) {
  libusb_device *device = placido_u3v_usb_at(pipe->usb, pipe->device.place);
  if (!device) {
    return LIBUSB_ERROR_NO_DEVICE;
  }
  int code = libusb_open(device, &pipe->handle);
  libusb_unref_device(device);
  if (code) {
    pipe->handle = NULL;
    return code;
  }
  libusb_set_auto_detach_kernel_driver(pipe->handle, 1);
  code = libusb_claim_interface(pipe->handle, pipe->device.control_interface);
  return code ? code : libusb_claim_interface(pipe->handle, pipe->device.stream_interface);
}

static int usb_open(void *context, void **pointer, const placido_u3v_found *device,
                    placido_error *err) {
  (void)context;
  *pointer = NULL;
  usb_pipe *pipe = placido_memory_new(1, sizeof *pipe, err);
  if (!pipe) {
    return PLACIDO_MEMORY;
  }
  pipe->device = *device;
  int code = libusb_init(&pipe->usb);
  if (code) {
    pipe->usb = NULL;
  } else {
    code = open_handle(pipe);
  }
  if (code) {
    usb_close(pipe);
    return refused(device, code, err);
  }
  *pointer = pipe;
  return PLACIDO_OK;
}

static enum placido_u3v_end usb_write(void *pointer, const uint8_t *bytes, size_t size,
                                      int timeout_ms) {
  usb_pipe *pipe = pointer;
  int sent = 0;
  /* libusb's buffers are for both directions; it does not write into one that is sent. */
  const int code =
      libusb_bulk_transfer(pipe->handle, pipe->device.control_out, (unsigned char *)bytes,
                           (int)size, &sent, timeout_ms > 0 ? (unsigned)timeout_ms : 1);
  return code == 0 && (size_t)sent != size ? PLACIDO_U3V_TIMED_OUT : end_of_error(code);
}

static enum placido_u3v_end usb_read(void *pointer, uint8_t *bytes, size_t size, size_t *received,
                                     int timeout_ms) {
  usb_pipe *pipe = pointer;
  int got = 0;
  const int code = libusb_bulk_transfer(pipe->handle, pipe->device.control_in, bytes, (int)size,
                                        &got, timeout_ms > 0 ? (unsigned)timeout_ms : 1);
  *received = got > 0 ? (size_t)got : 0;
  return end_of_error(code);
}

/* libusb calls this when a transfer has ended, from within `wait`. */
static void LIBUSB_CALL ended(struct libusb_transfer *usb) {
  flight *own = usb->user_data;
  placido_u3v_transfer *transfer = own->transfer;
  transfer->received = usb->actual_length > 0 ? (size_t)usb->actual_length : 0;
  transfer->end = end_of_transfer(usb->status);
  transfer->is_pending = false;
  own->pipe->has_ended = 1;
}

static flight *new_flight(usb_pipe *pipe, placido_u3v_transfer *transfer) {
  flight *own = placido_memory_new(1, sizeof *own, NULL);
  if (own) {
    *own = (flight){.usb = libusb_alloc_transfer(0), .pipe = pipe, .transfer = transfer};
    if (!own->usb) {
      placido_memory_free(own);
      return NULL;
    }
  }
  return own;
}

static enum placido_u3v_end usb_submit(void *pointer, placido_u3v_transfer *transfer) {
  usb_pipe *pipe = pointer;
  if (!transfer->own) {
    transfer->own = new_flight(pipe, transfer);
    if (!transfer->own) {
      return PLACIDO_U3V_FAILED;
    }
  }
  flight *own = transfer->own;
  libusb_fill_bulk_transfer(own->usb, pipe->handle, pipe->device.stream_in, transfer->bytes,
                            (int)transfer->size, ended, own, 0);
  transfer->received = 0;
  const int code = libusb_submit_transfer(own->usb);
  transfer->is_pending = code == 0;
  transfer->end = end_of_error(code);
  return transfer->end;
}

static void usb_cancel(void *pointer, placido_u3v_transfer *transfer) {
  (void)pointer;
  flight *own = transfer->own;
  if (own && transfer->is_pending) {
    libusb_cancel_transfer(own->usb); /* where it has ended already, `wait` tells so */
  }
}

static void usb_wait(void *pointer, int timeout_ms) {
  usb_pipe *pipe = pointer;
  struct timeval timeout = {.tv_sec = timeout_ms / 1000, .tv_usec = timeout_ms % 1000 * 1000};
  pipe->has_ended = 0;
  libusb_handle_events_timeout_completed(pipe->usb, &timeout, &pipe->has_ended);
}

static void usb_forget(void *pointer, placido_u3v_transfer *transfer) {
  (void)pointer;
  flight *own = transfer->own;
  if (own) {
    libusb_free_transfer(own->usb);
    placido_memory_free(own);
    transfer->own = NULL;
  }
}

static enum placido_u3v_end reset_one(usb_pipe *pipe, uint8_t endpoint) {
  /* The device halts first: clearing a halt that it does not know of leaves its toggle alone. */
  const int code = libusb_control_transfer(
      pipe->handle, LIBUSB_RECIPIENT_ENDPOINT, LIBUSB_REQUEST_SET_FEATURE, 0 /* ENDPOINT_HALT */,
      endpoint, NULL, 0, RESET_TIMEOUT_MS);
  if (code == LIBUSB_ERROR_NO_DEVICE) {
    return PLACIDO_U3V_GONE;
  }
  return end_of_error(libusb_clear_halt(pipe->handle, endpoint));
}

static enum placido_u3v_end usb_reset(void *pointer, uint8_t endpoint) {
  usb_pipe *pipe = pointer;
  if (endpoint) {
    return reset_one(pipe, endpoint);
  }
  const enum placido_u3v_end out = reset_one(pipe, pipe->device.control_out);
  const enum placido_u3v_end in = reset_one(pipe, pipe->device.control_in);
  return out ? out : in;
}

const placido_u3v_calls *placido_u3v_libusb(void) {
  static const placido_u3v_calls calls = {
      .each = placido_u3v_usb_each,
      .open = usb_open,
      .close = usb_close,
      .write = usb_write,
      .read = usb_read,
      .submit = usb_submit,
      .cancel = usb_cancel,
      .wait = usb_wait,
      .forget = usb_forget,
      .reset = usb_reset,
      .clock_ns = usb_clock_ns,
      .sleep_ms = usb_sleep_ms,
  };
  return &calls;
}
