/* Lights are lit by set alone; an address is held to what it may say; who cannot have a line is
 * told why. */
#include "tests/drivers/gpio_use.h"

#include <errno.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

static void refuse(const char *address, int status, const char *text) {
  void *chip;
  placido_error err = {0};
  assert_int_equal(placido_gpio_open(&chip, address, &gpio_fake_lines, NULL, &err), status);
  assert_null(chip);
  assert_says(&err, text);
}

static void lights_shine_only_between_set_and_stop(void **state) {
  (void)state;
  gpio_fake.lines[5].voltage = 1; /* left on by a program that was killed */
  void *chip = open_chip("/dev/gpiochip0?light=5&fixation=!6&strobe=-7");
  const struct fake_line *light = &gpio_fake.lines[5], *fixation = &gpio_fake.lines[6];
  assert_int_equal(light->voltage, 0);
  assert_int_equal(fixation->voltage, 1);
  assert_int_equal(gpio_fake.lines[7].voltage, 1);
  set(chip, "light", 1);
  set(chip, "fixation", 1);
  assert_int_equal(light->voltage, 1);
  assert_int_equal(fixation->voltage, 0);
  assert_int_equal(value_of(chip, "light"), 1);
  assert_int_equal(driver->start(chip, NULL), PLACIDO_OK);
  assert_int_equal(light->voltage, 1);
  assert_int_equal(driver->stop(chip, NULL), PLACIDO_OK);
  assert_int_equal(light->voltage, 0);
  assert_int_equal(fixation->voltage, 1);
  assert_int_equal(value_of(chip, "fixation"), 0);
  assert_int_equal(driver->start(chip, NULL), PLACIDO_OK);
  assert_int_equal(light->voltage, 0);
  set(chip, "light", 1);
  driver->close(chip);
  assert_int_equal(light->voltage, 0);
}

static void an_open_that_fails_leaves_no_line_held(void **state) {
  (void)state;
  gpio_fake.lines[7].consumer = "fan";
  refuse("/dev/gpiochip0?light=5&pedal=7", PLACIDO_SYSTEM,
         "line 7 (pedal) of the GPIO chip gpiochip0 (fake) is used by \"fan\"");
  assert_int_equal(gpio_fake.requested_count, 0);
  assert_int_equal(gpio_fake.lines[5].voltage, 0);
}

static void a_chip_and_its_lines_have_names(void **state) {
  (void)state;
  gpio_fake.lines[3].name = "RINGLIGHT";
  void *chip = open_chip("fake?light=!RINGLIGHT");
  assert_string_equal(driver->info(chip)->uri, "gpio:fake");
  assert_string_equal(driver->info(chip)->model, "fake");
  assert_true(gpio_fake.lines[3].is_requested && gpio_fake.lines[3].as.is_active_low);
  driver->close(chip);
  gpio_fake.lines[4].name = "RINGLIGHT";
  refuse("fake?light=RINGLIGHT", PLACIDO_INPUT, "more than one line called \"RINGLIGHT\"");
  refuse("fake?light=ringlight", PLACIDO_INPUT, "no line called \"ringlight\"");
  refuse("lamp?light=3", PLACIDO_SYSTEM, "no GPIO chip \"lamp\" is there");
  gpio_fake.other_path = "/dev/gpiochip1";
  gpio_fake.other_label = "fake";
  refuse("fake?light=3", PLACIDO_INPUT, "2 GPIO chips are called \"fake\"");
  driver->close(open_chip("gpiochip0?light=3"));
}

static void addresses_are_held_to_what_they_may_say(void **state) {
  (void)state;
  refuse("?light=5", PLACIDO_INPUT, "is not gpio:/dev/gpiochipN or gpio:LABEL");
  refuse("/dev/gpiochip0?light=", PLACIDO_INPUT, "light= is not the number or name");
  refuse("/dev/gpiochip0?light=!", PLACIDO_INPUT, "light=! is not the number or name");
  refuse("/dev/gpiochip0?light=10", PLACIDO_INPUT, "has 10 lines from 0, and no line 10");
  refuse("/dev/gpiochip0?light=99999999999", PLACIDO_INPUT, "no line 99999999999");
  refuse("/dev/gpiochip0?light=5&fixation=5", PLACIDO_INPUT, "light and fixation are both line 5");
  refuse("/dev/gpiochip0?bias=up", PLACIDO_INPUT, "bias=up is not one of pull-up");
  refuse("/dev/gpiochip0?debounce_ms=soon", PLACIDO_INPUT, "debounce_ms=soon is not a number");
  refuse("/dev/gpiochip0?debounce_ms=1001", PLACIDO_INPUT, "from 0 to 1000");
  refuse("/dev/gpiochip0?debounce_ms=nan", PLACIDO_INPUT, "from 0 to 1000");
  refuse("/dev/gpiochip9?light=5", PLACIDO_SYSTEM, "cannot open /dev/gpiochip9");
}

