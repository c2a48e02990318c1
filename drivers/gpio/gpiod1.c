/* Lines through libgpiod 1.6, the first interface of the kernel for GPIO.
 *
 * Its queue holds 16 edges a line and drops the newest without a count: a queue that is found full
 * counts as one edge lost. Edges are stamped by CLOCK_MONOTONIC since Linux 5.7. */
#include "drivers/gpio/lines.h"

#include "base/clock.h"
#include "base/memory.h"

#include <errno.h>
#include <gpiod.h>
#include <stdio.h>

typedef struct line {
  struct gpiod_line *line; /* the chip's */
  int descriptor;          /* of its edges; -1: an output */
  bool was_full;
} line;

static int open_chip(void **chip, const char *path) {
  *chip = gpiod_chip_open(path);
  return *chip ? 0 : placido_gpio_errno();
}

static void close_chip(void *chip) {
  gpiod_chip_close(chip);
}

static int chip_info(void *chip, placido_gpio_chip_info *info) {
  *info = (placido_gpio_chip_info){.line_count = gpiod_chip_num_lines(chip)};
  snprintf(info->name, sizeof info->name, "%s", gpiod_chip_name(chip));
  snprintf(info->label, sizeof info->label, "%s", gpiod_chip_label(chip));
  return 0;
}

static int line_info(void *chip, unsigned offset, placido_gpio_line_info *info) {
  *info = (placido_gpio_line_info){0};
  struct gpiod_line *of = gpiod_chip_get_line(chip, offset);
  if (!of || gpiod_line_update(of) < 0) {
    return placido_gpio_errno();
  }
  const char *name = gpiod_line_name(of), *consumer = gpiod_line_consumer(of);
  snprintf(info->name, sizeof info->name, "%s", name ? name : "");
  snprintf(info->consumer, sizeof info->consumer, "%s", consumer ? consumer : "");
  info->is_used = gpiod_line_is_used(of);
  return 0;
}

static int flags_of(const placido_gpio_request *request) {
  static const int bias[] = {
      [PLACIDO_GPIO_BIAS_NONE] = GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE,
      [PLACIDO_GPIO_BIAS_UP] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP,
      [PLACIDO_GPIO_BIAS_DOWN] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN,
  };
  return (request->use == PLACIDO_GPIO_OUTPUT ? 0 : bias[request->bias]) |
         (request->is_active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0);
}

static void release_line(void *pointer) {
  line *held = pointer;
  gpiod_line_release(held->line);
  placido_memory_free(held);
}

static int request_line(void **requested, void *chip, const placido_gpio_request *request) {
  static const int types[] = {
      [PLACIDO_GPIO_OUTPUT] = GPIOD_LINE_REQUEST_DIRECTION_OUTPUT,
      [PLACIDO_GPIO_RISING] = GPIOD_LINE_REQUEST_EVENT_RISING_EDGE,
      [PLACIDO_GPIO_BOTH] = GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES,
  };
  *requested = NULL;
  const struct gpiod_line_request_config config = {
      .consumer = "placido", .request_type = types[request->use], .flags = flags_of(request)};
  line *held = placido_memory_new(1, sizeof *held, NULL);
  if (!held) {
    return ENOMEM;
  }
  held->line = gpiod_chip_get_line(chip, request->offset);
  if (!held->line || gpiod_line_request(held->line, &config, 0) < 0) {
    const int code = placido_gpio_errno();
    placido_memory_free(held);
    return code;
  }
  held->descriptor = request->use == PLACIDO_GPIO_OUTPUT ? -1 : gpiod_line_event_get_fd(held->line);
  const int code =
      request->use == PLACIDO_GPIO_OUTPUT ? 0 : placido_gpio_make_nonblocking(held->descriptor);
  if (code) {
    release_line(held);
    return code;
  }
  *requested = held;
  return 0;
}

static int set_level(void *pointer, int level) {
  const line *held = pointer;
  return gpiod_line_set_value(held->line, level) < 0 ? placido_gpio_errno() : 0;
}

static int get_level(void *pointer, int *level) {
  const line *held = pointer;
  const int value = gpiod_line_get_value(held->line);
  *level = value > 0;
  return value < 0 ? placido_gpio_errno() : 0;
}

static int wait_edge(void *const *lines, size_t count, int timeout_ms) {
  int descriptors[8];
  for (size_t i = 0; i < count && i < sizeof descriptors / sizeof *descriptors; i++) {
    const line *held = lines[i];
    descriptors[i] = held->descriptor;
  }
  return placido_gpio_wait(descriptors, count, timeout_ms);
}

static int read_edges(void *pointer, placido_gpio_edge *edges, size_t *count) {
  line *held = pointer;
  struct gpiod_line_event events[PLACIDO_GPIO_EDGES_MAX];
  *count = 0;
  const int taken =
      gpiod_line_event_read_fd_multiple(held->descriptor, events, PLACIDO_GPIO_EDGES_MAX);
  if (taken < 0) {
    return errno == EAGAIN || errno == EINTR ? 0 : placido_gpio_errno();
  }
  for (int i = 0; i < taken; i++) {
    edges[i] = (placido_gpio_edge){.t_ns = (int64_t)events[i].ts.tv_sec * 1000000000 +
                                           events[i].ts.tv_nsec,
                                   .level = events[i].event_type == GPIOD_LINE_EVENT_RISING_EDGE,
                                   .lost = i == 0 && held->was_full};
  }
  held->was_full = taken == PLACIDO_GPIO_EDGES_MAX || (taken == 0 && held->was_full);
  *count = (size_t)taken;
  return 0;
}

const placido_gpio_lines placido_gpio_kernel = {
    .list = placido_gpio_list_nodes,
    .open = open_chip,
    .close = close_chip,
    .chip_info = chip_info,
    .line_info = line_info,
    .request = request_line,
    .release = release_line,
    .set = set_level,
    .get = get_level,
    .wait = wait_edge,
    .read = read_edges,
    .clock_ns = placido_clock_now_ns,
};
