/* What a device's address says of the wiring. */
#include "drivers/gpio/wiring.h"

#include "drivers/settings.h"

#include <string.h>

/* The contacts of pedals come to rest within some 10 ms; nobody feels 20. */
#define DEBOUNCE_USUAL_MS 20

const char *const placido_gpio_options[] = {
    [PLACIDO_GPIO_LIGHT] = "light",           [PLACIDO_GPIO_FIXATION] = "fixation",
    [PLACIDO_GPIO_STROBE] = "strobe",         [PLACIDO_GPIO_TRIGGER] = "trigger",
    [PLACIDO_GPIO_PEDAL] = "pedal",           [PLACIDO_GPIO_ROLES] = "bias",
    [PLACIDO_GPIO_ROLES + 1] = "debounce_ms", NULL,
};

static int read_wire(placido_gpio_wire *wire, const char *role, const char *value,
                     placido_error *err) {
  const bool is_active_low = *value == '!' || *value == '-';
  const char *line = value + is_active_low;
  if (!*line || strlen(line) >= sizeof wire->line) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s=%.80s is not the number or name of a line, with ! or - before it "
                             "where it is active low, such as %s=5 or %s=!5",
                             role, value, role, role);
  }
  wire->is_active_low = is_active_low;
  memcpy(wire->line, line, strlen(line) + 1);
  return PLACIDO_OK;
}

static int read_bias(enum placido_gpio_bias *bias, const char *value, placido_error *err) {
  static const char *const names[] = {
      [PLACIDO_GPIO_BIAS_AS_IS] = "as-is",
      [PLACIDO_GPIO_BIAS_NONE] = "none",
      [PLACIDO_GPIO_BIAS_UP] = "pull-up",
      [PLACIDO_GPIO_BIAS_DOWN] = "pull-down",
  };
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    if (strcmp(names[i], value) == 0) {
      *bias = (enum placido_gpio_bias)i;
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "bias=%.80s is not one of pull-up, pull-down, none, as-is", value);
}

static int read_debounce(double *debounce_ms, const char *value, placido_error *err) {
  if (!placido_setting_read_number(debounce_ms, value) ||
      !(*debounce_ms >= 0 && *debounce_ms <= PLACIDO_GPIO_DEBOUNCE_MAX_MS)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "debounce_ms=%.80s is not a number of milliseconds from 0 to %d",
                             value, PLACIDO_GPIO_DEBOUNCE_MAX_MS);
  }
  return PLACIDO_OK;
}

/* One setting, by its place in the list of options. */
static int read_option(void *target, size_t option, const char *value, placido_error *err) {
  placido_gpio_wiring *wiring = target;
  if (option < PLACIDO_GPIO_ROLES) {
    return read_wire(&wiring->wires[option], placido_gpio_options[option], value, err);
  }
  return option == PLACIDO_GPIO_ROLES ? read_bias(&wiring->bias, value, err)
                                      : read_debounce(&wiring->debounce_ms, value, err);
}

int placido_gpio_wiring_read(placido_gpio_wiring *wiring, const char *query, placido_error *err) {
  *wiring = (placido_gpio_wiring){.debounce_ms = DEBOUNCE_USUAL_MS};
  const placido_settings settings = {.names = placido_gpio_options,
                                     .longest = PLACIDO_SETTING_MAX,
                                     .read = read_option};
  return placido_settings_read(&settings, wiring, query, err);
}
