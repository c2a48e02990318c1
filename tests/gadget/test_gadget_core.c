/* Every USB device answers the standard requests in the same way, whatever its function does. */
#include "gadget/function.h"
#include "gadget/picture.h"
#include "gadget/strings.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

#define IN 0x80

static const uint8_t device[18] = {18, 1, 0, 2, 0xEF, 2, 1, 64, 9, 18, 1, 0, 0, 1, 1, 2, 3, 1};
/* Two interfaces; the second has two alternate settings, the endpoint in the latter. */
static const uint8_t configuration[] = {
    9, 2, 50, 0, 2, 5, 0, 0x80, 50, 9, 4, 0, 0, 1, 255, 0, 0, 0, 7, 5, 0x81, 2, 0, 2, 0,
    9, 4, 1, 0, 0, 255, 0, 0, 0, 9, 4, 1, 1, 1, 255, 0, 0, 0, 7, 5, 0x02, 2, 0, 2, 0};

/* What the function was told. */
static struct {
  int interface, alternate, configured_count;
  int endpoint, is_halted, halted_count;
  int control_count, transfer_count;
  enum placido_gadget_answer answer;
} told;

static const uint8_t *give_descriptor(void *state, uint8_t type, uint8_t index, size_t *size) {
  (void)state;
  *size = type == 1 ? sizeof device : sizeof configuration;
  return index > 0 || type > 2 ? NULL : type == 1 ? device : configuration;
}

static void configured(void *state, uint8_t interface, uint8_t alternate) {
  (void)state;
  told.interface = interface;
  told.alternate = alternate;
  told.configured_count++;
}

static void halted(void *state, uint8_t endpoint, int is_halted) {
  (void)state;
  told.endpoint = endpoint;
  told.is_halted = is_halted;
  told.halted_count++;
}

static enum placido_gadget_answer own_control(void *state, const placido_gadget_setup *setup,
                                              uint8_t *data, size_t *size) {
  (void)state;
  (void)data;
  told.control_count++;
  *size = setup->request;
  return told.answer;
}

static enum placido_gadget_answer out(void *state, uint8_t endpoint, const uint8_t *bytes,
                                      size_t size) {
  (void)state;
  (void)endpoint;
  (void)bytes;
  (void)size;
  told.transfer_count++;
  return told.answer;
}

static enum placido_gadget_answer in(void *state, uint8_t endpoint, uint8_t *bytes, size_t size,
                                     size_t *sent) {
  (void)state;
  (void)endpoint;
  memset(bytes, 7, size);
  *sent = size;
  told.transfer_count++;
  return told.answer;
}

static const placido_gadget_function function = {.name = "test",
                                                 .descriptor = give_descriptor,
                                                 .control = own_control,
                                                 .configured = configured,
                                                 .out = out,
                                                 .in = in,
                                                 .halted = halted};
static placido_gadget gadget;
static uint8_t bytes[256];

static int set_up(void **state) {
  (void)state;
  memset(&told, 0, sizeof told);
  told.answer = PLACIDO_GADGET_DONE;
  gadget = (placido_gadget){.function = &function, .speed = PLACIDO_GADGET_HIGH};
  return 0;
}

/* Returns the answer's size; -1: a stall. */
static int ask(uint8_t type, uint8_t request, uint16_t value, uint16_t index, uint16_t length) {
  const placido_gadget_setup setup = {type, request, value, index, length};
  size_t size = length;
  memset(bytes, 0xEE, sizeof bytes);
  const enum placido_gadget_answer answer =
      placido_gadget_transfer(&gadget, 0, &setup, bytes, &size);
  assert_int_not_equal(answer, PLACIDO_GADGET_LATER);
  return answer == PLACIDO_GADGET_DONE ? (int)size : -1;
}

static enum placido_gadget_answer transfer(uint8_t endpoint, size_t size) {
  return placido_gadget_transfer(&gadget, endpoint, NULL, bytes, &size);
}

static void descriptors_are_cut_to_what_was_asked_for(void **state) {
  (void)state;
  assert_int_equal(ask(IN, 6, 0x0100, 0, 18), 18);
  assert_memory_equal(bytes, device, 18);
  assert_int_equal(ask(IN, 6, 0x0100, 0, 8), 8);
  assert_int_equal(bytes[8], 0xEE);
  assert_int_equal(ask(IN, 6, 0x0200, 0, 255), (int)sizeof configuration);
  assert_int_equal(ask(IN, 6, 0x0300, 0, 255), -1);
  assert_int_equal(ask(IN, 6, 0x0101, 0, 18), -1);
}

