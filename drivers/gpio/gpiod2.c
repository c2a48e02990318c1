/* Lines through libgpiod 2.x, the second interface of the kernel for GPIO.
 *
 * Edges have numbers, so the lost ones are counted. The kernel's own debouncing is not used: it
 * stamps a change when the line has settled, and we tell when it began. */
#include "drivers/gpio/lines.h"

#include "base/clock.h"
#include "base/memory.h"

#include <errno.h>
#include <gpiod.h>
#include <stdio.h>

/* A second of a trigger at 250 Hz. */
#define QUEUE_EDGES 256

typedef struct line {
  struct gpiod_line_request *request;
  struct gpiod_edge_event_buffer *buffer; /* NULL: an output */
  unsigned offset;
  unsigned long edge_number; /* of the last one read */
} line;

static int open_chip(void **chip, const char *path) {
  *chip = gpiod_chip_open(path);
  return *chip ? 0 : placido_gpio_errno();
}

static void close_chip(void *chip) {
  gpiod_chip_close(chip);
}

static int chip_info(void *chip, placido_gpio_chip_info *info) {
  *info = (placido_gpio_chip_info){0};
  struct gpiod_chip_info *said = gpiod_chip_get_info(chip);
  if (!said) {
    return placido_gpio_errno();
  }
  info->line_count = (unsigned)gpiod_chip_info_get_num_lines(said);
  snprintf(info->name, sizeof info->name, "%s", gpiod_chip_info_get_name(said));
  snprintf(info->label, sizeof info->label, "%s", gpiod_chip_info_get_label(said));
  gpiod_chip_info_free(said);
  return 0;
}

static int line_info(void *chip, unsigned offset, placido_gpio_line_info *info) {
  *info = (placido_gpio_line_info){0};
  struct gpiod_line_info *said = gpiod_chip_get_line_info(chip, offset);
  if (!said) {
    return placido_gpio_errno();
  }
  const char *name = gpiod_line_info_get_name(said);
  const char *consumer = gpiod_line_info_get_consumer(said);
  snprintf(info->name, sizeof info->name, "%s", name ? name : "");
  snprintf(info->consumer, sizeof info->consumer, "%s", consumer ? consumer : "");
  info->is_used = gpiod_line_info_is_used(said);
  gpiod_line_info_free(said);
  return 0;
}

/* Settings of a line; NULL and errno where there is no memory. */
static struct gpiod_line_settings *settings_of(const placido_gpio_request *request) {
  static const enum gpiod_line_bias bias[] = {
      [PLACIDO_GPIO_BIAS_AS_IS] = GPIOD_LINE_BIAS_AS_IS,
      [PLACIDO_GPIO_BIAS_NONE] = GPIOD_LINE_BIAS_DISABLED,
      [PLACIDO_GPIO_BIAS_UP] = GPIOD_LINE_BIAS_PULL_UP,
      [PLACIDO_GPIO_BIAS_DOWN] = GPIOD_LINE_BIAS_PULL_DOWN,
  };
  struct gpiod_line_settings *settings = gpiod_line_settings_new();
  if (!settings) {
    return NULL;
  }
  /* Setting a value of the enumeration cannot fail. */
  gpiod_line_settings_set_active_low(settings, request->is_active_low);
  if (request->use == PLACIDO_GPIO_OUTPUT) {
    gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_OUTPUT);
    gpiod_line_settings_set_output_value(settings, GPIOD_LINE_VALUE_INACTIVE);
  } else {
    gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT);
    gpiod_line_settings_set_bias(settings, bias[request->bias]);
    gpiod_line_settings_set_event_clock(settings, GPIOD_LINE_CLOCK_MONOTONIC);
    gpiod_line_settings_set_edge_detection(settings, request->use == PLACIDO_GPIO_RISING
                                                         ? GPIOD_LINE_EDGE_RISING
                                                         : GPIOD_LINE_EDGE_BOTH);
  }
  return settings;
}

