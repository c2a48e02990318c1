/* The simulated USB3 Vision camera keeps its word: registers, limits, pictures bit by bit, and each
 * fault as it was ordered. A host speaks to it without a wire, and the clock is the test's. */
#include "base/memory.h"
#include "drivers/u3v/wire/gencp.h"
#include "drivers/u3v/wire/packet.h"
#include "drivers/u3v/wire/pixel.h"
#include "drivers/u3v/wire/registers.h"
#include "gadget/u3v.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

#define WIDTH 64
#define HEIGHT 48
#define RATE_HZ 100.0
#define MS INT64_C(1000000)
#define COMMAND 0x01
#define ANSWER 0x81
#define STREAM 0x82

/* Where camera.xml says that its features are. */
enum {
  F = 0x80000,
  F_WIDTH = F + 0x08,
  F_HEIGHT = F + 0x0C,
  F_OFFSET_X = F + 0x10,
  F_OFFSET_Y = F + 0x14,
  F_FORMAT = F + 0x18,
  F_PAYLOAD = F + 0x1C,
  F_MODE = F + 0x20,
  F_START = F + 0x24,
  F_STOP = F + 0x28,
  F_STATUS = F + 0x2C,
  F_EXPOSURE = F + 0x30,
  F_TIME_BASE = F + 0x34,
  F_GAIN = F + 0x38,
  F_BLACK = F + 0x3C,
  F_RATE = F + 0x40,
  F_TRIGGER = F + 0x4C,
  F_TRIGGER_NOW = F + 0x50,
  F_LOCKED = F + 0x54,
  F_RESET = F + 0x58,
};

static const placido_gadget_face *const face = &placido_u3v_face;
static placido_frame scene;
static placido_gadget_faults faults;
static placido_gadget gadget;
static int64_t now_ns;
static uint16_t last_id, last_status;
static uint8_t buffer[1 << 17];
static uint64_t sbrm, sirm;

static const placido_frame *look(void *user, int64_t t_ns) {
  (void)user;
  (void)t_ns;
  return &scene;
}

static void paint(enum placido_format format, int bits) {
  assert_int_equal(placido_frame_resize(&scene, WIDTH, HEIGHT, format, NULL), PLACIDO_OK);
  scene.bits = bits;
  uint32_t random = 1;
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    random = random * 1664525u + 1013904223u;
    if (format == PLACIDO_MONO8) {
      scene.data[i] = (uint8_t)(random >> 24);
    } else {
      ((uint16_t *)(void *)scene.data)[i] = (uint16_t)(random >> (32 - bits));
    }
  }
}

static int64_t pass(int64_t ns) {
  now_ns += ns;
  return placido_gadget_tick(&gadget, now_ns);
}

static enum placido_gadget_answer give(const uint8_t *bytes, size_t size) {
  uint8_t copy[4096];
  assert_true(size <= sizeof copy);
  memcpy(copy, bytes, size);
  return placido_gadget_transfer(&gadget, COMMAND, NULL, copy, &size);
}

/* Fetches up to `*size` bytes. */
static enum placido_gadget_answer fetch(uint8_t endpoint, uint8_t *bytes, size_t *size) {
  return placido_gadget_transfer(&gadget, endpoint, NULL, bytes, size);
}

static void send_command(uint16_t command, uint64_t address, const void *data, size_t size) {
  uint8_t bytes[1024];
  const placido_gencp_packet packet = {.flags = PLACIDO_GENCP_WANTS_ACK,
                                       .command = command,
                                       .request_id = ++last_id,
                                       .address = address,
                                       .count = (uint16_t)size,
                                       .data = data,
                                       .data_size = data ? size : 0};
  const size_t written = placido_gencp_encode(bytes, sizeof bytes, &packet);
  assert_true(written > 0);
  assert_int_equal(give(bytes, written), PLACIDO_GADGET_DONE);
}

/* The next answer, in `buffer`; its command, or 0: none. */
static uint16_t fetch_answer(placido_gencp_packet *ack) {
  size_t size = sizeof buffer;
  if (fetch(ANSWER, buffer, &size) != PLACIDO_GADGET_DONE) {
    return 0;
  }
  assert_int_equal(placido_gencp_decode(ack, buffer, size, NULL), PLACIDO_OK);
  assert_int_equal(ack->request_id, last_id);
  last_status = ack->flags;
  return ack->command;
}

static uint16_t read_bytes(uint64_t address, void *bytes, size_t size) {
  placido_gencp_packet ack;
  send_command(PLACIDO_GENCP_READ, address, NULL, size);
  assert_int_equal(fetch_answer(&ack), PLACIDO_GENCP_READ_ACK);
  if (ack.flags == PLACIDO_GENCP_SUCCESS) {
    assert_int_equal(ack.data_size, size);
    memcpy(bytes, ack.data, size);
  }
  return ack.flags;
}

static uint16_t write_bytes(uint64_t address, const void *bytes, size_t size) {
  placido_gencp_packet ack;
  send_command(PLACIDO_GENCP_WRITE, address, bytes, size);
  assert_int_equal(fetch_answer(&ack), PLACIDO_GENCP_WRITE_ACK);
  if (ack.flags == PLACIDO_GENCP_SUCCESS) {
    assert_int_equal(ack.count, size);
  }
  return ack.flags;
}

