/* What tests do with a GPIO chip whose script is `gpio_fake`. */
#ifndef PLACIDO_TESTS_DRIVERS_GPIO_USE_H
#define PLACIDO_TESTS_DRIVERS_GPIO_USE_H

#include "drivers/gpio/gpio.h"
#include "tests/drivers/device_use.h"
#include "tests/drivers/gpio_fake.h"

/* The time on the kernel's clock, `ms` after the script's start. */
int64_t at(double ms);

void *open_chip(const char *address);
void *start_chip(const char *address);

#endif
