/* The stream of the camera played from a script. It behaves as the bus does: a transfer of the host
 * is filled until it is full or the camera ends a packet short. */
#include "tests/drivers/u3v_fake.h"

#include "drivers/u3v/wire/registers.h"

#include <string.h>

static uint8_t queue[4 << 20];

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
  size_t bytes = picture->is_short ? picture->bytes : fake_picture_bytes() + picture->surplus;
  const size_t most = sizeof queue - 0x10000; /* whatever the test lies */
  bytes = bytes < most ? bytes : most;
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

bool fake_is_on(void) {
  return fake.is_acquiring && !fake.is_gone &&
         (fake_get(FAKE_SIRM + PLACIDO_SIRM_CONTROL) & PLACIDO_SIRM_CONTROL_ENABLE);
}

static bool has_due(void) {
  const bool is_triggered = fake_get(FAKE_TRIGGER_MODE) == 1;
  return fake_is_on() && fake.clock_ns >= fake.next_ns && (!is_triggered || fake.triggers > 0);
}

/* All that can happen up to now. A picture that finds no transfer waiting is lost. */
void fake_catch_up(void) {
  for (;;) {
    while (fake.queue_count > 0 && fake.pending_count > 0 && !fake.is_halted && fake_is_on()) {
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
  fake_catch_up();
}

/* Cancelled transfers end when somebody waits, as with the kernel. */
void fake_end_cancelled(void) {
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