static uint64_t read_number(uint64_t address, size_t size) {
  uint8_t bytes[8] = {0};
  uint64_t value = 0;
  assert_int_equal(read_bytes(address, bytes, size), PLACIDO_GENCP_SUCCESS);
  for (size_t i = 0; i < size; i++) {
    value |= (uint64_t)bytes[i] << 8 * i;
  }
  return value;
}

static uint32_t read_u32(uint64_t address) {
  return (uint32_t)read_number(address, 4);
}

static uint16_t write_u32(uint64_t address, uint32_t value) {
  const uint8_t bytes[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                            (uint8_t)(value >> 24)};
  return write_bytes(address, bytes, 4);
}

static void set(uint64_t address, uint32_t value) {
  assert_int_equal(write_u32(address, value), PLACIDO_GENCP_SUCCESS);
}

static uint16_t write_rate(double rate_hz) {
  uint8_t bytes[8];
  uint64_t bits;
  memcpy(&bits, &rate_hz, 8);
  for (int i = 0; i < 8; i++) {
    bytes[i] = (uint8_t)(bits >> 8 * i);
  }
  return write_bytes(F_RATE, bytes, 8);
}

static double read_rate(void) {
  const uint64_t bits = read_number(F_RATE, 8);
  double rate_hz;
  memcpy(&rate_hz, &bits, 8);
  return rate_hz;
}

static void set_gain(double gain_db) {
  const float gain = (float)gain_db;
  uint32_t bits;
  memcpy(&bits, &gain, 4);
  set(F_GAIN, bits);
}

static void plug_in(bool is_zip, enum placido_gadget_speed speed) {
  const placido_gadget_options options = {.view = {look, NULL, WIDTH, HEIGHT, RATE_HZ},
                                          .faults = &faults,
                                          .speed = speed,
                                          .serial = "SN42",
                                          .zip = is_zip};
  void *state;
  assert_int_equal(face->open(&state, &options, NULL), PLACIDO_OK);
  gadget = (placido_gadget){.function = face->function, .state = state, .speed = speed};
  const placido_gadget_setup configure = {.request = 9, .value = 1};
  size_t size = 0;
  pass(MS);
  assert_int_equal(placido_gadget_transfer(&gadget, 0, &configure, NULL, &size),
                   PLACIDO_GADGET_DONE);
  sbrm = read_number(PLACIDO_ABRM_SBRM_ADDRESS, 8);
  sirm = read_number(sbrm + PLACIDO_SBRM_SIRM_ADDRESS, 8);
}

static int set_up(void **state) {
  (void)state;
  memset(&faults, 0, sizeof faults);
  now_ns = 1000 * MS;
  paint(PLACIDO_MONO8, 8);
  plug_in(false, PLACIDO_GADGET_SUPER);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  face->close(gadget.state);
  placido_frame_free(&scene);
  return 0;
}

/* As a host does: transfers of `transfer_bytes`, the rest in a last one. */
static void start_stream(uint32_t transfer_bytes) {
  const uint32_t payload = (uint32_t)read_number(sirm + PLACIDO_SIRM_REQUIRED_PAYLOAD, 8);
  set(sirm + PLACIDO_SIRM_MAX_LEADER, read_u32(sirm + PLACIDO_SIRM_REQUIRED_LEADER));
  set(sirm + PLACIDO_SIRM_MAX_TRAILER, read_u32(sirm + PLACIDO_SIRM_REQUIRED_TRAILER));
  set(sirm + PLACIDO_SIRM_PAYLOAD_SIZE, transfer_bytes);
  set(sirm + PLACIDO_SIRM_PAYLOAD_COUNT, payload / transfer_bytes);
  set(sirm + PLACIDO_SIRM_FINAL1, (payload % transfer_bytes + 3) / 4 * 4);
  set(sirm + PLACIDO_SIRM_FINAL2, 0);
  set(sirm + PLACIDO_SIRM_CONTROL, 1);
  set(F_START, 1);
}

/* A picture as it came: what of it was there. */
typedef struct arrival {
  bool has_leader, has_trailer, stalled;
  placido_u3v_leader leader;
  placido_u3v_trailer trailer;
  size_t size;
  int transfers;
  uint8_t samples[1 << 15];
} arrival;

static arrival got;

/* Fetches until the trailer, a stall, or until nothing more comes. */
static bool fetch_picture(void) {
  memset(&got, 0, sizeof got);
  for (int patience = 0; patience < 100; patience++) {
    placido_u3v_leader leader;
    size_t size = sizeof buffer;
    const enum placido_gadget_answer answer = fetch(STREAM, buffer, &size);
    if (answer == PLACIDO_GADGET_STALL) {
      got.stalled = true;
      return true;
    }
    if (answer == PLACIDO_GADGET_LATER) {
      if (got.transfers > 0 || got.has_leader) {
        return true;
      }
      pass(MS);
    } else if (placido_u3v_trailer_decode(&got.trailer, buffer, size, NULL) == PLACIDO_OK) {
      got.has_trailer = true;
      return true;
    } else if (placido_u3v_leader_decode(&leader, buffer, size, NULL) == PLACIDO_OK) {
      got.leader = leader;
      got.has_leader = true;
    } else {
      assert_true(got.size + size <= sizeof got.samples);
      memcpy(got.samples + got.size, buffer, size);
      got.size += size;
      got.transfers++;
    }
  }
  return false;
}

