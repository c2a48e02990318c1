/* The camera's memory behind the control channel. */
#include "tests/drivers/u3v_registers.h"

#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "drivers/u3v/wire/registers.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

u3v_registers registers;

void registers_put(uint64_t address, const void *bytes, size_t size) {
  assert_true(address <= REGISTERS_BYTES && size <= REGISTERS_BYTES - address);
  memcpy(registers.bytes + address, bytes, size);
}

void registers_put_u32(uint64_t address, uint32_t value) {
  placido_write_u32(registers.bytes + address, value);
}

void registers_put_u64(uint64_t address, uint64_t value) {
  placido_write_u64(registers.bytes + address, value);
}

void registers_reset(void) {
  registers_free();
  registers = (u3v_registers){.bytes = calloc(1, REGISTERS_BYTES), .clock_ns = 1};
  assert_non_null(registers.bytes);
  registers_put(PLACIDO_ABRM_MANUFACTURER, "Maker", 6);
  registers_put(PLACIDO_ABRM_MODEL, "Eye 5", 6);
  registers_put(PLACIDO_ABRM_DEVICE_VERSION, "1.2", 4);
  registers_put(PLACIDO_ABRM_SERIAL, "SN0001", 7);
  registers_put(PLACIDO_ABRM_USER_NAME, "left", 5);
  registers_put_u32(PLACIDO_ABRM_MAX_RESPONSE_MS, 100);
  registers_put_u64(PLACIDO_ABRM_MANIFEST_ADDRESS, REGISTERS_MANIFEST);
  registers_put_u64(PLACIDO_ABRM_SBRM_ADDRESS, REGISTERS_SBRM);
  registers_put_u64(PLACIDO_ABRM_TIMESTAMP_INCREMENT, 8);
  registers_put_u32(REGISTERS_SBRM + PLACIDO_SBRM_MAX_COMMAND, 1024);
  registers_put_u32(REGISTERS_SBRM + PLACIDO_SBRM_MAX_ACK, 1024);
  registers_put_u32(REGISTERS_SBRM + PLACIDO_SBRM_STREAM_CHANNELS, 1);
  registers_put_u64(REGISTERS_SBRM + PLACIDO_SBRM_SIRM_ADDRESS, REGISTERS_SIRM);
}

void registers_free(void) {
  free(registers.bytes);
  registers.bytes = NULL;
}

void registers_describe(int i, uint32_t version, uint32_t schema, uint64_t address, uint64_t size) {
  const uint64_t entry = REGISTERS_MANIFEST + 8 + (uint64_t)i * PLACIDO_MANIFEST_ENTRY_BYTES;
  registers_put_u64(REGISTERS_MANIFEST, (uint64_t)i + 1);
  registers_put_u32(entry, version);
  registers_put_u32(entry + PLACIDO_MANIFEST_SCHEMA, schema);
  registers_put_u64(entry + PLACIDO_MANIFEST_ADDRESS, address);
  registers_put_u64(entry + PLACIDO_MANIFEST_SIZE, size);
}

/* Whether this call fails. */
static bool fails(enum placido_u3v_end *end) {
  registers.call_count++;
  *end = registers.fail_end;
  return registers.fail_at > 0 && (registers.call_count == registers.fail_at ||
                                   (registers.fails_for_ever &&
                                    registers.call_count > registers.fail_at));
}

static bool is_there(uint64_t address, size_t size) {
  const bool is_refused = address < registers.refused_up_to && address >= registers.refused_from;
  return !is_refused && address <= REGISTERS_BYTES && size <= REGISTERS_BYTES - address;
}

static enum placido_u3v_end registers_write(void *pipe, const uint8_t *bytes, size_t size,
                                            int timeout_ms) {
  (void)pipe;
  enum placido_u3v_end end;
  if (fails(&end)) {
    registers.clock_ns += end == PLACIDO_U3V_TIMED_OUT ? timeout_ms * INT64_C(1000000) : 0;
    return end;
  }
  placido_gencp_packet command, answer = {0};
  assert_int_equal(placido_gencp_decode(&command, bytes, size, NULL), PLACIDO_OK);
  const bool is_read = command.command == PLACIDO_GENCP_READ;
  answer.command = is_read ? PLACIDO_GENCP_READ_ACK : PLACIDO_GENCP_WRITE_ACK;
  answer.request_id = command.request_id;
  const size_t length = is_read ? command.count : command.data_size;
  if (!is_there(command.address, length)) {
    answer.flags = PLACIDO_GENCP_INVALID_ADDRESS;
  } else if (is_read) {
    answer.data = registers.bytes + command.address;
    answer.data_size = length;
  } else {
    memcpy(registers.bytes + command.address, command.data, length);
    answer.count = (uint16_t)length;
  }
  registers.answer_size =
      placido_gencp_encode(registers.answer, sizeof registers.answer, &answer);
  return PLACIDO_U3V_DONE;
}

static enum placido_u3v_end registers_read(void *pipe, uint8_t *bytes, size_t size,
                                           size_t *received, int timeout_ms) {
  (void)pipe;
  *received = 0;
  enum placido_u3v_end end;
  const bool is_failure = fails(&end);
  if ((is_failure && end == PLACIDO_U3V_TIMED_OUT) || registers.answer_size == 0) {
    registers.clock_ns += timeout_ms * INT64_C(1000000);
    return PLACIDO_U3V_TIMED_OUT;
  }
  if (is_failure) {
    return end;
  }
  registers.clock_ns += registers.answer_ms * INT64_C(1000000);
  assert_true(registers.answer_size <= size);
  memcpy(bytes, registers.answer, registers.answer_size);
  *received = registers.answer_size;
  registers.answer_size = 0;
  return PLACIDO_U3V_DONE;
}

static enum placido_u3v_end registers_reset_endpoint(void *pipe, uint8_t endpoint) {
  (void)pipe;
  assert_int_equal(endpoint, 0);
  enum placido_u3v_end end;
  registers.answer_size = 0;
  return fails(&end) ? end : PLACIDO_U3V_DONE;
}

static int64_t registers_clock_ns(void *context) {
  (void)context;
  return registers.clock_ns;
}

static void registers_sleep_ms(void *context, int duration_ms) {
  (void)context;
  registers.clock_ns += duration_ms * INT64_C(1000000);
}

const placido_u3v_calls u3v_registers_calls = {
    .write = registers_write,
    .read = registers_read,
    .reset = registers_reset_endpoint,
    .clock_ns = registers_clock_ns,
    .sleep_ms = registers_sleep_ms,
};
