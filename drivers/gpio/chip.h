/* A chip found by its node or label, and its lines by number or name. */
#ifndef PLACIDO_DRIVERS_GPIO_CHIP_H
#define PLACIDO_DRIVERS_GPIO_CHIP_H

#include "drivers/gpio/lines.h"

#include <placido/status.h>
#include <stdbool.h>

typedef struct placido_gpio_chip {
  const placido_gpio_lines *lines;
  void *chip; /* NULL: closed */
  char path[1024];
  placido_gpio_chip_info info;
} placido_gpio_chip;

/* Opens the chip of an address without query: the path of a node or of a link to it, or a label. On
 * failure the chip is closed. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT (an address that
 * fits several chips, or none). */
int placido_gpio_chip_open(placido_gpio_chip *chip, const char *address,
                           const placido_gpio_lines *lines, placido_error *err);
void placido_gpio_chip_close(placido_gpio_chip *chip);

/* Whether the chip answers. */
bool placido_gpio_chip_is_there(const placido_gpio_chip *chip);

/* The offset of a line by its number or name. Returns PLACIDO_OK, PLACIDO_INPUT (no such line, or
 * several), PLACIDO_SYSTEM. */
int placido_gpio_chip_find(const placido_gpio_chip *chip, const char *line, unsigned *offset,
                           placido_error *err);

/* PLACIDO_GONE where the chip does not answer, else PLACIDO_SYSTEM, with a sentence for errno
 * `code` of an action on a line ("switching light"). */
int placido_gpio_chip_failed(const placido_gpio_chip *chip, const char *action, int code,
                             placido_error *err);

/* A sentence for a chip that could not be opened, in `text`. */
void placido_gpio_chip_refusal(char text[200], const char *path, int code);

#endif