static void fetch_whole(void) {
  assert_true(fetch_picture());
  assert_true(got.has_leader && got.has_trailer && !got.stalled);
  assert_int_equal(got.trailer.status, 0);
  assert_true(got.leader.frame_id == got.trailer.frame_id);
  assert_true(got.trailer.payload_bytes == got.size);
}

static void it_says_who_it_is(void **state) {
  (void)state;
  char text[64];
  assert_int_equal(read_bytes(PLACIDO_ABRM_SERIAL, text, 64), PLACIDO_GENCP_SUCCESS);
  assert_string_equal(text, "SN42");
  assert_int_equal(read_bytes(PLACIDO_ABRM_MANUFACTURER, text, 64), PLACIDO_GENCP_SUCCESS);
  assert_string_equal(text, "Placido");
  assert_int_equal(read_u32(sbrm + PLACIDO_SBRM_STREAM_CHANNELS), 1);
  assert_true(read_u32(PLACIDO_ABRM_MAX_RESPONSE_MS) > 0);
  assert_int_equal(read_u32(sbrm + PLACIDO_SBRM_CURRENT_SPEED), 8);
  assert_int_equal(read_number(PLACIDO_ABRM_TIMESTAMP_INCREMENT, 8), 1);
  assert_int_equal(read_u32(F_PAYLOAD), WIDTH * HEIGHT);
}

/* The descriptors, as the fact sheet of USB3 Vision has them. */
static void its_descriptors_are_of_the_class(void **state) {
  (void)state;
  size_t size;
  const uint8_t *device = gadget.function->descriptor(gadget.state, 1, 0, &size);
  assert_int_equal(size, 18);
  assert_memory_equal(device + 4, "\xEF\x02\x01", 3);
  const uint8_t *all = gadget.function->descriptor(gadget.state, 2, 0, &size);
  assert_int_equal(size, all[2] | all[3] << 8);
  int interfaces = 0, endpoints = 0, infos = 0;
  size_t at = 0;
  for (; at < size; at += all[at]) {
    assert_true(all[at] >= 2);
    interfaces += all[at + 1] == 4 && all[at + 5] == 0xEF && all[at + 6] == 5;
    endpoints += all[at + 1] == 5 && all[at + 3] == 2 && all[at + 5] == 4;
    infos += all[at] == 20 && all[at + 1] == 0x24 && all[at + 2] == 1;
    for (int i = 11; infos && all[at + 1] == 0x24 && i <= 18; i++) {
      size_t length;
      assert_non_null(gadget.function->descriptor(gadget.state, 3, all[at + i], &length));
    }
  }
  assert_int_equal(at, size);
  assert_int_equal(interfaces, 2);
  assert_int_equal(endpoints, 3);
  assert_int_equal(infos, 1);
}

/* Reads the description that the manifest points at; caller frees. */
static uint8_t *read_description(size_t *size, uint32_t *schema) {
  const uint64_t entry = read_number(PLACIDO_ABRM_MANIFEST_ADDRESS, 8) + 8;
  *schema = read_u32(entry + PLACIDO_MANIFEST_SCHEMA);
  *size = (size_t)read_number(entry + PLACIDO_MANIFEST_SIZE, 8);
  const uint64_t address = read_number(entry + PLACIDO_MANIFEST_ADDRESS, 8);
  uint8_t *bytes = placido_memory_new(*size + 1, 1, NULL);
  assert_non_null(bytes);
  for (size_t at = 0; at < *size; at += 5000) {
    const size_t piece = *size - at < 5000 ? *size - at : 5000;
    assert_int_equal(read_bytes(address + at, bytes + at, piece), PLACIDO_GENCP_SUCCESS);
  }
  return bytes;
}

static uint32_t little_endian(const uint8_t *bytes, int count) {
  uint32_t value = 0;
  for (int i = 0; i < count; i++) {
    value |= (uint32_t)bytes[i] << 8 * i;
  }
  return value;
}

static void its_description_is_the_same_in_a_zip(void **state) {
  (void)state;
  size_t xml_size, zip_size;
  uint32_t schema;
  uint8_t *xml = read_description(&xml_size, &schema);
  assert_int_equal(PLACIDO_MANIFEST_TYPE(schema), 0);
  assert_non_null(strstr((char *)xml, "<RegisterDescription"));
  assert_non_null(strstr((char *)xml, "</RegisterDescription>"));
  face->close(gadget.state);
  plug_in(true, PLACIDO_GADGET_SUPER);
  uint8_t *zip = read_description(&zip_size, &schema);
  assert_int_equal(PLACIDO_MANIFEST_TYPE(schema), 1);
  const uint8_t *end = zip + zip_size - 22, *central = zip + little_endian(end + 16, 4);
  assert_int_equal(little_endian(end, 4), 0x06054B50);
  assert_int_equal(little_endian(central, 4), 0x02014B50);
  assert_true(central + little_endian(end + 12, 4) == end);
  const uint8_t *local = zip + little_endian(central + 42, 4);
  assert_int_equal(little_endian(local, 4), 0x04034B50);
  assert_memory_equal(local + 14, central + 16, 12); /* checksum and sizes */
  assert_int_equal(little_endian(local + 22, 4), xml_size);
  assert_memory_equal(local + 30 + little_endian(local + 26, 2), xml, xml_size);
  placido_memory_free(xml);
  placido_memory_free(zip);
}

