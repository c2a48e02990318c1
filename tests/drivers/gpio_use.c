/* What tests do with a GPIO chip whose script is `gpio_fake`. */
#include "tests/drivers/gpio_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static const placido_driver *const driver = &placido_gpio_driver;

int64_t at(double ms) {
  return 5000000000 + (int64_t)(ms * FAKE_MS);
}

int reset(void **state) {
  (void)state;
  gpio_fake_reset();
  return 0;
}

int nothing_is_left(void **state) {
  (void)state;
  return gpio_fake.open_count == 0 && gpio_fake.requested_count == 0 ? 0 : -1;
}

void *open_chip(const char *address) {
  void *chip;
  placido_error err = {0};
  if (placido_gpio_open(&chip, address, &gpio_fake_lines, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  return chip;
}

void *start_chip(const char *address) {
  void *chip = open_chip(address);
  placido_error err = {0};
  if (driver->start(chip, &err)) {
    fail_msg("%s", err.text);
  }
  return chip;
}

void assert_says(const placido_error *err, const char *text) {
  if (!strstr(err->text, text)) {
    fail_msg("\"%s\" does not say \"%s\"", err->text, text);
  }
}

size_t control_index(void *chip, const char *name) {
  size_t count;
  const placido_control *controls = driver->controls(chip, &count);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(controls[i].name, name) == 0) {
      return i;
    }
  }
  fail_msg("no control %s", name);
  return 0;
}

void set(void *chip, const char *name, double value) {
  assert_int_equal(driver->set(chip, control_index(chip, name), value, NULL), PLACIDO_OK);
}

double get(void *chip, const char *name) {
  double value;
  assert_int_equal(driver->get(chip, control_index(chip, name), &value, NULL), PLACIDO_OK);
  return value;
}
