/* The packets of a USB3 Vision camera, byte by byte as they stand on the wire. */
#include "drivers/u3v/wire/gencp.h"
#include "drivers/u3v/wire/packet.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC 0x55, 0x33, 0x56, 0x43

static const uint8_t data[] = {0xde, 0xad, 0xbe, 0xef, 0x01};

/* Packets and their bytes, from the layout of the standard. */
static const struct {
  placido_gencp_packet packet;
  uint8_t bytes[32];
  size_t size;
} dialogue[] = {
    {{.flags = 0x4000, .command = 0x0800, .request_id = 0x0102, .address = 0x1122334455667788,
      .count = 64},
     {MAGIC, 0x00, 0x40, 0x00, 0x08, 0x0c, 0x00, 0x02, 0x01, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33,
      0x22, 0x11, 0x00, 0x00, 0x40, 0x00},
     24},
    {{.command = 0x0801, .request_id = 0x0102, .data = data, .data_size = 5},
     {MAGIC, 0x00, 0x00, 0x01, 0x08, 0x05, 0x00, 0x02, 0x01, 0xde, 0xad, 0xbe, 0xef, 0x01},
     17},
    {{.flags = 0x4000, .command = 0x0802, .request_id = 7, .address = 0x10024, .data = data,
      .data_size = 4},
     {MAGIC, 0x00, 0x40, 0x02, 0x08, 0x0c, 0x00, 0x07, 0x00, 0x24, 0x00, 0x01, 0x00, 0x00, 0x00,
      0x00, 0x00, 0xde, 0xad, 0xbe, 0xef},
     24},
    {{.command = 0x0803, .request_id = 7, .count = 4},
     {MAGIC, 0x00, 0x00, 0x03, 0x08, 0x04, 0x00, 0x07, 0x00, 0x00, 0x00, 0x04, 0x00},
     16},
    {{.command = 0x0805, .request_id = 7, .count = 1500},
     {MAGIC, 0x00, 0x00, 0x05, 0x08, 0x04, 0x00, 0x07, 0x00, 0x00, 0x00, 0xdc, 0x05},
     16},
    {{.flags = 0x8003, .command = 0x0801, .request_id = 9},
     {MAGIC, 0x03, 0x80, 0x01, 0x08, 0x00, 0x00, 0x09, 0x00},
     12},
    {{.flags = 0x8004, .command = 0x0803, .request_id = 9},
     {MAGIC, 0x04, 0x80, 0x03, 0x08, 0x00, 0x00, 0x09, 0x00},
     12},
    {{.flags = 0x4000, .command = 0x0c00, .request_id = 1, .data = data, .data_size = 2},
     {MAGIC, 0x00, 0x40, 0x00, 0x0c, 0x02, 0x00, 0x01, 0x00, 0xde, 0xad},
     14},
};
#define DIALOGUE_COUNT (sizeof dialogue / sizeof *dialogue)

/* The bytes in a block of their own size: what lies behind is guarded by the sanitizer. */
static uint8_t *block_of(const uint8_t *bytes, size_t size) {
  uint8_t *block = malloc(size + 1);
  assert_non_null(block);
  memcpy(block, bytes, size);
  uint8_t *fitted = realloc(block, size ? size : 1);
  assert_non_null(fitted);
  return fitted;
}

static void packets_become_bytes(void **state) {
  (void)state;
  for (size_t i = 0; i < DIALOGUE_COUNT; i++) {
    uint8_t bytes[32];
    memset(bytes, 0xcc, sizeof bytes);
    assert_int_equal(placido_gencp_encode(bytes, sizeof bytes, &dialogue[i].packet),
                     dialogue[i].size);
    assert_memory_equal(bytes, dialogue[i].bytes, dialogue[i].size);
    for (size_t capacity = 0; capacity < dialogue[i].size; capacity++) {
      assert_int_equal(placido_gencp_encode(bytes, capacity, &dialogue[i].packet), 0);
    }
  }
}

static void bytes_become_packets(void **state) {
  (void)state;
  for (size_t i = 0; i < DIALOGUE_COUNT; i++) {
    const placido_gencp_packet *expected = &dialogue[i].packet;
    for (size_t behind = 0; behind <= 3; behind++) { /* bytes behind the packet */
      uint8_t *bytes = block_of(dialogue[i].bytes, dialogue[i].size + behind);
      placido_gencp_packet packet;
      assert_int_equal(placido_gencp_decode(&packet, bytes, dialogue[i].size + behind, NULL),
                       PLACIDO_OK);
      assert_int_equal(packet.flags, expected->flags);
      assert_int_equal(packet.command, expected->command);
      assert_int_equal(packet.request_id, expected->request_id);
      assert_true(packet.address == expected->address);
      assert_int_equal(packet.count, expected->count);
      assert_int_equal(packet.data_size, expected->data_size);
      assert_int_equal(packet.data == NULL, expected->data == NULL);
      if (packet.data) {
        assert_memory_equal(packet.data, expected->data, packet.data_size);
      }
      free(bytes);
    }
  }
}