/* What the kernel is asked of the line; NULL and errno where there is no memory. */
static struct gpiod_line_config *config_of(const placido_gpio_request *request) {
  struct gpiod_line_settings *settings = settings_of(request);
  struct gpiod_line_config *config = settings ? gpiod_line_config_new() : NULL;
  const bool is_whole =
      config && !gpiod_line_config_add_line_settings(config, &request->offset, 1, settings);
  if (settings) {
    gpiod_line_settings_free(settings);
  }
  if (config && !is_whole) {
    gpiod_line_config_free(config);
  }
  return is_whole ? config : NULL;
}

static void release_line(void *pointer) {
  line *held = pointer;
  if (held->request) {
    gpiod_line_request_release(held->request);
  }
  if (held->buffer) {
    gpiod_edge_event_buffer_free(held->buffer);
  }
  placido_memory_free(held);
}

/* Requests the line and what its edges are read with. Returns 0 or errno. */
static int fill_line(line *held, struct gpiod_chip *chip, const placido_gpio_request *request) {
  struct gpiod_line_config *config = config_of(request);
  struct gpiod_request_config *how = config ? gpiod_request_config_new() : NULL;
  if (!how) {
    if (config) {
      gpiod_line_config_free(config);
    }
    return ENOMEM;
  }
  gpiod_request_config_set_consumer(how, "placido");
  gpiod_request_config_set_event_buffer_size(how, QUEUE_EDGES);
  held->offset = request->offset;
  held->request = gpiod_chip_request_lines(chip, how, config);
  int code = held->request ? 0 : placido_gpio_errno();
  gpiod_request_config_free(how);
  gpiod_line_config_free(config);
  if (!code && request->use != PLACIDO_GPIO_OUTPUT) {
    held->buffer = gpiod_edge_event_buffer_new(PLACIDO_GPIO_EDGES_MAX);
    code = held->buffer ? placido_gpio_make_nonblocking(gpiod_line_request_get_fd(held->request))
                        : ENOMEM;
  }
  return code;
}

static int request_line(void **requested, void *chip, const placido_gpio_request *request) {
  *requested = NULL;
  line *held = placido_memory_new(1, sizeof *held, NULL);
  const int code = held ? fill_line(held, chip, request) : ENOMEM;
  if (code && held) {
    release_line(held);
  }
  *requested = code ? NULL : held;
  return code;
}

static int set_level(void *pointer, int level) {
  const line *held = pointer;
  const enum gpiod_line_value value = level ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  return gpiod_line_request_set_value(held->request, held->offset, value) < 0 ? placido_gpio_errno()
                                                                              : 0;
}

static int get_level(void *pointer, int *level) {
  const line *held = pointer;
  const enum gpiod_line_value value = gpiod_line_request_get_value(held->request, held->offset);
  *level = value == GPIOD_LINE_VALUE_ACTIVE;
  return value == GPIOD_LINE_VALUE_ERROR ? placido_gpio_errno() : 0;
}

static int wait_edge(void *const *lines, size_t count, int timeout_ms) {
  int descriptors[8];
  for (size_t i = 0; i < count && i < sizeof descriptors / sizeof *descriptors; i++) {
    const line *held = lines[i];
    descriptors[i] = gpiod_line_request_get_fd(held->request);
  }
  return placido_gpio_wait(descriptors, count, timeout_ms);
}

static int read_edges(void *pointer, placido_gpio_edge *edges, size_t *count) {
  line *held = pointer;
  *count = 0;
  const int taken =
      gpiod_line_request_read_edge_events(held->request, held->buffer, PLACIDO_GPIO_EDGES_MAX);
  if (taken < 0) {
    return errno == EAGAIN || errno == EINTR ? 0 : placido_gpio_errno();
  }
  for (int i = 0; i < taken; i++) {
    struct gpiod_edge_event *event =
        gpiod_edge_event_buffer_get_event(held->buffer, (unsigned long)i);
    const unsigned long number = gpiod_edge_event_get_line_seqno(event);
    edges[i] = (placido_gpio_edge){
        .t_ns = (int64_t)gpiod_edge_event_get_timestamp_ns(event),
        .level = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE,
        .lost = number > held->edge_number ? number - held->edge_number - 1 : 0};
    held->edge_number = number;
  }
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
