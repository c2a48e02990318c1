/* The wired lines of a chip: requested dark, switched, given up when the chip is gone. */
#include "drivers/gpio/board.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

void placido_gpio_board_let_go(placido_gpio_board *board) {
  for (size_t i = 0; i < PLACIDO_GPIO_ROLES; i++) {
    if (board->lines[i]) {
      board->chip.lines->release(board->lines[i]);
    }
    board->lines[i] = NULL;
  }
  memset(board->levels, 0, sizeof board->levels);
  placido_gpio_chip_close(&board->chip);
}

int placido_gpio_board_failed(placido_gpio_board *board, const char *action, int code,
                              placido_error *err) {
  const int status = placido_gpio_chip_failed(&board->chip, action, code, err);
  if (status == PLACIDO_GONE) {
    placido_gpio_board_let_go(board);
  }
  return status;
}

int placido_gpio_board_set(placido_gpio_board *board, enum placido_gpio_role role, int level,
                           placido_error *err) {
  char action[64];
  snprintf(action, sizeof action, "switching %s %s", placido_gpio_options[role],
           level ? "on" : "off");
  const int code = board->lines[role] ? board->chip.lines->set(board->lines[role], level) : ENODEV;
  if (code) {
    return placido_gpio_board_failed(board, action, code, err);
  }
  board->levels[role] = level;
  return PLACIDO_OK;
}

int placido_gpio_board_darken(placido_gpio_board *board, placido_error *err) {
  int status = PLACIDO_OK;
  for (int role = 0; role < PLACIDO_GPIO_OUTPUTS; role++) {
    if (board->lines[role]) {
      const int one =
          placido_gpio_board_set(board, (enum placido_gpio_role)role, 0, status ? NULL : err);
      status = status ? status : one;
    }
  }
  return status;
}

/* Why a line could not be had. */
static int refused(placido_gpio_board *board, enum placido_gpio_role role, unsigned offset,
                   int code, placido_error *err) {
  const placido_gpio_chip *chip = &board->chip;
  const char *name = placido_gpio_options[role];
  placido_gpio_line_info info;
  if (code == EBUSY && chip->lines->line_info(chip->chip, offset, &info) == 0) {
    return placido_error_set(
        err, PLACIDO_SYSTEM, "line %u (%s) of the GPIO chip %s (%s) is used by %s%.60s%s", offset,
        name, chip->info.name, chip->info.label, info.consumer[0] ? "\"" : "another program",
        info.consumer, info.consumer[0] ? "\"" : "");
  }
  const bool cannot_tell = (code == ENODEV || code == ENXIO) && role >= PLACIDO_GPIO_OUTPUTS;
  if (cannot_tell && placido_gpio_chip_is_there(chip)) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "the GPIO chip %s (%s) cannot tell of edges on line %u (%s): it has "
                             "no interrupts",
                             chip->info.name, chip->info.label, offset, name);
  }
  char action[64];
  snprintf(action, sizeof action, "requesting line %u (%s)", offset, name);
  return placido_gpio_board_failed(board, action, code, err);
}

static int request_line(placido_gpio_board *board, enum placido_gpio_role role, unsigned offset,
                        placido_error *err) {
  static const enum placido_gpio_use uses[] = {
      [PLACIDO_GPIO_LIGHT] = PLACIDO_GPIO_OUTPUT,  [PLACIDO_GPIO_FIXATION] = PLACIDO_GPIO_OUTPUT,
      [PLACIDO_GPIO_STROBE] = PLACIDO_GPIO_OUTPUT, [PLACIDO_GPIO_TRIGGER] = PLACIDO_GPIO_RISING,
      [PLACIDO_GPIO_PEDAL] = PLACIDO_GPIO_BOTH,
  };
  const placido_gpio_request request = {.offset = offset,
                                        .use = uses[role],
                                        .bias = board->wiring.bias,
                                        .is_active_low = board->wiring.wires[role].is_active_low};
  const int code = board->chip.lines->request(&board->lines[role], board->chip.chip, &request);
  return code ? refused(board, role, offset, code, err) : PLACIDO_OK;
}

/* The offsets of all wired lines, before any of them is touched. */
static int find_lines(const placido_gpio_board *board, unsigned offsets[PLACIDO_GPIO_ROLES],
                      placido_error *err) {
  const placido_gpio_wire *wires = board->wiring.wires;
  int status = PLACIDO_OK;
  for (int role = 0; !status && role < PLACIDO_GPIO_ROLES; role++) {
    if (!wires[role].line[0]) {
      continue;
    }
    status = placido_gpio_chip_find(&board->chip, wires[role].line, &offsets[role], err);
    for (int other = 0; !status && other < role; other++) {
      if (wires[other].line[0] && offsets[other] == offsets[role]) {
        status = placido_error_set(err, PLACIDO_INPUT, "%s and %s are both line %u",
                                   placido_gpio_options[other], placido_gpio_options[role],
                                   offsets[role]);
      }
    }
  }
  return status;
}

int placido_gpio_board_request(placido_gpio_board *board, placido_error *err) {
  unsigned offsets[PLACIDO_GPIO_ROLES] = {0};
  int status = find_lines(board, offsets, err);
  for (int role = 0; !status && role < PLACIDO_GPIO_ROLES; role++) {
    if (board->wiring.wires[role].line[0]) {
      status = request_line(board, (enum placido_gpio_role)role, offsets[role], err);
    }
  }
  return status;
}
