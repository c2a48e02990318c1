/* The lines of a GPIO chip as the driver sees them: libgpiod 1.6 or 2.x below, or a script's in
 * tests. */
#ifndef PLACIDO_DRIVERS_GPIO_LINES_H
#define PLACIDO_DRIVERS_GPIO_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PLACIDO_GPIO_NAME_MAX 64
/* As many edges are read at once at most; a queue of libgpiod 1.6 holds no more. */
#define PLACIDO_GPIO_EDGES_MAX 16

typedef struct placido_gpio_chip_info {
  char name[PLACIDO_GPIO_NAME_MAX]; /* the kernel's: gpiochip0 */
  char label[PLACIDO_GPIO_NAME_MAX];
  unsigned line_count;
} placido_gpio_chip_info;

typedef struct placido_gpio_line_info {
  char name[PLACIDO_GPIO_NAME_MAX];     /* empty: none */
  char consumer[PLACIDO_GPIO_NAME_MAX]; /* who uses it; empty: nobody, or unknown */
  bool is_used;
} placido_gpio_line_info;

enum placido_gpio_use {
  PLACIDO_GPIO_OUTPUT, /* requested dark: level 0 */
  PLACIDO_GPIO_RISING, /* an input whose edges to level 1 are queued */
  PLACIDO_GPIO_BOTH,   /* an input all of whose edges are queued */
};

enum placido_gpio_bias {
  PLACIDO_GPIO_BIAS_AS_IS,
  PLACIDO_GPIO_BIAS_NONE,
  PLACIDO_GPIO_BIAS_UP,
  PLACIDO_GPIO_BIAS_DOWN,
};

typedef struct placido_gpio_request {
  unsigned offset;
  enum placido_gpio_use use;
  enum placido_gpio_bias bias; /* of an input */
  bool is_active_low;          /* levels below are logical: 1 is active, whatever the voltage */
} placido_gpio_request;

typedef struct placido_gpio_edge {
  int64_t t_ns;  /* CLOCK_MONOTONIC, as the kernel stamped it */
  int level;     /* of the line behind it */
  uint64_t lost; /* edges before it that the kernel's queue had no room for */
} placido_gpio_edge;

/* Each but list and clock_ns returns 0 or a positive errno, outputs zeroed where it fails. Chips
 * and lines are what open and request made. */
typedef struct placido_gpio_lines {
  /* Calls `each` for the node of every chip in the order of their numbers; stops with its value
   * where that is not 0, and returns it. */
  int (*list)(int (*each)(void *user, const char *path), void *user);
  int (*open)(void **chip, const char *path);
  void (*close)(void *chip); /* after the release of its lines */
  int (*chip_info)(void *chip, placido_gpio_chip_info *info);
  /* Asks the kernel each time: ENODEV where the chip is gone. */
  int (*line_info)(void *chip, unsigned offset, placido_gpio_line_info *info);
  int (*request)(void **line, void *chip, const placido_gpio_request *request);
  void (*release)(void *line);
  int (*set)(void *line, int level);
  int (*get)(void *line, int *level);
  /* Waits until an edge can be read from one of the lines, at most timeout_ms. */
  int (*wait)(void *const *lines, size_t count, int timeout_ms);
  /* Takes queued edges, at most PLACIDO_GPIO_EDGES_MAX, without waiting: `*count` may be 0. */
  int (*read)(void *line, placido_gpio_edge *edges, size_t *count);
  int64_t (*clock_ns)(void); /* CLOCK_MONOTONIC */
} placido_gpio_lines;

/* Of the libgpiod that this build has. */
extern const placido_gpio_lines placido_gpio_kernel;

/* What both versions of libgpiod leave to the system (lines.c). Waiting returns ENODEV where the
 * kernel gave up one of the descriptors; at most 8 of them. */
int placido_gpio_list_nodes(int (*each)(void *user, const char *path), void *user);
int placido_gpio_wait(const int *descriptors, size_t count, int timeout_ms);
int placido_gpio_make_nonblocking(int descriptor);
/* The errno of a call that failed; never 0. */
int placido_gpio_errno(void);

#endif