static void answers_of_64_kilobytes_are_whole(void **state) {
  (void)state;
  const size_t most = read_u32(sbrm + PLACIDO_SBRM_MAX_ACK);
  assert_int_equal(most, 65536);
  /* There is no register space of that size: what can be refused must be refused as too far. */
  uint8_t byte;
  assert_int_equal(read_bytes(F, &byte, 65000), PLACIDO_GENCP_INVALID_ADDRESS);
  assert_int_equal(read_bytes(F, &byte, 65525), PLACIDO_GENCP_INVALID_PARAMETER);
  size_t size;
  uint32_t schema;
  uint8_t *xml = read_description(&size, &schema);
  uint8_t *again = placido_memory_new(size, 1, NULL);
  assert_non_null(again);
  assert_int_equal(read_bytes(0x100000, again, size), PLACIDO_GENCP_SUCCESS);
  assert_memory_equal(xml, again, size);
  placido_memory_free(xml);
  placido_memory_free(again);
}

static void an_answer_comes_in_pieces_where_the_host_asks_for_pieces(void **state) {
  (void)state;
  uint8_t piece[512], all[76];
  size_t at = 0;
  send_command(PLACIDO_GENCP_READ, PLACIDO_ABRM_MODEL, NULL, 64);
  for (int i = 0; i < 8; i++) {
    size_t size = 10;
    assert_int_equal(fetch(ANSWER, piece, &size), PLACIDO_GADGET_DONE);
    memcpy(all + at, piece, size);
    at += size;
  }
  assert_int_equal(at, 76);
  assert_string_equal((char *)all + 12, "Simulated topographer");
  size_t size = 512;
  assert_int_equal(fetch(ANSWER, piece, &size), PLACIDO_GADGET_LATER);
}

