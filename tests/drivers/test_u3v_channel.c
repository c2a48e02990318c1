/* The dialogue with a camera's registers: what is said, byte by byte, and what comes of every kind
 * of silence, refusal and noise. */
#include "base/memory.h"
#include "drivers/u3v/channel.h"
#include "tests/drivers/u3v_script.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

/* What is said at the beginning: time for an answer (100 ms), registers at 0x10000, commands and
 * answers of at most 0x24 and 0x20 bytes. */
#define OPENING                                                      \
  "> 55335643 0040 0008 0c00 0100 cc01000000000000 0000 0400\n"      \
  "< 55335643 0000 0108 0400 0100 64000000\n"                        \
  "> 55335643 0040 0008 0c00 0200 d801000000000000 0000 0800\n"      \
  "< 55335643 0000 0108 0800 0200 0000010000000000\n"                \
  "> 55335643 0040 0008 0c00 0300 1400010000000000 0000 0400\n"      \
  "< 55335643 0000 0108 0400 0300 24000000\n"                        \
  "> 55335643 0040 0008 0c00 0400 1800010000000000 0000 0400\n"      \
  "< 55335643 0000 0108 0400 0400 20000000\n"

/* A read of 4 bytes at 0x100 with a number of two hexadecimal digits, and its answer. */
#define ASK(id) "> 55335643 0040 0008 0c00 " id "00 0001000000000000 0000 0400\n"
#define TELL(id) "< 55335643 0000 0108 0400 " id "00 78563412\n"
#define PENDING(id, ms) "< 55335643 0000 0508 0400 " id "00 0000 " ms "\n"

static placido_u3v_channel channel;

static int set_up(void **state) {
  (void)state;
  script = (u3v_script){.clock_ns = 5, .packet_bytes = 64, .next = ""};
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  script_assert_over();
  placido_u3v_channel_close(&channel);
  return 0;
}

static void open_channel(void) {
  script_play(OPENING);
  assert_int_equal(placido_u3v_channel_open(&channel, &u3v_script_calls, NULL, 64, NULL),
                   PLACIDO_OK);
  script_assert_over();
}

/* Plays a dialogue to one read of 4 bytes at 0x100. */
static void assert_read(const char *dialogue, int status, const char *said) {
  uint32_t value = 99;
  placido_error err = {0};
  open_channel();
  script_play(dialogue);
  assert_int_equal(placido_u3v_channel_read_u32(&channel, 0x100, &value, &err), status);
  script_assert_over();
  if (status) {
    assert_int_equal(value, 0);
    assert_non_null(strstr(err.text, said));
    assert_int_equal(err.status, status);
  } else {
    assert_int_equal(value, 0x12345678);
  }
}

static void the_camera_is_asked_for_its_limits(void **state) {
  (void)state;
  open_channel();
  assert_int_equal(channel.max_command_bytes, 36);
  assert_int_equal(channel.max_ack_bytes, 32);
  assert_int_equal(channel.response_ms, 200); /* 100 is less than a busy machine needs */
  assert_int_equal(channel.retry_count, 0);
  assert_int_equal(channel.pending_count, 0);
}

static void numbers_are_read_and_written(void **state) {
  (void)state;
  open_channel();
  script_play(ASK("05") TELL("05")
              "> 55335643 0040 0008 0c00 0600 0001000000000000 0000 0800\n"
              "< 55335643 0000 0108 0800 0600 efcdab8967452301\n"
              "> 55335643 0040 0208 0c00 0700 0400020000000000 01000000\n"
              "< 55335643 0000 0308 0400 0700 0000 0400\n");
  uint32_t narrow;
  uint64_t wide;
  assert_int_equal(placido_u3v_channel_read_u32(&channel, 0x100, &narrow, NULL), PLACIDO_OK);
  assert_int_equal(narrow, 0x12345678);
  assert_int_equal(placido_u3v_channel_read_u64(&channel, 0x100, &wide, NULL), PLACIDO_OK);
  assert_true(wide == 0x0123456789abcdef);
  assert_int_equal(placido_u3v_channel_write_u32(&channel, 0x20004, 1, NULL), PLACIDO_OK);
}

