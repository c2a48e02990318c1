/* The wired lines of a chip: requested dark, switched, given up when the chip is gone. */
#ifndef PLACIDO_DRIVERS_GPIO_BOARD_H
#define PLACIDO_DRIVERS_GPIO_BOARD_H

#include "drivers/gpio/chip.h"
#include "drivers/gpio/wiring.h"

#include <placido/status.h>

/* Zeroed but for chip and wiring has no lines. */
typedef struct placido_gpio_board {
  placido_gpio_wiring wiring;
  placido_gpio_chip chip;          /* closed while the chip is lost */
  void *lines[PLACIDO_GPIO_ROLES]; /* NULL: not wired, or lost */
  int levels[PLACIDO_GPIO_OUTPUTS];
} placido_gpio_board;

/* Requests every wired line of the open chip, outputs dark. On failure the board may hold some of
 * them: let it go. Returns PLACIDO_OK, PLACIDO_INPUT (no such line), PLACIDO_SYSTEM (in use, ...),
 * PLACIDO_UNSUPPORTED (an input that cannot tell of edges), PLACIDO_GONE. */
int placido_gpio_board_request(placido_gpio_board *board, placido_error *err);

/* Releases the lines and closes the chip, so that the kernel can forget one that was unplugged. */
void placido_gpio_board_let_go(placido_gpio_board *board);

/* Switches an output. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_GONE. */
int placido_gpio_board_set(placido_gpio_board *board, enum placido_gpio_role role, int level,
                           placido_error *err);

/* Switches all outputs off, whatever becomes of one of them; the first failure is told. */
int placido_gpio_board_darken(placido_gpio_board *board, placido_error *err);

/* The status and sentence for errno `code` of an action: as placido_gpio_chip_failed, and a board
 * whose chip is gone is let go. */
int placido_gpio_board_failed(placido_gpio_board *board, const char *action, int code,
                              placido_error *err);

#endif
