/* What tests do with a GPIO chip whose script is `gpio_fake`. */
#include "tests/drivers/gpio_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

const placido_driver *const driver = &placido_gpio_driver;

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
  return started(open_chip(address));
}
