/* GPIO chips played from a script, in the place of libgpiod. */
#ifndef PLACIDO_TESTS_DRIVERS_GPIO_FAKE_H
#define PLACIDO_TESTS_DRIVERS_GPIO_FAKE_H

#include "drivers/gpio/lines.h"

#define FAKE_LINES 10
#define FAKE_QUEUE 24 /* edges of a line: more than one read takes */
#define FAKE_PULLS 200
#define FAKE_MS 1000000 /* in ns */

struct fake_line {
  const char *name, *consumer; /* who else uses it; NULL: nobody */
  int voltage;                 /* 1: high */
  bool has_no_interrupt;

  /* how it is requested */
  bool is_requested;
  placido_gpio_request as;
  placido_gpio_edge queue[FAKE_QUEUE];
  size_t queue_length;
  uint64_t lost; /* of a full queue, not told yet */
};

/* A voltage that comes from outside at a time. */
struct fake_pull {
  int64_t t_ns;
  unsigned line;
  int voltage;
};

/* The one chip that has lines: set up by the test, changed by the driver's calls. */
struct gpio_fake {
  const char *path, *label;
  const char *other_path, *other_label; /* a second chip; NULL: none */
  struct fake_line lines[FAKE_LINES];
  bool is_gone;
  int open_code; /* errno of every open; 0: none */
  struct fake_pull pulls[FAKE_PULLS]; /* in the order of time */
  size_t pull_count, pull_next;
  int64_t unplug_ns;       /* INT64_MAX: never */
  int64_t clock_offset_ns; /* of the edges' stamps to the clock */
  int64_t clock_ns;

  /* what is held */
  int open_count, requested_count;

  /* which call fails: the fail_at-th from now (1 = the next), and those behind it too */
  int fail_at, fail_code, call_count;
  bool fails_for_ever;
};

extern struct gpio_fake gpio_fake;
extern const placido_gpio_lines gpio_fake_lines;

/* The chip "fake" at /dev/gpiochip0, all lines low, the clock at 5 s, nothing planned. */
void gpio_fake_reset(void);
/* Plans a voltage `ms` after 5 s on the clock. */
void gpio_fake_pull(double ms, unsigned line, int voltage);
void gpio_fake_unplug(void);
void gpio_fake_replug(void);

#endif
