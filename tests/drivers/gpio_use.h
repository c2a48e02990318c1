/* What tests do with a GPIO chip whose script is `gpio_fake`. */
#ifndef PLACIDO_TESTS_DRIVERS_GPIO_USE_H
#define PLACIDO_TESTS_DRIVERS_GPIO_USE_H

#include "drivers/gpio/gpio.h"
#include "tests/drivers/gpio_fake.h"

/* The time on the kernel's clock, `ms` after the script's start. */
int64_t at(double ms);

/* Setup, and teardown that fails where something of the chip is held. */
int reset(void **state);
int nothing_is_left(void **state);

void *open_chip(const char *address);
void *start_chip(const char *address);
void assert_says(const placido_error *err, const char *text);

/* The place of a control in the driver's list; its value. */
size_t control_index(void *chip, const char *name);
void set(void *chip, const char *name, double value);
double get(void *chip, const char *name);

#endif
