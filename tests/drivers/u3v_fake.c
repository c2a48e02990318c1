/* A USB3 Vision camera played from a script, below the pipe. Its stream behaves as the bus does: a
 * transfer of the host is filled until it is full or the camera ends a packet short. */
#include "tests/drivers/u3v_fake.h"

#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "drivers/u3v/wire/registers.h"

#include <stdlib.h>
#include <string.h>

#define CALL_NS 20000
#define PACKET 1024

struct fake fake;
static uint8_t queue[4 << 20];

void fake_reset(void) {
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
                                      .control_packet_bytes = PACKET,
                                      .stream_packet_bytes = PACKET,
                                      .speed_mbit = 5000};
  fake_power_on();
}

void fake_next(struct fake_picture picture) {
  fake.script[fake.script_count++] = picture;
}

/* ---- the stream */

uint8_t fake_sample(uint64_t id, size_t byte) {
  return (uint8_t)(id * 37 + byte * 11 + byte / 256 + 1);
}

/* Appends one packet: what the camera ends with a short one. */
static void queue_packet(const uint8_t *bytes, size_t size) {
  memcpy(queue + fake.queue_size, bytes, size);
  fake.queue_size += size;
  fake.queue_ends[fake.queue_count++] = fake.queue_size;
}

static void queue_leader(const struct fake_picture *picture, uint64_t id) {
  uint8_t bytes[PLACIDO_U3V_LEADER_BYTES];
  const int64_t ahead_ns = picture->is_late ? 86400000000000 : 0;
  const placido_u3v_leader leader = {
      .frame_id = id,
      .payload_type = picture->payload_type ? picture->payload_type : PLACIDO_U3V_PAYLOAD_IMAGE,
      .timestamp_ns =
          fake.has_no_clock ? 0
                            : (uint64_t)(fake.next_ns - FAKE_EXPOSED_NS + fake.camera_ahead_ns +
                                         ahead_ns),
      .pixel_format = picture->format ? picture->format : fake_format()->code,
      .width_px = picture->width ? picture->width : fake_get(FAKE_WIDTH),
      .height_px = picture->height ? picture->height : fake_get(FAKE_HEIGHT),
      .padding_x_bytes = (uint16_t)picture->padding};
  placido_u3v_leader_encode(bytes, &leader);
  if (picture->bad_leader) {
    memset(bytes, 0xa5, sizeof bytes);
  }
  queue_packet(bytes, sizeof bytes);
}

/* Samples, cut as the host has written into the registers. */
static void queue_samples(const struct fake_picture *picture, uint64_t id, size_t bytes) {
  static uint8_t samples[sizeof queue];
  const size_t most = fake_get(FAKE_SIRM + PLACIDO_SIRM_PAYLOAD_SIZE);
  const size_t count = fake_get(FAKE_SIRM + PLACIDO_SIRM_PAYLOAD_COUNT);
  const size_t final = fake_get(FAKE_SIRM + PLACIDO_SIRM_FINAL1);
  for (size_t i = 0; i < bytes; i++) {
    samples[i] = fake_sample(id, i);
  }
  if (picture->mimics_trailer) {
    placido_u3v_trailer_encode(samples, &(placido_u3v_trailer){.frame_id = id});
  }
  size_t done = 0;
  for (size_t i = 0; i < count + (final > 0); i++) {
    const size_t room = i < count ? most : final;
    const size_t size = bytes - done < room ? bytes - done : room;
    if (size > 0 || picture->is_padded) {
      queue_packet(samples + done, size);
    }
    done += size;
  }
  if (done < bytes) { /* more than was agreed */
    queue_packet(samples + done, bytes - done);
  }
}

static void queue_trailer(const struct fake_picture *picture, uint64_t id, size_t bytes) {
  uint8_t packet[PLACIDO_U3V_TRAILER_BYTES];
  const placido_u3v_trailer trailer = {
      .frame_id = id + picture->trailer_id_off,
      .status = picture->status,
      .payload_bytes = bytes,
      .height_px = picture->valid_rows ? picture->valid_rows : fake_get(FAKE_HEIGHT)};
  placido_u3v_trailer_encode(packet, &trailer);
  if (picture->bad_trailer) {
    memset(packet, 0x5a, sizeof packet);
  }
  queue_packet(packet, sizeof packet);
}

static void end_all(enum placido_u3v_end end) {
  for (size_t i = 0; i < fake.pending_count; i++) {
    fake.pending[i].transfer->end = end;
    fake.pending[i].transfer->is_pending = false;
  }
  fake.pending_count = 0;
  fake.flying_bytes = 0;
}

void fake_unplug(void) {
  fake.is_gone = true;
  fake.is_acquiring = false;
  end_all(PLACIDO_U3V_GONE);
}

void fake_replug(void) {
  fake.is_gone = fake.is_halted = false;
  fake.generation++;
  fake.next_id = 0;
  fake.queue_count = fake.queue_begin = fake.queue_size = 0;
  fake_power_on();
}

static void switch_off(void) {
  fake.is_acquiring = false;
  fake_put(FAKE_SIRM + PLACIDO_SIRM_CONTROL, 0);
}

