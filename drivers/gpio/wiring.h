/* What a device's address says of the wiring: "?light=5&pedal=!7&bias=pull-up&debounce_ms=20". */
#ifndef PLACIDO_DRIVERS_GPIO_WIRING_H
#define PLACIDO_DRIVERS_GPIO_WIRING_H

#include "drivers/gpio/lines.h"

#include <placido/status.h>
#include <stdbool.h>

/* In the order of placido_gpio_options: outputs, then inputs. */
enum placido_gpio_role {
  PLACIDO_GPIO_LIGHT,
  PLACIDO_GPIO_FIXATION,
  PLACIDO_GPIO_STROBE,
  PLACIDO_GPIO_TRIGGER,
  PLACIDO_GPIO_PEDAL,
  PLACIDO_GPIO_ROLES,
};
#define PLACIDO_GPIO_OUTPUTS PLACIDO_GPIO_TRIGGER

#define PLACIDO_GPIO_DEBOUNCE_MAX_MS 1000

typedef struct placido_gpio_wire {
  char line[PLACIDO_GPIO_NAME_MAX]; /* its number or name; empty: not wired */
  bool is_active_low;
} placido_gpio_wire;

typedef struct placido_gpio_wiring {
  placido_gpio_wire wires[PLACIDO_GPIO_ROLES];
  enum placido_gpio_bias bias; /* of all inputs */
  double debounce_ms;          /* of the pedal */
} placido_gpio_wiring;

/* The settings that this file knows, ended by NULL: the roles' names, "bias", "debounce_ms". */
extern const char *const placido_gpio_options[];

/* Reads the settings that are known from a query (may be NULL) and skips the others: they are
 * controls. Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_gpio_wiring_read(placido_gpio_wiring *wiring, const char *query, placido_error *err);

#endif