static void a_packet_cut_short_is_refused(void **state) {
  (void)state;
  for (size_t i = 0; i < DIALOGUE_COUNT; i++) {
    for (size_t size = 0; size < dialogue[i].size; size++) {
      uint8_t *bytes = block_of(dialogue[i].bytes, size);
      placido_gencp_packet packet;
      placido_error err = {0};
      assert_int_equal(placido_gencp_decode(&packet, bytes, size, &err), PLACIDO_INPUT);
      assert_true(err.text[0] != '\0');
      free(bytes);
    }
  }
}

/* Says a payload that is too short for the command, and one that is not there. */
static void lengths_that_lie_are_refused(void **state) {
  (void)state;
  static const struct {
    size_t which;
    uint8_t length;
    int status;
  } cases[] = {
      {0, 11, PLACIDO_INPUT}, {0, 0, PLACIDO_INPUT},  {0, 13, PLACIDO_INPUT},
      {1, 6, PLACIDO_INPUT},  {1, 4, PLACIDO_OK},     {1, 0, PLACIDO_OK},
      {2, 7, PLACIDO_INPUT},  {2, 8, PLACIDO_OK},     {3, 3, PLACIDO_INPUT},
      {3, 0, PLACIDO_OK}, /* a camera that does not tell how much it wrote */
      {4, 0, PLACIDO_INPUT},  {4, 3, PLACIDO_INPUT},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    uint8_t *bytes = block_of(dialogue[cases[i].which].bytes, dialogue[cases[i].which].size);
    bytes[8] = cases[i].length;
    placido_gencp_packet packet;
    assert_int_equal(placido_gencp_decode(&packet, bytes, dialogue[cases[i].which].size, NULL),
                     cases[i].status);
    free(bytes);
  }
}

static void another_magic_is_no_packet(void **state) {
  (void)state;
  placido_gencp_packet packet;
  placido_error err = {0};
  uint8_t bytes[16];
  memcpy(bytes, dialogue[3].bytes, sizeof bytes);
  bytes[3] = 'L';
  assert_int_equal(placido_gencp_decode(&packet, bytes, sizeof bytes, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "0x4c563355"));
}

static void data_longer_than_the_length_field_do_not_fit(void **state) {
  (void)state;
  enum { SIZE = 70000 };
  uint8_t *bytes = calloc(1, SIZE), *payload = calloc(1, SIZE);
  assert_true(bytes && payload);
  placido_gencp_packet packet = {.command = PLACIDO_GENCP_READ_ACK, .data = payload};
  packet.data_size = 65535;
  assert_int_equal(placido_gencp_encode(bytes, SIZE, &packet), 65547);
  packet.data_size = 65536;
  assert_int_equal(placido_gencp_encode(bytes, SIZE, &packet), 0);
  packet.data_size = SIZE_MAX;
  assert_int_equal(placido_gencp_encode(bytes, SIZE, &packet), 0);
  packet.command = PLACIDO_GENCP_WRITE;
  packet.data_size = 65527;
  assert_int_equal(placido_gencp_encode(bytes, SIZE, &packet), 65547);
  packet.data_size = 65528;
  assert_int_equal(placido_gencp_encode(bytes, SIZE, &packet), 0);
  free(bytes);
  free(payload);
}

static void every_status_has_its_sentence(void **state) {
  (void)state;
  assert_string_equal(placido_gencp_status_text(PLACIDO_GENCP_INVALID_ADDRESS),
                      "there is no such address");
  const char *unknown = placido_gencp_status_text(0x1234);
  int known = 0;
  for (unsigned status = 0; status <= UINT16_MAX; status++) {
    known += placido_gencp_status_text((uint16_t)status) != unknown;
  }
  assert_int_equal(known, 18); /* the codes of GenCP and of USB3 Vision */
}

static const uint8_t leader_bytes[PLACIDO_U3V_LEADER_BYTES] = {
    0x55, 0x33, 0x56, 0x4c, 0x00, 0x00, 0x34, 0x00,             /* magic, size */
    0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,             /* frame id */
    0x00, 0x00, 0x01, 0x40,                                     /* payload type */
    0x00, 0xca, 0x9a, 0x3b, 0x01, 0x00, 0x00, 0x00,             /* time stamp */
    0x47, 0x00, 0x0c, 0x01, 0x00, 0x05, 0x00, 0x00, 0x00, 0x04, /* pixel format, width, height */
    0x00, 0x00, 0x10, 0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0x00, /* offsets */
    0x06, 0x00, 0x00, 0x00};                                    /* padding */
