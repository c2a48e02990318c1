/* The dialogue's lines, one after another. */
#include "tests/drivers/u3v_script.h"

#include <ctype.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

u3v_script script;

void script_play(const char *dialogue) {
  script.next = dialogue;
}

static bool starts(const char *line, const char *word) {
  return strncmp(line, word, strlen(word)) == 0;
}

static void skip_blanks(void) {
  while (isspace((unsigned char)*script.next)) {
    script.next++;
  }
}

/* Whether the next line begins with this; then it stands behind it. */
static bool take(const char *word) {
  skip_blanks();
  if (!starts(script.next, word)) {
    return false;
  }
  script.next += strlen(word);
  while (*script.next == ' ') {
    script.next++;
  }
  return true;
}

static int take_number(void) {
  char *end;
  const long number = strtol(script.next, &end, 10);
  script.next = end;
  return (int)number;
}

static int nibble(char c) {
  return isdigit((unsigned char)c) ? c - '0' : tolower((unsigned char)c) - 'a' + 10;
}

/* The bytes up to the end of the line. */
static size_t take_bytes(uint8_t *bytes, size_t capacity) {
  size_t nibbles = 0;
  for (; *script.next && *script.next != '\n'; script.next++) {
    if (isxdigit((unsigned char)*script.next)) {
      assert_true(nibbles / 2 < capacity);
      uint8_t *byte = &bytes[nibbles / 2];
      *byte = (uint8_t)(nibbles % 2 ? *byte << 4 | nibble(*script.next) : nibble(*script.next));
      nibbles++;
    }
  }
  assert_int_equal(nibbles % 2, 0);
  return nibbles / 2;
}

static bool take_end(enum placido_u3v_end *end) {
  static const struct {
    const char *word;
    enum placido_u3v_end end;
  } ends[] = {{"stall", PLACIDO_U3V_STALLED},      {"timeout", PLACIDO_U3V_TIMED_OUT},
              {"overflow", PLACIDO_U3V_OVERFLOW},  {"cancelled", PLACIDO_U3V_CANCELLED},
              {"failed", PLACIDO_U3V_FAILED},      {"gone", PLACIDO_U3V_GONE}};
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    if (take(ends[i].word)) {
      *end = ends[i].end;
      return true;
    }
  }
  return false;
}

static void pass_ms(int ms) {
  script.clock_ns += ms * INT64_C(1000000);
}

static enum placido_u3v_end script_write(void *pipe, const uint8_t *bytes, size_t size,
                                         int timeout_ms) {
  (void)pipe;
  const char *line = script.next;
  enum placido_u3v_end end = PLACIDO_U3V_DONE;
  if (!take(">")) {
    fail_msg("%zu bytes are written (command %02x%02x, id %u) before %.60s", size, bytes[7],
             bytes[6], bytes[10] | (unsigned)bytes[11] << 8, line);
  }
  if (take_end(&end)) {
    pass_ms(end == PLACIDO_U3V_TIMED_OUT ? timeout_ms : 0);
    return end;
  }
  uint8_t expected[4096];
  assert_int_equal(take_bytes(expected, sizeof expected), size);
  assert_memory_equal(bytes, expected, size);
  return end;
}

static enum placido_u3v_end script_read(void *pipe, uint8_t *bytes, size_t size, size_t *received,
                                        int timeout_ms) {
  (void)pipe;
  *received = 0;
  script.read_size = size;
  assert_true(size > 0 && size % script.packet_bytes == 0);
  assert_true(timeout_ms > 0);
  if (take("after")) {
    script.delay_ms = take_number();
  }
  const int passed_ms = script.delay_ms < timeout_ms ? script.delay_ms : timeout_ms;
  pass_ms(passed_ms);
  script.delay_ms -= passed_ms;
  if (script.delay_ms > 0) {
    return PLACIDO_U3V_TIMED_OUT;
  }
  enum placido_u3v_end end = PLACIDO_U3V_TIMED_OUT;
  if (!take("<") || take_end(&end)) {
    pass_ms(end == PLACIDO_U3V_TIMED_OUT ? timeout_ms : 0);
    return end;
  }
  const bool is_late = take("late");
  *received = take_bytes(bytes, size);
  pass_ms(is_late ? timeout_ms : 0);
  return is_late ? PLACIDO_U3V_TIMED_OUT : PLACIDO_U3V_DONE;
}

static enum placido_u3v_end script_reset(void *pipe, uint8_t endpoint) {
  (void)pipe;
  assert_int_equal(endpoint, 0);
  assert_true(take("reset"));
  enum placido_u3v_end end = PLACIDO_U3V_DONE;
  take_end(&end);
  return end;
}

static int64_t script_clock_ns(void *context) {
  (void)context;
  return script.clock_ns;
}

static void script_sleep_ms(void *context, int duration_ms) {
  (void)context;
  assert_true(take("sleep"));
  assert_int_equal(take_number(), duration_ms);
  pass_ms(duration_ms);
}

const placido_u3v_calls u3v_script_calls = {
    .write = script_write,
    .read = script_read,
    .reset = script_reset,
    .clock_ns = script_clock_ns,
    .sleep_ms = script_sleep_ms,
};

void script_assert_over(void) {
  skip_blanks();
  if (*script.next) {
    fail_msg("this did not happen: %s", script.next);
  }
}