/* 20 bytes of data fit into an answer of 32, 16 into a command of 36: pieces are multiples of 8. */
static void long_transfers_go_in_pieces(void **state) {
  (void)state;
  open_channel();
  script_play("> 55335643 0040 0008 0c00 0500 0010000000000000 0000 1000\n"
              "< 55335643 0000 0108 1000 0500 000102030405060708090a0b0c0d0e0f\n"
              "> 55335643 0040 0008 0c00 0600 1010000000000000 0000 0300\n"
              "< 55335643 0000 0108 0300 0600 101112\n"
              "> 55335643 0040 0208 1800 0700 0020000000000000 000102030405060708090a0b0c0d0e0f\n"
              "< 55335643 0000 0308 0400 0700 0000 1000\n"
              "> 55335643 0040 0208 0b00 0800 1020000000000000 101112\n"
              "< 55335643 0000 0308 0000 0800\n"); /* one that does not tell how much it wrote */
  uint8_t bytes[19];
  assert_int_equal(placido_u3v_channel_read(&channel, 0x1000, bytes, sizeof bytes, NULL),
                   PLACIDO_OK);
  for (int i = 0; i < 19; i++) {
    assert_int_equal(bytes[i], i);
  }
  assert_int_equal(script.read_size, 64);
  assert_int_equal(placido_u3v_channel_write(&channel, 0x2000, bytes, sizeof bytes, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_u3v_channel_read(&channel, 0x1000, bytes, 0, NULL), PLACIDO_OK);
}

static void numbers_of_commands_skip_zero(void **state) {
  (void)state;
  open_channel();
  channel.last_id = 0xfffe;
  script_play("> 55335643 0040 0008 0c00 ffff 0001000000000000 0000 0400\n"
              "< 55335643 0000 0108 0400 ffff 01000000\n" ASK("01") TELL("01"));
  uint32_t value;
  assert_int_equal(placido_u3v_channel_read_u32(&channel, 0x100, &value, NULL), PLACIDO_OK);
  assert_int_equal(placido_u3v_channel_read_u32(&channel, 0x100, &value, NULL), PLACIDO_OK);
}

static void a_lost_answer_is_asked_for_again(void **state) {
  (void)state;
  assert_read(ASK("05") "< timeout\n" ASK("06") "< timeout\n" ASK("07") TELL("07"), PLACIDO_OK,
              NULL);
  assert_int_equal(channel.retry_count, 2);
}

static void a_late_answer_is_not_the_next_ones(void **state) {
  (void)state;
  assert_read(ASK("05") "after 300\n" ASK("06")
              "< 55335643 0000 0108 0400 0500 ffffffff\n" TELL("06"),
              PLACIDO_OK, NULL);
  assert_int_equal(channel.retry_count, 1);
}

static void noise_is_passed_over(void **state) {
  (void)state;
  assert_read(ASK("05")
              "< 00\n"
              "<\n"                                         /* an empty packet */
              "< 5533564c 0000 0108 0400 0500 ffffffff\n"   /* no magic */
              "< 55335643 0000 0108 0500 0500 ffffffff\n"   /* cut short */
              "< 55335643 0000 0308 0400 0500 0000 0400\n"  /* of a write */
              "< 55335643 0000 000c 0000 0500\n"            /* an event */
              TELL("05"),
              PLACIDO_OK, NULL);
  assert_int_equal(channel.retry_count, 0);
}

static void silence_ends_after_five_tries(void **state) {
  (void)state;
  const int64_t begin_ns = script.clock_ns;
  assert_read(ASK("05") "< timeout\n" ASK("06") "< timeout\n" ASK("07") "< timeout\n" ASK("08")
              "< timeout\n" ASK("09") "< timeout\n",
              PLACIDO_TIMEOUT, "does not answer (register 0x100");
  assert_int_equal(channel.retry_count, 4);
  assert_int_equal((script.clock_ns - begin_ns) / 1000000, 5 * 200);
}

static void a_camera_that_asks_for_time_gets_it(void **state) {
  (void)state;
  assert_read(ASK("05") PENDING("05", "f401") "after 450\n" PENDING("05", "e803")
              "after 990\n" TELL("05"),
              PLACIDO_OK, NULL);
  assert_int_equal(channel.pending_count, 2);
  assert_int_equal(channel.retry_count, 0);
  placido_u3v_channel_close(&channel);
  set_up(NULL);
  /* less than the usual time does not shorten it; another command's has no meaning */
  assert_read(ASK("05") PENDING("05", "0000") PENDING("04", "ffff") "after 199\n" TELL("05"),
              PLACIDO_OK, NULL);
}

static void nobody_gets_all_the_time_in_the_world(void **state) {
  (void)state;
  const int64_t begin_ns = script.clock_ns;
  assert_read(ASK("05") PENDING("05", "ffff") "after 29000\n" PENDING("05", "ffff")
              "after 60000\n",
              PLACIDO_TIMEOUT, "does not answer");
  assert_int_equal((script.clock_ns - begin_ns) / 1000000, 30000);
}

static void a_refusal_ends_at_once(void **state) {
  (void)state;
  assert_read(ASK("05") "< 55335643 0380 0108 0000 0500\n", PLACIDO_UNSUPPORTED,
              "refuses to read register 0x100: there is no such address (status 0x8003)");
  script_play("> 55335643 0040 0208 0c00 0600 0001000000000000 01000000\n"
              "< 55335643 0480 0308 0000 0600\n");
  placido_error err = {0};
  assert_int_equal(placido_u3v_channel_write_u32(&channel, 0x100, 1, &err), PLACIDO_UNSUPPORTED);
  assert_non_null(strstr(err.text, "refuses to write register 0x100: the register can only be"));
  assert_int_equal(channel.retry_count, 0);
}

#define BUSY(id) "< 55335643 0780 0108 0000 " id "00\nsleep 20\n"

static void a_busy_camera_is_asked_again(void **state) {
  (void)state;
  assert_read(ASK("05") BUSY("05") ASK("06") BUSY("06") ASK("07") TELL("07"), PLACIDO_OK, NULL);
  placido_u3v_channel_close(&channel);
  set_up(NULL);
  assert_read(ASK("05") BUSY("05") ASK("06") BUSY("06") ASK("07") BUSY("07") ASK("08") BUSY("08")
              ASK("09") BUSY("09"),
              PLACIDO_UNSUPPORTED, "the camera is busy");
}

static void a_halted_endpoint_is_reset(void **state) {
  (void)state;
  assert_read("> stall\nreset\nsleep 20\n" ASK("06") "< stall\nreset\nsleep 20\n" ASK("07")
              "< overflow\nreset\nsleep 20\n" ASK("08") TELL("08"),
              PLACIDO_OK, NULL);
  assert_int_equal(channel.retry_count, 3);
}

static void what_usb_says_is_told(void **state) {
  (void)state;
  assert_read("> failed\nsleep 20\n" ASK("06") "< failed\nsleep 20\n" ASK("07")
              "< cancelled\nsleep 20\n> failed\nsleep 20\n> timeout\n",
              PLACIDO_TIMEOUT, "does not answer");
  placido_u3v_channel_close(&channel);
  set_up(NULL);
  assert_read("> failed\nsleep 20\n> failed\nsleep 20\n> failed\nsleep 20\n> failed\nsleep 20\n"
              "> failed\nsleep 20\n",
              PLACIDO_SYSTEM, "USB fails");
}

static void an_unplugged_camera_is_gone_at_once(void **state) {
  (void)state;
  static const char *const dialogues[] = {"> gone\n", ASK("05") "< gone\n",
                                          ASK("05") "< stall\nreset gone\n",
                                          "> failed\nsleep 20\n> gone\n"};
  for (size_t i = 0; i < sizeof dialogues / sizeof *dialogues; i++) {
    set_up(NULL);
    assert_read(dialogues[i], PLACIDO_GONE, "unplugged");
    placido_u3v_channel_close(&channel);
  }
}

static void answers_of_another_size_are_refused(void **state) {
  (void)state;
  assert_read(ASK("05") "< 55335643 0000 0108 0300 0500 785634\n", PLACIDO_SYSTEM,
              "gives 3 bytes of register 0x100, asked for 4");
  placido_u3v_channel_close(&channel);
  set_up(NULL);
  assert_read(ASK("05") "< 55335643 0000 0108 0600 0500 785634120000\n", PLACIDO_SYSTEM,
              "gives 6 bytes");
  script_play("> 55335643 0040 0208 0c00 0600 0001000000000000 01000000\n"
              "< 55335643 0000 0308 0400 0600 0000 0300\n");
  placido_error err = {0};
  assert_int_equal(placido_u3v_channel_write_u32(&channel, 0x100, 1, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "took 3 bytes of 4"));
}

/* Some cameras do not end an answer of whole packets: only the time ends the transfer. */
static void an_answer_that_only_time_ends_counts(void **state) {
  (void)state;
  assert_read(ASK("05") "< late 55335643 0000 0108 0400 0500 78563412\n", PLACIDO_OK, NULL);
  assert_int_equal(channel.retry_count, 0);
}

static void limits_that_no_camera_has_are_refused(void **state) {
  (void)state;
  static const struct {
    const char *response, *command, *ack;
    int status;
    size_t max_command, max_ack;
    int response_ms;
  } cases[] = {
      {"64000000", "00000000", "20000000", PLACIDO_INPUT, 0, 0, 0},
      {"64000000", "24000000", "00000000", PLACIDO_INPUT, 0, 0, 0},
      {"64000000", "24000000", "03000000", PLACIDO_INPUT, 0, 0, 0},
      {"64000000", "24000000", "13000000", PLACIDO_INPUT, 0, 0, 0},
      {"64000000", "1b000000", "20000000", PLACIDO_INPUT, 0, 0, 0},
      {"00000000", "1c000000", "14000000", PLACIDO_OK, 28, 20, 200},
      {"e8030000", "ffffffff", "ffffffff", PLACIDO_OK, 65536, 65536, 1000},
      {"ffffffff", "00000100", "01000100", PLACIDO_OK, 65536, 65536, 5000},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char dialogue[1024];
    snprintf(dialogue, sizeof dialogue,
             "> 55335643 0040 0008 0c00 0100 cc01000000000000 0000 0400\n"
             "< 55335643 0000 0108 0400 0100 %s\n"
             "> 55335643 0040 0008 0c00 0200 d801000000000000 0000 0800\n"
             "< 55335643 0000 0108 0800 0200 0000010000000000\n"
             "> 55335643 0040 0008 0c00 0300 1400010000000000 0000 0400\n"
             "< 55335643 0000 0108 0400 0300 %s\n"
             "> 55335643 0040 0008 0c00 0400 1800010000000000 0000 0400\n"
             "< 55335643 0000 0108 0400 0400 %s\n",
             cases[i].response, cases[i].command, cases[i].ack);
    script_play(dialogue);
    assert_int_equal(placido_u3v_channel_open(&channel, &u3v_script_calls, NULL, 64, NULL),
                     cases[i].status);
    script_assert_over();
    if (cases[i].status) {
      assert_null(channel.buffer);
    } else {
      assert_int_equal(channel.max_command_bytes, cases[i].max_command);
      assert_int_equal(channel.max_ack_bytes, cases[i].max_ack);
      assert_int_equal(channel.response_ms, cases[i].response_ms);
      placido_u3v_channel_close(&channel);
    }
  }
}

static void a_camera_without_registers_is_not_opened(void **state) {
  (void)state;
  static const struct {
    const char *dialogue;
    int status;
    const char *said;
  } cases[] = {
      {"> 55335643 0040 0008 0c00 0100 cc01000000000000 0000 0400\n"
       "< 55335643 0380 0108 0000 0100\n",
       PLACIDO_SYSTEM, "no such address"},
      {"> timeout\n> timeout\n> timeout\n> timeout\n> timeout\n", PLACIDO_SYSTEM,
       "does not answer"},
      {"> gone\n", PLACIDO_GONE, "unplugged"},
      {"> 55335643 0040 0008 0c00 0100 cc01000000000000 0000 0400\n"
       "< 55335643 0000 0108 0400 0100 64000000\n"
       "> 55335643 0040 0008 0c00 0200 d801000000000000 0000 0800\n"
       "< 55335643 0000 0108 0800 0200 0000000000000000\n",
       PLACIDO_INPUT, "cannot be at 0x0"},
      {"> 55335643 0040 0008 0c00 0100 cc01000000000000 0000 0400\n"
       "< 55335643 0000 0108 0400 0100 64000000\n"
       "> 55335643 0040 0008 0c00 0200 d801000000000000 0000 0800\n"
       "< 55335643 0000 0108 0800 0200 f0ffffffffffffff\n",
       PLACIDO_INPUT, "cannot be at 0xfffffffffffffff0"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    placido_error err = {0};
    script_play(cases[i].dialogue);
    assert_int_equal(placido_u3v_channel_open(&channel, &u3v_script_calls, NULL, 64, &err),
                     cases[i].status);
    assert_int_equal(err.status, cases[i].status);
    assert_non_null(strstr(err.text, cases[i].said));
    assert_null(channel.buffer);
    script_assert_over();
  }
  placido_memory_fail_at(1);
  assert_int_equal(placido_u3v_channel_open(&channel, &u3v_script_calls, NULL, 64, NULL),
                   PLACIDO_MEMORY);
  placido_memory_fail_at(0);
}

static enum placido_u3v_end hear(void *pipe, const uint8_t *bytes, size_t size, int timeout_ms) {
  (void)pipe;
  (void)bytes;
  (void)size;
  (void)timeout_ms;
  return PLACIDO_U3V_DONE;
}

/* Noise without end, in no time at all. */
static enum placido_u3v_end babble(void *pipe, uint8_t *bytes, size_t size, size_t *received,
                                   int timeout_ms) {
  (void)timeout_ms;
  ++*(int *)pipe;
  memset(bytes, 'U', size);
  *received = size;
  return PLACIDO_U3V_DONE;
}

static void a_camera_that_only_babbles_is_given_up(void **state) {
  (void)state;
  int count = 0;
  placido_u3v_calls calls = u3v_script_calls;
  calls.write = hear;
  calls.read = babble;
  assert_int_equal(placido_u3v_channel_open(&channel, &calls, &count, 64, NULL), PLACIDO_SYSTEM);
  assert_int_equal(count, 5 * 1000);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
  const struct CMUnitTest tests[] = {
      TEST(the_camera_is_asked_for_its_limits),
      TEST(numbers_are_read_and_written),
      TEST(long_transfers_go_in_pieces),
      TEST(numbers_of_commands_skip_zero),
      TEST(a_lost_answer_is_asked_for_again),
      TEST(a_late_answer_is_not_the_next_ones),
      TEST(noise_is_passed_over),
      TEST(silence_ends_after_five_tries),
      TEST(a_camera_that_asks_for_time_gets_it),
      TEST(nobody_gets_all_the_time_in_the_world),
      TEST(a_refusal_ends_at_once),
      TEST(a_busy_camera_is_asked_again),
      TEST(a_halted_endpoint_is_reset),
      TEST(what_usb_says_is_told),
      TEST(an_unplugged_camera_is_gone_at_once),
      TEST(answers_of_another_size_are_refused),
      TEST(an_answer_that_only_time_ends_counts),
      TEST(limits_that_no_camera_has_are_refused),
      TEST(a_camera_without_registers_is_not_opened),
      TEST(a_camera_that_only_babbles_is_given_up),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