static void only_a_device_of_high_speed_has_a_qualifier(void **state) {
  (void)state;
  static const uint8_t qualifier[10] = {10, 6, 0, 2, 0xEF, 2, 1, 64, 1, 0};
  assert_int_equal(ask(IN, 6, 0x0600, 0, 10), 10);
  assert_memory_equal(bytes, qualifier, 10);
  gadget.speed = PLACIDO_GADGET_SUPER;
  assert_int_equal(ask(IN, 6, 0x0600, 0, 10), -1);
}

static void a_configuration_is_chosen_by_its_value(void **state) {
  (void)state;
  assert_int_equal(ask(0, 9, 4, 0, 0), -1);
  assert_int_equal(told.configured_count, 0);
  assert_int_equal(ask(0, 9, 5, 0, 0), 0);
  assert_int_equal(told.interface, 0xFF);
  assert_int_equal(told.alternate, 5);
  assert_int_equal(ask(IN, 8, 0, 0, 1), 1);
  assert_int_equal(bytes[0], 5);
  assert_int_equal(ask(0, 9, 0, 0, 0), 0);
  assert_int_equal(ask(IN, 8, 0, 0, 1), 1);
  assert_int_equal(bytes[0], 0);
}

static void an_interface_has_the_settings_that_its_descriptors_name(void **state) {
  (void)state;
  assert_int_equal(ask(1, 11, 1, 1, 0), 0);
  assert_int_equal(told.interface, 1);
  assert_int_equal(told.alternate, 1);
  assert_int_equal(ask(IN | 1, 10, 0, 1, 1), 1);
  assert_int_equal(bytes[0], 1);
  assert_int_equal(ask(1, 11, 2, 1, 0), -1);
  assert_int_equal(ask(1, 11, 0, 2, 0), -1);
  assert_int_equal(ask(IN | 1, 10, 0, 300, 1), -1);
  assert_int_equal(told.configured_count, 1);
}

static void a_setting_begins_with_endpoints_that_are_not_halted(void **state) {
  (void)state;
  assert_int_equal(ask(2, 3, 0, 0x02, 0), 0);
  assert_int_equal(ask(2, 3, 0, 0x81, 0), 0);
  assert_int_equal(ask(1, 11, 1, 1, 0), 0);
  assert_int_equal(transfer(0x02, 4), PLACIDO_GADGET_DONE);
  assert_int_equal(transfer(0x81, 4), PLACIDO_GADGET_STALL); /* of the other interface */
}

static void a_halt_lasts_until_the_host_clears_it(void **state) {
  (void)state;
  told.answer = PLACIDO_GADGET_STALL;
  assert_int_equal(transfer(0x81, 4), PLACIDO_GADGET_STALL);
  told.answer = PLACIDO_GADGET_DONE;
  assert_int_equal(transfer(0x81, 4), PLACIDO_GADGET_STALL);
  assert_int_equal(told.transfer_count, 1); /* the function is not asked while it is halted */
  assert_int_equal(transfer(0x01, 4), PLACIDO_GADGET_DONE); /* the other direction is another one */
  assert_int_equal(ask(IN | 2, 0, 0, 0x81, 2), 2);
  assert_int_equal(bytes[0], 1);
  assert_int_equal(ask(2, 1, 0, 0x81, 0), 0);
  assert_int_equal(told.endpoint, 0x81);
  assert_int_equal(told.is_halted, 0);
  assert_int_equal(ask(IN | 2, 0, 0, 0x81, 2), 2);
  assert_int_equal(bytes[0], 0);
  assert_int_equal(transfer(0x81, 4), PLACIDO_GADGET_DONE);
}

static void the_host_may_halt_an_endpoint_itself(void **state) {
  (void)state;
  assert_int_equal(ask(2, 3, 0, 0x02, 0), 0);
  assert_int_equal(told.is_halted, 1);
  assert_int_equal(transfer(0x02, 4), PLACIDO_GADGET_STALL);
  assert_int_equal(ask(2, 3, 1, 0x02, 0), -1); /* no such feature */
  assert_int_equal(ask(2, 3, 0, 0x80, 0), 0);
  assert_int_equal(ask(IN, 8, 0, 0, 1), 1); /* endpoint 0 goes on */
}

