/* A USB3 Vision camera played from a script, below the pipe: the calls that the driver makes. */
#include "tests/drivers/u3v_fake.h"

#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "drivers/u3v/wire/registers.h"

#include <stdlib.h>
#include <string.h>

#define CALL_NS 20000
#define PACKET_BYTES 1024

struct fake fake;

/* What a driver left to the kernel for ever, so that a search for leaks finds it here. */
static struct {
  void *transfer, *pipe;
} abandoned[8];

static void keep_abandoned(void) {
  for (size_t i = 0; fake.pending_count > 0 && i < 8; i++) {
    if (!abandoned[i].transfer) {
      abandoned[i].transfer = fake.pending[0].transfer;
      abandoned[i].pipe = fake.pending[0].pipe;
      return;
    }
  }
}

void fake_reset(void) {
  keep_abandoned();
  memset(&fake, 0, sizeof fake);
  fake.clock_ns = 1000000000;
  fake.camera_ahead_ns = 77000000000;
  fake.usb_memory = (size_t)16 << 20;
  fake.found_count = 1;
  fake.found[0] = (placido_u3v_found){.place = "4-1.2",
                                      .vendor = "Test",
                                      .model = "Fake",
                                      .serial = "S1",
                                      .user_name = "left eye",
                                      .control_out = 0x01,
                                      .control_in = 0x81,
                                      .stream_interface = 1,
                                      .stream_in = 0x82,
                                      .control_packet_bytes = PACKET_BYTES,
                                      .stream_packet_bytes = PACKET_BYTES,
                                      .speed_mbit = 5000};
  fake_power_on();
}

void fake_next(struct fake_picture picture) {
  fake.script[fake.script_count++] = picture;
}

/* A handle on the camera as it was plugged in. */
struct handle {
  int generation;
};

/* Whether this call is the one to fail, and how. */
static enum placido_u3v_end fault(const struct handle *handle) {
  fake.call_count++;
  fake.clock_ns += CALL_NS;
  fake_catch_up();
  if (handle && (fake.is_gone || handle->generation != fake.generation)) {
    return PLACIDO_U3V_GONE;
  }
  if (fake.fail_at > 0 && (fake.call_count == fake.fail_at ||
                           (fake.fails_for_ever && fake.call_count > fake.fail_at))) {
    if (fake.fail_end == PLACIDO_U3V_GONE) {
      fake_unplug();
    }
    return fake.fail_end;
  }
  return PLACIDO_U3V_DONE;
}

static int fake_each(void *context, int (*found)(void *user, const placido_u3v_found *device),
                     void *user, placido_error *err) {
  (void)context;
  if (fault(NULL)) {
    return placido_error_set(err, PLACIDO_SYSTEM, "the list fails");
  }
  int status = 0;
  for (int i = 0; !status && !fake.is_gone && i < fake.found_count; i++) {
    status = found(user, &fake.found[i]);
  }
  return status;
}

static int fake_open(void *context, void **pipe, const placido_u3v_found *device,
                     placido_error *err) {
  (void)context;
  *pipe = NULL;
  if (fault(NULL)) {
    return placido_error_set(err, PLACIDO_SYSTEM, "the camera at %s cannot be opened",
                             device->place);
  }
  if (fake.is_gone) {
    return placido_error_set(err, PLACIDO_GONE, "no camera at %s", device->place);
  }
  struct handle *handle = malloc(sizeof *handle);
  if (!handle) {
    return placido_error_set(err, PLACIDO_MEMORY, "no memory");
  }
  handle->generation = fake.generation;
  fake_describe();
  fake.open_count++;
  *pipe = handle;
  return PLACIDO_OK;
}

static void fake_close(void *pipe) {
  if (pipe) {
    fake.open_count--;
    free(pipe);
  }
}

static void act_on(uint32_t address) {
  const uint32_t value = fake_get(address);
  if (address == FAKE_START && value == 1) {
    fake.is_acquiring = true;
    fake.next_ns = fake.clock_ns + FAKE_PERIOD_NS;
    fake.next_id = 0;
    fake.starts++;
  } else if (address == FAKE_STOP && value == 1) {
    fake.is_acquiring = false;
    fake.queue_count = 0;
  } else if (address == FAKE_TRIGGER && value == 1) {
    fake.triggers++;
  } else if (address == PLACIDO_ABRM_TIMESTAMP_LATCH) {
    placido_write_u64(fake.memory + PLACIDO_ABRM_TIMESTAMP,
                      fake.has_no_clock ? 0 : (uint64_t)(fake.clock_ns + fake.camera_ahead_ns));
  }
}

