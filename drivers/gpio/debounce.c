/* Debouncing of a contact by the times of its edges. */
#include "drivers/gpio/debounce.h"

void placido_gpio_debounce_start(placido_gpio_debounce *debounce, int level) {
  debounce->level = debounce->raw = level;
  debounce->is_moving = false;
}

bool placido_gpio_debounce_settle(placido_gpio_debounce *debounce, int64_t now_ns,
                                  placido_gpio_change *change) {
  *change = (placido_gpio_change){0};
  if (now_ns < placido_gpio_debounce_due_ns(debounce)) {
    return false;
  }
  debounce->is_moving = false;
  if (debounce->raw == debounce->level) {
    debounce->bounce_count++; /* its first edge, which began nothing */
    return false;
  }
  debounce->level = debounce->raw;
  *change = (placido_gpio_change){.t_ns = debounce->first_ns, .level = debounce->level};
  return true;
}

bool placido_gpio_debounce_edge(placido_gpio_debounce *debounce, int64_t t_ns, int level,
                                placido_gpio_change *change) {
  const bool is_change = placido_gpio_debounce_settle(debounce, t_ns, change);
  if (!debounce->is_moving) {
    debounce->is_moving = true;
    debounce->first_ns = debounce->last_ns = t_ns;
  } else {
    debounce->bounce_count++;
    debounce->last_ns = t_ns > debounce->last_ns ? t_ns : debounce->last_ns;
  }
  debounce->raw = level;
  return is_change;
}

int64_t placido_gpio_debounce_due_ns(const placido_gpio_debounce *debounce) {
  return debounce->is_moving ? debounce->last_ns + debounce->hold_ns : INT64_MAX;
}
