/* From edges to events: the trigger counted edge by edge, the pedal debounced. */
#ifndef PLACIDO_DRIVERS_GPIO_INPUTS_H
#define PLACIDO_DRIVERS_GPIO_INPUTS_H

#include "drivers/gpio/debounce.h"
#include "drivers/gpio/lines.h"

#include <placido/device.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A read of each input, and the pedal's last change. */
#define PLACIDO_GPIO_EVENTS_MAX (2 * PLACIDO_GPIO_EDGES_MAX + 1)

/* Zeroed has no inputs. Counts and numbers go on over starts. */
typedef struct placido_gpio_inputs {
  const placido_gpio_lines *lines;
  void *trigger, *pedal; /* requested lines, borrowed; NULL: not wired */
  placido_gpio_debounce debounce;
  placido_event events[PLACIDO_GPIO_EVENTS_MAX]; /* found, not yet given out */
  size_t event_count, event_next;
  uint64_t seq; /* of the last event */
  uint64_t trigger_count, lost_count;
} placido_gpio_inputs;

/* Forgets what came before, and takes the pedal as it stands. Returns 0 or errno. */
int placido_gpio_inputs_start(placido_gpio_inputs *inputs);

/* The next event: a trigger at once, a change of the pedal when it has stood still, which may be
 * after later triggers. A number is left out for every edge that the kernel lost. Returns
 * 0, ETIMEDOUT, EOVERFLOW (the kernel stamps edges with another clock), or errno. */
int placido_gpio_inputs_next(placido_gpio_inputs *inputs, placido_event *event, int timeout_ms);

#endif