static enum placido_u3v_end fake_write(void *pipe, const uint8_t *bytes, size_t size,
                                       int timeout_ms) {
  placido_gencp_packet command;
  const enum placido_u3v_end end = fault(pipe);
  (void)timeout_ms;
  if (end || placido_gencp_decode(&command, bytes, size, NULL)) {
    return end;
  }
  fake.clock_ns += fake.slow_ns;
  placido_gencp_packet answer = {.command = (uint16_t)(command.command + 1),
                                 .request_id = command.request_id,
                                 .count = command.count};
  if (command.address >= FAKE_MEMORY ||
      FAKE_MEMORY - command.address < (command.data ? command.data_size : command.count)) {
    answer.flags = PLACIDO_GENCP_INVALID_ADDRESS;
  } else if (command.command == PLACIDO_GENCP_WRITE) {
    memcpy(fake.memory + command.address, command.data, command.data_size);
    answer.count = (uint16_t)command.data_size;
    act_on((uint32_t)command.address);
  } else {
    placido_write_u64(fake.memory + FAKE_SIRM + PLACIDO_SIRM_REQUIRED_PAYLOAD,
                      fake_picture_bytes() + fake.spare_bytes);
    answer.data = fake.memory + command.address;
    answer.data_size = command.count;
  }
  fake.answer_size = placido_gencp_encode(fake.answer, sizeof fake.answer, &answer);
  return PLACIDO_U3V_DONE;
}

static enum placido_u3v_end fake_read(void *pipe, uint8_t *bytes, size_t size, size_t *received,
                                      int timeout_ms) {
  *received = 0;
  const enum placido_u3v_end end = fault(pipe);
  if (end) {
    return end;
  }
  if (fake.answer_size == 0 || fake.answers_not || fake.answer_size > size) {
    fake.clock_ns += (int64_t)timeout_ms * 1000000;
    fake.answer_size = 0;
    return PLACIDO_U3V_TIMED_OUT;
  }
  memcpy(bytes, fake.answer, fake.answer_size);
  *received = fake.answer_size;
  fake.answer_size = 0;
  return PLACIDO_U3V_DONE;
}

static enum placido_u3v_end fake_submit(void *pipe, placido_u3v_transfer *transfer) {
  const enum placido_u3v_end end = fault(pipe);
  if (end || fake.flying_bytes + transfer->size > fake.usb_memory) {
    return end ? end : PLACIDO_U3V_FAILED;
  }
  if (!transfer->own) {
    transfer->own = malloc(1);
    fake.own_count++;
  }
  transfer->received = 0;
  transfer->is_pending = true;
  fake.pending[fake.pending_count++] = (struct fake_transfer){.transfer = transfer, .pipe = pipe};
  fake.flying_bytes += transfer->size;
  if (fake.flying_bytes > fake.flying_most) {
    fake.flying_most = fake.flying_bytes;
  }
  return PLACIDO_U3V_DONE;
}

static void fake_cancel(void *pipe, placido_u3v_transfer *transfer) {
  (void)pipe;
  for (size_t i = 0; i < fake.pending_count; i++) {
    fake.pending[i].is_cancelled =
        fake.pending[i].is_cancelled || fake.pending[i].transfer == transfer;
  }
}

static void fake_wait(void *pipe, int timeout_ms) {
  (void)pipe;
  const int64_t until_ns = fake.clock_ns + (int64_t)timeout_ms * 1000000;
  const int before = fake.transfer_count;
  fake_end_cancelled();
  fake_catch_up();
  while (fake.transfer_count == before && fake.clock_ns < until_ns) {
    const bool comes = fake_is_on() && fake.next_ns > fake.clock_ns && fake.next_ns < until_ns;
    fake.clock_ns = comes ? fake.next_ns : until_ns;
    fake_catch_up();
  }
}

static void fake_forget(void *pipe, placido_u3v_transfer *transfer) {
  (void)pipe;
  if (transfer->own) {
    free(transfer->own);
    fake.own_count--;
    transfer->own = NULL;
  }
}

static enum placido_u3v_end fake_clear(void *pipe, uint8_t endpoint) {
  const enum placido_u3v_end end = fault(pipe);
  if (!end && endpoint == fake.found[0].stream_in) {
    fake.is_halted = false;
    fake.queue_count = 0;
    fake.resets++;
  }
  return end;
}

static int64_t fake_clock_ns(void *context) {
  (void)context;
  return fake.clock_ns;
}

static void fake_rest(void *context, int duration_ms) {
  (void)context;
  fake_sleep_ms(duration_ms);
}

const placido_u3v_calls fake_calls = {
    .each = fake_each,
    .open = fake_open,
    .close = fake_close,
    .write = fake_write,
    .read = fake_read,
    .submit = fake_submit,
    .cancel = fake_cancel,
    .wait = fake_wait,
    .forget = fake_forget,
    .reset = fake_clear,
    .clock_ns = fake_clock_ns,
    .sleep_ms = fake_rest,
};