static const placido_u3v_leader leader = {.frame_id = 0x0102030405060708,
                                          .payload_type = PLACIDO_U3V_PAYLOAD_IMAGE_CHUNKS,
                                          .timestamp_ns = 5294967296,
                                          .pixel_format = 0x010C0047,
                                          .width_px = 1280,
                                          .height_px = 1024,
                                          .offset_x_px = 16,
                                          .offset_y_px = 8,
                                          .padding_x_bytes = 6};

static void leaders_go_there_and_back(void **state) {
  (void)state;
  uint8_t bytes[PLACIDO_U3V_LEADER_BYTES];
  memset(bytes, 0xcc, sizeof bytes);
  placido_u3v_leader_encode(bytes, &leader);
  assert_memory_equal(bytes, leader_bytes, sizeof bytes);
  placido_u3v_leader got;
  assert_int_equal(placido_u3v_leader_decode(&got, bytes, sizeof bytes, NULL), PLACIDO_OK);
  assert_true(got.frame_id == leader.frame_id && got.timestamp_ns == leader.timestamp_ns);
  assert_int_equal(got.payload_type, leader.payload_type);
  assert_int_equal(got.pixel_format, leader.pixel_format);
  assert_int_equal(got.width_px, 1280);
  assert_int_equal(got.height_px, 1024);
  assert_int_equal(got.offset_x_px, 16);
  assert_int_equal(got.offset_y_px, 8);
  assert_int_equal(got.padding_x_bytes, 6);
  for (size_t size = 0; size < sizeof bytes; size++) {
    uint8_t *cut = block_of(bytes, size);
    assert_int_equal(placido_u3v_leader_decode(&got, cut, size, NULL), PLACIDO_INPUT);
    free(cut);
  }
  bytes[3] = 'T';
  assert_int_equal(placido_u3v_leader_decode(&got, bytes, sizeof bytes, NULL), PLACIDO_INPUT);
}

static const uint8_t trailer_bytes[PLACIDO_U3V_TRAILER_BYTES] = {
    0x55, 0x33, 0x56, 0x54, 0x00, 0x00, 0x20, 0x00, /* magic, size */
    0x2a, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, /* frame id */
    0x01, 0xa1, 0x00, 0x00,                         /* status */
    0x00, 0x00, 0x14, 0x00, 0x00, 0x00, 0x00, 0x00, /* payload */
    0x00, 0x04, 0x00, 0x00};                        /* height */

static void trailers_go_there_and_back(void **state) {
  (void)state;
  const placido_u3v_trailer trailer = {
      .frame_id = 42, .status = 0xA101, .payload_bytes = 1310720, .height_px = 1024};
  uint8_t bytes[PLACIDO_U3V_TRAILER_BYTES];
  memset(bytes, 0xcc, sizeof bytes);
  placido_u3v_trailer_encode(bytes, &trailer);
  assert_memory_equal(bytes, trailer_bytes, sizeof bytes);
  for (size_t size = 0; size <= sizeof bytes; size++) {
    uint8_t *cut = block_of(bytes, size);
    placido_u3v_trailer got;
    assert_int_equal(placido_u3v_trailer_decode(&got, cut, size, NULL),
                     size < 28 ? PLACIDO_INPUT : PLACIDO_OK);
    assert_true(size < 28 || (got.frame_id == 42 && got.payload_bytes == 1310720));
    assert_int_equal(got.status, size < 28 ? 0 : 0xA101);
    assert_int_equal(got.height_px, size < 32 ? 0 : 1024);
    free(cut);
  }
}

/* A camera without the height fills its 28 bytes up to its alignment. */
static void filling_behind_a_trailer_is_no_height(void **state) {
  (void)state;
  uint8_t bytes[64] = {0};
  memcpy(bytes, trailer_bytes, sizeof trailer_bytes);
  bytes[6] = 28;
  placido_u3v_trailer got;
  assert_int_equal(placido_u3v_trailer_decode(&got, bytes, sizeof bytes, NULL), PLACIDO_OK);
  assert_int_equal(got.height_px, 0);
  bytes[3] = 'L';
  placido_error err = {0};
  assert_int_equal(placido_u3v_trailer_decode(&got, bytes, sizeof bytes, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "trailer"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(packets_become_bytes),
      cmocka_unit_test(bytes_become_packets),
      cmocka_unit_test(a_packet_cut_short_is_refused),
      cmocka_unit_test(lengths_that_lie_are_refused),
      cmocka_unit_test(another_magic_is_no_packet),
      cmocka_unit_test(data_longer_than_the_length_field_do_not_fit),
      cmocka_unit_test(every_status_has_its_sentence),
      cmocka_unit_test(leaders_go_there_and_back),
      cmocka_unit_test(trailers_go_there_and_back),
      cmocka_unit_test(filling_behind_a_trailer_is_no_height),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