static void a_chip_that_may_not_be_opened_says_how_to(void **state) {
  (void)state;
  gpio_fake.open_code = EACCES;
  refuse("/dev/gpiochip0?light=5", PLACIDO_SYSTEM, "be in the group gpio");
  refuse("fake?light=5", PLACIDO_SYSTEM, "be in the group gpio");
  gpio_fake.open_code = ENODEV;
  refuse("/dev/null?light=5", PLACIDO_SYSTEM, "/dev/null is not a GPIO chip");
}

static void inputs_are_requested_as_asked(void **state) {
  (void)state;
  void *chip = open_chip("/dev/gpiochip0?trigger=4&pedal=!8&bias=pull-up&light=5");
  assert_int_equal(gpio_fake.lines[4].as.use, PLACIDO_GPIO_RISING);
  assert_int_equal(gpio_fake.lines[8].as.use, PLACIDO_GPIO_BOTH);
  assert_int_equal(gpio_fake.lines[8].as.bias, PLACIDO_GPIO_BIAS_UP);
  assert_true(gpio_fake.lines[8].as.is_active_low);
  driver->close(chip);
  gpio_fake.lines[8].has_no_interrupt = true;
  refuse("/dev/gpiochip0?pedal=8", PLACIDO_UNSUPPORTED, "cannot tell of edges on line 8 (pedal)");
}

static void only_what_is_wired_has_controls(void **state) {
  (void)state;
  size_t count;
  placido_notes notes = {0};
  void *chip = open_chip("/dev/gpiochip0?light=5");
  driver->controls(chip, &count);
  assert_int_equal(count, 1);
  driver->close(chip);
  assert_int_equal(
      placido_gpio_open(&chip, "/dev/gpiochip0", &gpio_fake_lines, &notes, NULL), PLACIDO_OK);
  driver->controls(chip, &count);
  assert_int_equal(count, 0);
  assert_int_equal(notes.count, 1);
  placido_notes_clear(&notes);
  placido_event event;
  assert_int_equal(driver->start(chip, NULL), PLACIDO_OK);
  assert_int_equal(driver->event(chip, &event, 0, NULL), PLACIDO_UNSUPPORTED);
  driver->close(chip);
  chip = open_chip("/dev/gpiochip0?pedal=7&debounce_ms=12.5");
  assert_true(value_of(chip, "debounce_ms") == 12.5);
  set(chip, "debounce_ms", 30);
  assert_true(value_of(chip, "debounce_ms") == 30);
  assert_int_equal(driver->set(chip, control_index(chip, "pedal"), 1, NULL),
                   PLACIDO_UNSUPPORTED);
  driver->close(chip);
}

struct seen {
  int count;
  char text[600];
};

static int see(void *user, const char *uri, const char *description) {
  struct seen *seen = user;
  seen->count++;
  snprintf(seen->text, sizeof seen->text, "%s %s", uri, description);
  return 0;
}

static void the_scan_tells_chips_and_who_may_open_them(void **state) {
  (void)state;
  struct seen seen = {0};
  gpio_fake.other_path = "/dev/gpiochip1";
  gpio_fake.other_label = "expander";
  assert_int_equal(placido_gpio_scan(&gpio_fake_lines, see, &seen, NULL), PLACIDO_OK);
  assert_int_equal(seen.count, 2);
  assert_string_equal(seen.text, "gpio:/dev/gpiochip1 GPIO chip expander, 10 lines");
  gpio_fake.open_code = EACCES;
  assert_int_equal(placido_gpio_scan(&gpio_fake_lines, see, &seen, NULL), PLACIDO_OK);
  assert_non_null(strstr(seen.text, "be in the group gpio"));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, reset, nothing_is_left)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(lights_shine_only_between_set_and_stop),
      TEST(an_open_that_fails_leaves_no_line_held),
      TEST(a_chip_and_its_lines_have_names),
      TEST(addresses_are_held_to_what_they_may_say),
      TEST(a_chip_that_may_not_be_opened_says_how_to),
      TEST(inputs_are_requested_as_asked),
      TEST(only_what_is_wired_has_controls),
      TEST(the_scan_tells_chips_and_who_may_open_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