static void power_saving_and_delays_are_accepted(void **state) {
  (void)state;
  assert_int_equal(ask(0, 0x30, 0, 0, 6), 6);  /* SET_SEL: six bytes are taken */
  assert_int_equal(ask(0, 0x31, 40, 0, 0), 0); /* SET_ISOCH_DELAY */
  assert_int_equal(ask(0, 3, 48, 0, 0), 0);    /* U1 enable */
  assert_int_equal(ask(IN, 0, 0, 0, 2), 2);
  assert_int_equal(bytes[0] | bytes[1], 0);
  assert_int_equal(told.control_count, 0);
}

static void what_is_not_standard_is_the_functions(void **state) {
  (void)state;
  assert_int_equal(ask(0xA1, 0x81, 0x0100, 1, 200), 0x81);
  assert_int_equal(told.control_count, 1);
  told.answer = PLACIDO_GADGET_STALL;
  assert_int_equal(ask(0xA1, 0x81, 0x0100, 1, 4), -1);
  told.answer = PLACIDO_GADGET_DONE;
  assert_int_equal(ask(0xA1, 4, 0, 1, 4), 4); /* a stall of control lasts for one request */
}

/* Descriptors whose lengths lie are read no further than they reach. */
static const uint8_t lying[] = {9, 2, 20, 0, 1, 1, 0, 0x80, 0, 0, 4, 0, 0, 1, 255, 0, 0, 0, 7, 5};

static const uint8_t *give_lies(void *state, uint8_t type, uint8_t index, size_t *size) {
  (void)state;
  (void)type;
  (void)index;
  *size = sizeof lying;
  return lying;
}

static void broken_descriptors_are_survived(void **state) {
  (void)state;
  const placido_gadget_function liar = {.descriptor = give_lies};
  gadget.function = &liar;
  assert_int_equal(ask(1, 11, 0, 0, 0), -1);
  assert_int_equal(ask(0, 9, 1, 0, 0), 0);
  assert_int_equal(ask(0xA1, 4, 0, 1, 4), -1);
  assert_int_equal(transfer(0x81, 4), PLACIDO_GADGET_STALL);
  assert_int_equal(placido_gadget_tick(&gadget, 5), INT64_MAX);
}

static void strings_are_utf_16(void **state) {
  (void)state;
  uint8_t text[PLACIDO_GADGET_STRING_BYTES_MAX];
  char longest[300];
  assert_int_equal(placido_gadget_string(text, "A\n"), 6);
  assert_memory_equal(text, "\x06\x03" "A\0?\0", 6);
  assert_int_equal(placido_gadget_languages(text), 4);
  assert_memory_equal(text, "\x04\x03\x09\x04", 4);
  memset(longest, 'x', sizeof longest - 1);
  longest[sizeof longest - 1] = '\0';
  assert_int_equal(placido_gadget_string(text, longest), PLACIDO_GADGET_STRING_BYTES_MAX);
  assert_int_equal(text[0], PLACIDO_GADGET_STRING_BYTES_MAX);
}

static void faults_are_found_by_the_names_they_have(void **state) {
  (void)state;
  for (int i = 0; i < PLACIDO_GADGET_FAULTS; i++) {
    const char *name = placido_gadget_fault_name((enum placido_gadget_fault)i);
    assert_int_equal(placido_gadget_fault_by_name(name), i);
  }
  assert_int_equal(placido_gadget_fault_by_name("lost-start"), PLACIDO_GADGET_FAULT_LOST_START);
  assert_int_equal(placido_gadget_fault_by_name("Stall"), -1);
}

#define TEST(name) cmocka_unit_test_setup(name, set_up)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(descriptors_are_cut_to_what_was_asked_for),
      TEST(only_a_device_of_high_speed_has_a_qualifier),
      TEST(a_configuration_is_chosen_by_its_value),
      TEST(an_interface_has_the_settings_that_its_descriptors_name),
      TEST(a_setting_begins_with_endpoints_that_are_not_halted),
      TEST(a_halt_lasts_until_the_host_clears_it),
      TEST(the_host_may_halt_an_endpoint_itself),
      TEST(power_saving_and_delays_are_accepted),
      TEST(what_is_not_standard_is_the_functions),
      TEST(broken_descriptors_are_survived),
      TEST(strings_are_utf_16),
      TEST(faults_are_found_by_the_names_they_have),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