static void addresses_and_sizes_are_checked(void **state) {
  (void)state;
  uint8_t bytes[8] = {0};
  assert_int_equal(read_bytes(0x70000, bytes, 4), PLACIDO_GENCP_INVALID_ADDRESS);
  assert_int_equal(read_bytes(PLACIDO_ABRM_BYTES - 2, bytes, 4), PLACIDO_GENCP_INVALID_ADDRESS);
  assert_int_equal(read_bytes(UINT64_MAX - 1, bytes, 4), PLACIDO_GENCP_INVALID_ADDRESS);
  assert_int_equal(read_bytes(0, bytes, 0), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(write_u32(PLACIDO_ABRM_MODEL, 1), PLACIDO_GENCP_WRITE_PROTECT);
  assert_int_equal(write_u32(F_PAYLOAD, 1), PLACIDO_GENCP_WRITE_PROTECT);
  assert_int_equal(write_u32(0x100000, 1), PLACIDO_GENCP_WRITE_PROTECT);
  assert_int_equal(write_u32(F_WIDTH + 2, 1), PLACIDO_GENCP_WRITE_PROTECT);
  assert_int_equal(write_bytes(F_WIDTH, bytes, 8), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(write_bytes(F_RATE, bytes, 4), PLACIDO_GENCP_INVALID_PARAMETER);
}

static void unknown_commands_are_not_implemented(void **state) {
  (void)state;
  placido_gencp_packet ack;
  send_command(0x0C00, 0, "x", 1);
  assert_int_equal(fetch_answer(&ack), 0x0C01);
  assert_int_equal(last_status, PLACIDO_GENCP_NOT_IMPLEMENTED);
}

static void nonsense_is_not_answered(void **state) {
  (void)state;
  uint8_t bytes[64] = {0x55, 0x33, 0x56, 0x43, 0, 0x40, 0, 8, 0xFF, 0xFF};
  size_t size = sizeof buffer;
  assert_int_equal(give(bytes, sizeof bytes), PLACIDO_GADGET_DONE);
  assert_int_equal(give(bytes, 5), PLACIDO_GADGET_DONE);
  assert_int_equal(give(bytes, 0), PLACIDO_GADGET_DONE);
  assert_int_equal(fetch(ANSWER, buffer, &size), PLACIDO_GADGET_LATER);
  it_says_who_it_is(NULL);
}

static void a_user_name_stays_over_a_reset(void **state) {
  (void)state;
  char text[64];
  assert_int_equal(write_bytes(PLACIDO_ABRM_USER_NAME, "lane 2", 7), PLACIDO_GENCP_SUCCESS);
  assert_int_equal(write_bytes(PLACIDO_ABRM_USER_NAME + 60, "lane 2", 7),
                   PLACIDO_GENCP_WRITE_PROTECT);
  set(F_WIDTH, 32);
  assert_int_equal(gadget.function->resets(gadget.state), 0);
  set(F_RESET, 1);
  assert_int_equal(gadget.function->resets(gadget.state), 0); /* the answer comes first */
  pass(100 * MS);
  assert_int_equal(gadget.function->resets(gadget.state), 1);
  assert_int_equal(gadget.function->resets(gadget.state), 0);
  gadget.function->configured(gadget.state, 0xFF, 0);
  assert_int_equal(read_u32(F_WIDTH), WIDTH);
  assert_int_equal(read_bytes(PLACIDO_ABRM_USER_NAME, text, 64), PLACIDO_GENCP_SUCCESS);
  assert_string_equal(text, "lane 2");
}

static void the_size_has_its_limits(void **state) {
  (void)state;
  assert_int_equal(write_u32(F_WIDTH, WIDTH + 4), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(write_u32(F_WIDTH, 30), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(write_u32(F_OFFSET_X, 4), PLACIDO_GENCP_INVALID_PARAMETER);
  set(F_WIDTH, 32);
  set(F_OFFSET_X, 32);
  assert_int_equal(write_u32(F_OFFSET_X, 36), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(write_u32(F_WIDTH, 36), PLACIDO_GENCP_INVALID_PARAMETER);
  set(F_HEIGHT, 10);
  set(F_OFFSET_Y, 38);
  assert_int_equal(write_u32(F_OFFSET_Y, 40), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(read_u32(F_PAYLOAD), 320);
  set(F_FORMAT, 0x010C0047); /* Mono12p */
  assert_int_equal(read_number(sirm + PLACIDO_SIRM_REQUIRED_PAYLOAD, 8), 480);
  assert_int_equal(write_u32(F_FORMAT, 0x02180014), PLACIDO_GENCP_INVALID_PARAMETER);
}

/* The rate that a person asks for, as far as exposure and readout leave time for it. */
static void exposure_limits_the_rate(void **state) {
  (void)state;
  const double base_us = read_u32(F_TIME_BASE) / 1000.0;
  assert_true(fabs(read_rate() - RATE_HZ) < 1e-9);
  set(F_EXPOSURE, (uint32_t)(20000 / base_us));
  assert_true(fabs(read_rate() - 1e6 / 20200) < 1e-6);
  assert_int_equal(write_rate(60.0), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(write_rate(NAN), PLACIDO_GENCP_INVALID_PARAMETER);
  assert_int_equal(write_rate(40.0), PLACIDO_GENCP_SUCCESS);
  set(F_EXPOSURE, (uint32_t)(1000 / base_us));
  assert_true(fabs(read_rate() - 40) < 1e-9);
  assert_int_equal(write_u32(F_EXPOSURE, 1), PLACIDO_GENCP_INVALID_PARAMETER);
}

static void pictures_arrive_bit_by_bit(void **state) {
  (void)state;
  start_stream(1024);
  for (uint64_t i = 0; i < 5; i++) {
    fetch_whole();
    assert_true(got.leader.frame_id == i);
    assert_int_equal(got.leader.width_px, WIDTH);
    assert_int_equal(got.leader.height_px, HEIGHT);
    assert_int_equal(got.leader.pixel_format, 0x01080001);
    assert_int_equal(got.trailer.height_px, HEIGHT);
    assert_int_equal(got.transfers, 3);
    assert_int_equal(got.size, WIDTH * HEIGHT);
    assert_memory_equal(got.samples, scene.data, WIDTH * HEIGHT);
  }
}

static void a_part_is_cut_out_of_the_view(void **state) {
  (void)state;
  set(F_WIDTH, 20);
  set(F_HEIGHT, 6);
  set(F_OFFSET_X, 12);
  set(F_OFFSET_Y, 8);
  start_stream(64); /* 120 bytes: 64, and 56 in the last transfer */
  fetch_whole();
  assert_int_equal(got.transfers, 2);
  assert_int_equal(got.leader.offset_x_px, 12);
  assert_int_equal(got.leader.offset_y_px, 8);
  for (int y = 0; y < 6; y++) {
    assert_memory_equal(got.samples + y * 20, scene.data + (y + 8) * WIDTH + 12, 20);
  }
}

/* Deeper formats hold the view's levels at the top of their range, whatever the packing. */
static void every_format_holds_the_same_picture(void **state) {
  (void)state;
  static const char *const names[] = {"Mono10", "Mono12", "Mono10p", "Mono12p", "Mono12Packed"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    const placido_pixel_format *format = placido_pixel_by_name(names[i]);
    placido_frame frame = {0};
    set(F_FORMAT, format->code);
    start_stream(4096);
    fetch_whole();
    assert_int_equal(placido_pixel_to_frame(&frame, format, got.samples, got.size, WIDTH, HEIGHT,
                                            placido_pixel_row_bytes(format, WIDTH), NULL),
                     PLACIDO_OK);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
      assert_int_equal(((uint16_t *)(void *)frame.data)[k] >> (format->bits - 8), scene.data[k]);
    }
    placido_frame_free(&frame);
    set(F_STOP, 1);
    set(sirm + PLACIDO_SIRM_CONTROL, 0);
  }
}

static void a_deep_view_keeps_its_twelve_bits(void **state) {
  (void)state;
  paint(PLACIDO_MONO16, 12);
  set(F_FORMAT, 0x01100005);
  start_stream(8192);
  fetch_whole();
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    assert_int_equal(got.samples[2 * i] | got.samples[2 * i + 1] << 8,
                     ((uint16_t *)(void *)scene.data)[i]);
  }
}

/* 20 log10: 6.0206 dB is twice as bright; half the exposure takes that back. */
static void brightness_follows_gain_exposure_and_black_level(void **state) {
  (void)state;
  const uint32_t nominal = read_u32(F_EXPOSURE);
  set_gain(20 * log10(2));
  start_stream(4096);
  fetch_whole();
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const int twice = 2 * scene.data[i];
    assert_int_equal(got.samples[i], twice < 255 ? twice : 255);
  }
  set(F_EXPOSURE, nominal / 2);
  set(F_BLACK, 10);
  fetch_picture(); /* may have been exposed before */
  fetch_picture();
  fetch_whole();
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const int lifted = scene.data[i] + 10;
    assert_int_equal(got.samples[i], lifted < 255 ? lifted : 255);
  }
}

static void what_makes_up_the_size_is_locked_while_pictures_are_taken(void **state) {
  (void)state;
  start_stream(4096);
  assert_int_equal(read_u32(F_STATUS), 1);
  assert_int_equal(write_u32(F_WIDTH, 32), PLACIDO_GENCP_ACCESS_DENIED);
  assert_int_equal(write_u32(F_FORMAT, 0x01100005), PLACIDO_GENCP_ACCESS_DENIED);
  assert_int_equal(write_u32(sirm + PLACIDO_SIRM_PAYLOAD_SIZE, 8), PLACIDO_GENCP_ACCESS_DENIED);
  set(F_EXPOSURE, 1000);
  set(F_STOP, 1);
  set(F_WIDTH, 32);
  set(F_LOCKED, 1);
  assert_int_equal(write_u32(F_WIDTH, 64), PLACIDO_GENCP_ACCESS_DENIED);
}

static void transfers_that_do_not_carry_a_picture_are_refused(void **state) {
  (void)state;
  assert_int_equal(write_u32(sirm + PLACIDO_SIRM_CONTROL, 1), 0xA004);
  start_stream(1024);
  set(F_STOP, 1);
  set(sirm + PLACIDO_SIRM_CONTROL, 0);
  set(sirm + PLACIDO_SIRM_PAYLOAD_SIZE, 1022);
  assert_int_equal(write_u32(sirm + PLACIDO_SIRM_CONTROL, 1), 0xA003);
  set(sirm + PLACIDO_SIRM_PAYLOAD_SIZE, 1024);
  set(sirm + PLACIDO_SIRM_PAYLOAD_COUNT, 2);
  assert_int_equal(write_u32(sirm + PLACIDO_SIRM_CONTROL, 1), 0xA004);
  set(sirm + PLACIDO_SIRM_FINAL1, 512);
  set(sirm + PLACIDO_SIRM_FINAL2, 512);
  set(sirm + PLACIDO_SIRM_CONTROL, 1);
  set(F_START, 1);
  fetch_whole();
  assert_int_equal(got.transfers, 4);
  assert_memory_equal(got.samples, scene.data, WIDTH * HEIGHT);
}

static void pictures_come_at_the_rate_that_was_asked_for(void **state) {
  (void)state;
  start_stream(4096);
  fetch_whole();
  const uint64_t first_ns = got.leader.timestamp_ns;
  fetch_whole();
  fetch_whole();
  assert_int_equal(got.leader.timestamp_ns - first_ns, 20 * MS);
  assert_int_equal(write_rate(20), PLACIDO_GENCP_SUCCESS);
  fetch_whole();
  const uint64_t before_ns = got.leader.timestamp_ns;
  fetch_whole();
  assert_true(got.leader.timestamp_ns - before_ns >= 40 * MS);
  fetch_whole();
  fetch_whole();
  const uint64_t last_ns = got.leader.timestamp_ns;
  assert_true(last_ns - before_ns >= 140 * MS && last_ns - before_ns <= 150 * MS);
}

static void a_host_that_is_slow_loses_pictures_and_sees_it(void **state) {
  (void)state;
  start_stream(4096);
  fetch_whole();
  for (int i = 0; i < 200; i++) {
    pass(MS); /* 20 pictures; four are kept */
  }
  for (uint64_t i = 1; i <= 4; i++) {
    fetch_whole();
    assert_true(got.leader.frame_id == i);
  }
  fetch_whole();
  assert_true(got.leader.frame_id >= 20 && got.leader.frame_id <= 22);
  placido_gadget_statistics statistics;
  face->statistics(gadget.state, &statistics);
  assert_int_equal(statistics.pictures, 6);
  assert_true(statistics.dropped >= 15);
}

static void a_single_frame_is_single(void **state) {
  (void)state;
  set(F_MODE, 1);
  start_stream(4096);
  fetch_whole();
  assert_int_equal(read_u32(F_STATUS), 0);
  assert_false(fetch_picture());
  set(F_START, 1);
  fetch_whole();
}

static void triggered_it_waits_for_each_trigger(void **state) {
  (void)state;
  set(F_TRIGGER, 1);
  start_stream(4096);
  assert_false(fetch_picture());
  set(F_TRIGGER_NOW, 1);
  const int64_t pressed_ns = now_ns;
  fetch_whole();
  assert_true(now_ns - pressed_ns < 10 * MS);
  assert_false(fetch_picture());
  set(F_TRIGGER_NOW, 1);
  set(F_TRIGGER_NOW, 1); /* while it is exposing: lost */
  fetch_whole();
  assert_true(got.leader.frame_id == 1);
  assert_false(fetch_picture());
  set(F_TRIGGER, 3); /* a line, on which nothing comes */
  set(F_TRIGGER_NOW, 1);
  assert_false(fetch_picture());
}

static void the_latch_takes_the_cameras_own_time(void **state) {
  (void)state;
  set(PLACIDO_ABRM_TIMESTAMP_LATCH, 1);
  const uint64_t first_ns = read_number(PLACIDO_ABRM_TIMESTAMP, 8);
  pass(123 * MS);
  assert_int_equal(read_number(PLACIDO_ABRM_TIMESTAMP, 8), first_ns);
  set(PLACIDO_ABRM_TIMESTAMP_LATCH, 1);
  assert_int_equal(read_number(PLACIDO_ABRM_TIMESTAMP, 8) - first_ns, 123 * MS);
}

static void stream_faults_are_as_ordered(void **state) {
  (void)state;
  start_stream(1024);
  fetch_whole();
  faults.left[PLACIDO_GADGET_FAULT_DROP] = 2;
  const uint64_t before = got.leader.frame_id;
  fetch_whole();
  assert_true(got.leader.frame_id == before + 3);
  faults.left[PLACIDO_GADGET_FAULT_CORRUPT] = 1;
  assert_true(fetch_picture() && got.has_trailer);
  assert_int_equal(got.trailer.status, 0xA100);
  assert_memory_not_equal(got.samples, scene.data, WIDTH * HEIGHT);
  faults.left[PLACIDO_GADGET_FAULT_TRUNCATE] = 1;
  assert_true(fetch_picture() && got.has_trailer);
  assert_int_equal(got.size, WIDTH * HEIGHT / 2);
  assert_int_equal(got.trailer.payload_bytes, WIDTH * HEIGHT / 2);
  faults.left[PLACIDO_GADGET_FAULT_MISNUMBER] = 1;
  assert_true(fetch_picture() && got.has_trailer);
  assert_true(got.leader.frame_id != got.trailer.frame_id);
  faults.left[PLACIDO_GADGET_FAULT_LOST_START] = 1;
  assert_true(fetch_picture() && got.has_trailer && !got.has_leader);
  assert_int_equal(got.size, WIDTH * HEIGHT);
  faults.left[PLACIDO_GADGET_FAULT_LOST_END] = 1;
  assert_true(fetch_picture() && got.has_leader && !got.has_trailer);
  assert_int_equal(got.size, WIDTH * HEIGHT);
  fetch_whole();
  for (int i = 0; i < PLACIDO_GADGET_FAULTS; i++) {
    assert_int_equal(faults.left[i], 0);
  }
}

static void after_a_stall_it_goes_on_where_the_host_clears_the_halt(void **state) {
  (void)state;
  start_stream(1024);
  fetch_whole();
  faults.left[PLACIDO_GADGET_FAULT_STALL] = 1;
  assert_true(fetch_picture() && got.stalled);
  assert_true(got.has_leader && got.size < WIDTH * HEIGHT);
  const uint64_t lost = got.leader.frame_id;
  assert_true(fetch_picture() && got.stalled);
  const placido_gadget_setup clear = {.request_type = 2, .request = 1, .index = STREAM};
  size_t size = 0;
  assert_int_equal(placido_gadget_transfer(&gadget, 0, &clear, NULL, &size), PLACIDO_GADGET_DONE);
  fetch_whole();
  assert_true(got.leader.frame_id > lost);
}

static void control_faults_are_as_ordered(void **state) {
  (void)state;
  placido_gencp_packet ack;
  size_t size = sizeof buffer;
  faults.left[PLACIDO_GADGET_FAULT_PENDING] = 1;
  send_command(PLACIDO_GENCP_READ, F_WIDTH, NULL, 4);
  assert_int_equal(fetch_answer(&ack), PLACIDO_GENCP_PENDING_ACK);
  assert_int_equal(ack.count, 400);
  assert_int_equal(fetch_answer(&ack), 0);
  assert_true(pass(100 * MS) <= now_ns + 50 * MS); /* it asks to be looked at when it is ready */
  assert_int_equal(fetch_answer(&ack), 0);
  pass(50 * MS);
  assert_int_equal(fetch_answer(&ack), PLACIDO_GENCP_READ_ACK);
  faults.left[PLACIDO_GADGET_FAULT_SILENT] = 1;
  send_command(PLACIDO_GENCP_READ, F_WIDTH, NULL, 4);
  assert_int_equal(fetch_answer(&ack), 0);
  faults.left[PLACIDO_GADGET_FAULT_REFUSE] = 1;
  assert_int_equal(write_u32(F_WIDTH, 32), PLACIDO_GENCP_GENERIC_ERROR);
  assert_int_equal(read_u32(F_WIDTH), WIDTH);
  faults.left[PLACIDO_GADGET_FAULT_GARBLE] = 1;
  send_command(PLACIDO_GENCP_READ, F_WIDTH, NULL, 4);
  assert_int_equal(fetch(ANSWER, buffer, &size), PLACIDO_GADGET_DONE);
  assert_int_equal(placido_gencp_decode(&ack, buffer, size, NULL), PLACIDO_INPUT);
  faults.slow_ms = 30;
  send_command(PLACIDO_GENCP_READ, F_WIDTH, NULL, 4);
  assert_int_equal(fetch_answer(&ack), 0);
  pass(30 * MS);
  assert_int_equal(fetch_answer(&ack), PLACIDO_GENCP_READ_ACK);
}

static void answers_that_nobody_fetches_do_not_pile_up(void **state) {
  (void)state;
  placido_gencp_packet ack;
  for (int i = 0; i < 100; i++) {
    send_command(PLACIDO_GENCP_READ, F_WIDTH, NULL, 4);
  }
  size_t count = 0, size = sizeof buffer;
  while (fetch(ANSWER, buffer, &size) == PLACIDO_GADGET_DONE) {
    assert_int_equal(placido_gencp_decode(&ack, buffer, size, NULL), PLACIDO_OK);
    size = sizeof buffer;
    count++;
  }
  assert_true(count >= 1 && count <= 8);
  assert_int_equal(ack.request_id, last_id); /* the newest are kept */
}

static void impossible_cameras_are_refused(void **state) {
  (void)state;
  const placido_gadget_options good = {
      .view = {look, NULL, WIDTH, HEIGHT, RATE_HZ}, .speed = PLACIDO_GADGET_HIGH, .serial = "1"};
  placido_gadget_options bad[5] = {good, good, good, good, good};
  void *camera;
  placido_error err;
  bad[0].view.width_px = 8;
  bad[1].view.height_px = 100000;
  bad[2].view.rate_hz = 0;
  bad[3].serial = "";
  bad[4].serial = "m\xC3\xBCller";
  for (size_t i = 0; i < 5; i++) {
    err = (placido_error){0};
    assert_int_equal(face->open(&camera, &bad[i], &err), PLACIDO_INPUT);
    assert_null(camera);
    assert_true(err.text[0]);
  }
  assert_int_equal(face->open(&camera, &good, NULL), PLACIDO_OK);
  face->close(camera);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  const placido_gadget_options options = {
      .view = {look, NULL, WIDTH, HEIGHT, RATE_HZ}, .speed = PLACIDO_GADGET_HIGH, .serial = "1"};
  void *camera = NULL;
  for (unsigned long n = 1; !camera; n++) {
    placido_error err = {0};
    placido_memory_fail_at(n);
    const int status = face->open(&camera, &options, &err);
    placido_memory_fail_at(0);
    assert_true((status == PLACIDO_OK) == (camera != NULL));
    assert_true(status == PLACIDO_OK || (status == PLACIDO_MEMORY && err.text[0]));
    assert_true(n < 100);
  }
  face->close(camera);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(it_says_who_it_is),
      TEST(its_descriptors_are_of_the_class),
      TEST(its_description_is_the_same_in_a_zip),
      TEST(answers_of_64_kilobytes_are_whole),
      TEST(an_answer_comes_in_pieces_where_the_host_asks_for_pieces),
      TEST(addresses_and_sizes_are_checked),
      TEST(unknown_commands_are_not_implemented),
      TEST(nonsense_is_not_answered),
      TEST(a_user_name_stays_over_a_reset),
      TEST(the_size_has_its_limits),
      TEST(exposure_limits_the_rate),
      TEST(pictures_arrive_bit_by_bit),
      TEST(a_part_is_cut_out_of_the_view),
      TEST(every_format_holds_the_same_picture),
      TEST(a_deep_view_keeps_its_twelve_bits),
      TEST(brightness_follows_gain_exposure_and_black_level),
      TEST(what_makes_up_the_size_is_locked_while_pictures_are_taken),
      TEST(transfers_that_do_not_carry_a_picture_are_refused),
      TEST(pictures_come_at_the_rate_that_was_asked_for),
      TEST(a_host_that_is_slow_loses_pictures_and_sees_it),
      TEST(a_single_frame_is_single),
      TEST(triggered_it_waits_for_each_trigger),
      TEST(the_latch_takes_the_cameras_own_time),
      TEST(stream_faults_are_as_ordered),
      TEST(after_a_stall_it_goes_on_where_the_host_clears_the_halt),
      TEST(control_faults_are_as_ordered),
      TEST(answers_that_nobody_fetches_do_not_pile_up),
      TEST(impossible_cameras_are_refused),
      TEST(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