/* The next picture goes into the queue. */
static void take_picture(void) {
  static const struct fake_picture good = {0};
  const struct fake_picture *picture = fake.script_next < fake.script_count
                                           ? &fake.script[fake.script_next++]
                                           : &good;
  if (picture->is_unplug) {
    fake_unplug();
    return;
  }
  if (picture->is_switched_off) {
    switch_off();
    return;
  }
  fake.next_id = picture->resets_id ? 0 : fake.next_id + picture->skip;
  const uint64_t id = fake.next_id++;
  const size_t bytes = picture->is_short ? picture->bytes : fake_picture_bytes() + picture->surplus;
  fake.queue_count = fake.queue_begin = fake.queue_size = 0;
  if (!picture->no_leader) {
    queue_leader(picture, id);
  }
  queue_samples(picture, id, bytes);
  if (!picture->no_trailer) {
    queue_trailer(picture, id, bytes);
  }
  fake.sent++;
}

/* Ends the first pending transfer. */
static void end_first(enum placido_u3v_end end) {
  placido_u3v_transfer *transfer = fake.pending[0].transfer;
  fake.transfer_count++;
  if (fake.transfer_fail_at && fake.transfer_count == fake.transfer_fail_at) {
    end = fake.transfer_fail_end;
    fake.is_halted = end == PLACIDO_U3V_STALLED || end == PLACIDO_U3V_OVERFLOW;
    if (end == PLACIDO_U3V_DONE) {
      memset(transfer->bytes, 0x33, transfer->received); /* garbage */
    }
  }
  transfer->end = end;
  transfer->is_pending = false;
  fake.flying_bytes -= transfer->size;
  memmove(fake.pending, fake.pending + 1, --fake.pending_count * sizeof *fake.pending);
  if (end == PLACIDO_U3V_GONE) {
    fake_unplug();
  }
}

/* One packet of the queue, or what the transfer takes of it. */
static void send_packet(void) {
  placido_u3v_transfer *transfer = fake.pending[0].transfer;
  const size_t left = fake.queue_ends[0] - fake.queue_begin;
  const size_t room = transfer->size - transfer->received;
  const size_t size = left < room ? left : room;
  memcpy(transfer->bytes + transfer->received, queue + fake.queue_begin, size);
  transfer->received += size;
  fake.queue_begin += size;
  if (left <= room) {
    memmove(fake.queue_ends, fake.queue_ends + 1, --fake.queue_count * sizeof *fake.queue_ends);
  }
  end_first(PLACIDO_U3V_DONE);
}

static bool is_on(void) {
  return fake.is_acquiring && !fake.is_gone &&
         (fake_get(FAKE_SIRM + PLACIDO_SIRM_CONTROL) & PLACIDO_SIRM_CONTROL_ENABLE);
}

static bool has_due(void) {
  const bool is_triggered = fake_get(FAKE_TRIGGER_MODE) == 1;
  return is_on() && fake.clock_ns >= fake.next_ns && (!is_triggered || fake.triggers > 0);
}

/* All that can happen up to now. A picture that finds no transfer waiting is lost. */
static void catch_up(void) {
  for (;;) {
    while (fake.queue_count > 0 && fake.pending_count > 0 && !fake.is_halted && is_on()) {
      send_packet();
    }
    if (!has_due()) {
      return;
    }
    fake.triggers -= fake_get(FAKE_TRIGGER_MODE) == 1;
    if (fake.queue_count > 0 || fake.pending_count == 0 || fake.is_halted) {
      fake.next_id++;
    } else {
      take_picture();
    }
    fake.next_ns += FAKE_PERIOD_NS;
  }
}

void fake_sleep_ms(int duration_ms) {
  fake.clock_ns += (int64_t)duration_ms * 1000000;
  catch_up();
}

/* ---- the calls */

/* A handle on the camera as it was plugged in. */
struct handle {
  int generation;
};

/* Whether this call is the one to fail, and how. */
static enum placido_u3v_end fault(const struct handle *handle) {
  fake.call_count++;
  fake.clock_ns += CALL_NS;
  catch_up();
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
  fake.pending[fake.pending_count++] = (struct fake_transfer){.transfer = transfer};
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

/* Cancelled transfers end when somebody waits, as with the kernel. */
static void end_cancelled(void) {
  size_t kept = 0;
  for (size_t i = 0; i < fake.pending_count; i++) {
    struct fake_transfer *pending = &fake.pending[i];
    if (pending->is_cancelled && !fake.never_gives_back) {
      pending->transfer->end = PLACIDO_U3V_CANCELLED;
      pending->transfer->is_pending = false;
      fake.flying_bytes -= pending->transfer->size;
    } else {
      fake.pending[kept++] = *pending;
    }
  }
  fake.pending_count = kept;
}

static void fake_wait(void *pipe, int timeout_ms) {
  (void)pipe;
  const int64_t until_ns = fake.clock_ns + (int64_t)timeout_ms * 1000000;
  const int before = fake.transfer_count;
  end_cancelled();
  catch_up();
  while (fake.transfer_count == before && fake.clock_ns < until_ns) {
    const bool comes = is_on() && fake.next_ns > fake.clock_ns && fake.next_ns < until_ns;
    fake.clock_ns = comes ? fake.next_ns : until_ns;
    catch_up();
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
