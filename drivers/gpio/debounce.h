/* Debouncing of a contact by the times of its edges: a change counts once the line has stood still
 * for a while, and it dates from the first of its edges. */
#ifndef PLACIDO_DRIVERS_GPIO_DEBOUNCE_H
#define PLACIDO_DRIVERS_GPIO_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct placido_gpio_debounce {
  int64_t hold_ns;  /* so long must the line stand still; 0: every edge counts */
  int level;        /* that counts */
  int raw;          /* of the line behind its last edge */
  bool is_moving;   /* edges came, and it has not stood still since */
  int64_t first_ns; /* of these edges */
  int64_t last_ns;
  uint64_t bounce_count; /* edges that were not the beginning of a change */
} placido_gpio_debounce;

typedef struct placido_gpio_change {
  int64_t t_ns; /* of its first edge */
  int level;
} placido_gpio_change;

/* Starts with a line that stands still. Bounces are counted on. */
void placido_gpio_debounce_start(placido_gpio_debounce *debounce, int level);

/* Takes an edge, in the order of time (an earlier time counts as the last one), behind which the
 * line is at `level`. Two edges so close together that both are seen with the level behind the
 * second are an edge to the same level: a bounce. True where the edges before it were a change. */
bool placido_gpio_debounce_edge(placido_gpio_debounce *debounce, int64_t t_ns, int level,
                                placido_gpio_change *change);

/* No further edge came until `now_ns`. True where the edges were a change. */
bool placido_gpio_debounce_settle(placido_gpio_debounce *debounce, int64_t now_ns,
                                  placido_gpio_change *change);

/* When settle will have an answer if no edge comes; INT64_MAX where the line stands still. */
int64_t placido_gpio_debounce_due_ns(const placido_gpio_debounce *debounce);

#endif
