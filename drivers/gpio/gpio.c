/* The lights, the pedal and the trigger of an instrument as a driver: switched, listened to, and
 * found again by the next start where the chip was unplugged. */
#include "drivers/gpio/gpio.h"

#include "base/memory.h"
#include "drivers/gpio/board.h"
#include "drivers/gpio/inputs.h"
#include "drivers/settings.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define NS_PER_MS 1e6
#define CONTROLS_MAX 7

typedef struct gpio {
  placido_device_info info;
  char address[1024]; /* without the query */
  placido_gpio_board board;
  placido_gpio_inputs inputs;
  placido_control controls[CONTROLS_MAX];
  const struct row *rows[CONTROLS_MAX]; /* what stands behind each */
  size_t control_count;
} gpio;

/* A control, which is there where its role is wired. */
struct row {
  placido_control control;
  enum placido_gpio_role role;
  double (*get)(const gpio *state, enum placido_gpio_role role);
  int (*set)(gpio *state, enum placido_gpio_role role, double value,
             placido_error *err); /* NULL: read only */
};

static double get_output(const gpio *state, enum placido_gpio_role role) {
  return state->board.levels[role];
}

static int set_output(gpio *state, enum placido_gpio_role role, double value, placido_error *err) {
  return placido_gpio_board_set(&state->board, role, value >= 0.5, err);
}

static double get_triggers(const gpio *state, enum placido_gpio_role role) {
  (void)role;
  return (double)state->inputs.trigger_count;
}

static double get_pedal(const gpio *state, enum placido_gpio_role role) {
  (void)role;
  return state->inputs.debounce.level;
}

static double get_bounces(const gpio *state, enum placido_gpio_role role) {
  (void)role;
  return (double)state->inputs.debounce.bounce_count;
}

static double get_debounce(const gpio *state, enum placido_gpio_role role) {
  (void)role;
  return (double)state->inputs.debounce.hold_ns / NS_PER_MS;
}

static int set_debounce(gpio *state, enum placido_gpio_role role, double value,
                        placido_error *err) {
  (void)role;
  (void)err;
  state->inputs.debounce.hold_ns = llround(value * NS_PER_MS);
  return PLACIDO_OK;
}

#define COUNT_MAX 9007199254740992.0 /* up to where doubles count by one */

static const struct row rows[CONTROLS_MAX] = {
    {{"light", "", "the ring light: 1 shines, 0 is dark", 0, 1, 1}, PLACIDO_GPIO_LIGHT,
     get_output, set_output},
    {{"fixation", "", "the fixation light: 1 shines, 0 is dark", 0, 1, 1}, PLACIDO_GPIO_FIXATION,
     get_output, set_output},
    {{"strobe", "", "the signal to other devices: 1 active, 0 not", 0, 1, 1}, PLACIDO_GPIO_STROBE,
     get_output, set_output},
    {{"trigger_count", "", "edges of the trigger since open (read only)", 0, COUNT_MAX, 1},
     PLACIDO_GPIO_TRIGGER, get_triggers, NULL},
    {{"pedal", "", "1 pressed, 0 not, as of the last event (read only)", 0, 1, 1},
     PLACIDO_GPIO_PEDAL, get_pedal, NULL},
    {{"debounce_ms", "ms", "so long must the pedal stand still before a change counts", 0,
      PLACIDO_GPIO_DEBOUNCE_MAX_MS, 0}, PLACIDO_GPIO_PEDAL, get_debounce, set_debounce},
    {{"bounce_count", "", "edges of the pedal that were none of a change (read only)", 0,
      COUNT_MAX, 1}, PLACIDO_GPIO_PEDAL, get_bounces, NULL},
};

static void list_controls(gpio *state) {
  for (size_t i = 0; i < CONTROLS_MAX; i++) {
    if (state->board.wiring.wires[rows[i].role].line[0]) {
      state->rows[state->control_count] = &rows[i];
      state->controls[state->control_count++] = rows[i].control;
    }
  }
}

static int request_lines(gpio *state, placido_error *err) {
  const int status = placido_gpio_board_request(&state->board, err);
  state->inputs.trigger = state->board.lines[PLACIDO_GPIO_TRIGGER];
  state->inputs.pedal = state->board.lines[PLACIDO_GPIO_PEDAL];
  return status;
}

static void describe(gpio *state) {
  placido_device_info *info = &state->info;
  snprintf(info->uri, sizeof info->uri, "gpio:%.1000s", state->address);
  snprintf(info->model, sizeof info->model, "%s", state->board.chip.info.label);
  info->axis_z_mm = info->axis_z_sigma_mm = NAN;
  info->endless = true;
}

static void gpio_close(void *pointer) {
  gpio *state = pointer;
  placido_gpio_board_darken(&state->board, NULL);
  placido_gpio_board_let_go(&state->board);
  placido_memory_free(state);
}

int placido_gpio_open(void **pointer, const char *address, const placido_gpio_lines *lines,
                      placido_notes *notes, placido_error *err) {
  *pointer = NULL;
  gpio *state = placido_memory_new(1, sizeof *state, err);
  if (!state) {
    return PLACIDO_MEMORY;
  }
  state->board.chip.lines = state->inputs.lines = lines;
  const char *query;
  int status = placido_settings_split(state->address, sizeof state->address, &query, address,
                                      "GPIO chip", err);
  if (!status) {
    status = placido_gpio_wiring_read(&state->board.wiring, query, err);
  }
  if (!status) {
    status = placido_gpio_chip_open(&state->board.chip, state->address, lines, err);
  }
  if (!status) {
    status = request_lines(state, err);
  }
  if (status) {
    gpio_close(state);
    return status;
  }
  state->inputs.debounce.hold_ns = llround(state->board.wiring.debounce_ms * NS_PER_MS);
  list_controls(state);
  describe(state);
  if (state->control_count == 0) {
    placido_notes_add(notes, "%s names no line: gpio:%.100s?light=5&pedal=7 would",
                      state->info.uri, state->address);
  }
  *pointer = state;
  return PLACIDO_OK;
}

static int open_real(void **state, const char *address, placido_notes *notes,
                     placido_error *err) {
  return placido_gpio_open(state, address, &placido_gpio_kernel, notes, err);
}

static const placido_device_info *gpio_info(const void *pointer) {
  const gpio *state = pointer;
  return &state->info;
}

static const placido_control *gpio_controls(const void *pointer, size_t *count) {
  const gpio *state = pointer;
  *count = state->control_count;
  return state->controls;
}

static int gpio_get(void *pointer, size_t control, double *value, placido_error *err) {
  (void)err;
  const gpio *state = pointer;
  *value = state->rows[control]->get(state, state->rows[control]->role);
  return PLACIDO_OK;
}

static int gpio_set(void *pointer, size_t control, double value, placido_error *err) {
  gpio *state = pointer;
  const struct row *row = state->rows[control];
  return row->set ? row->set(state, row->role, value, err)
                  : placido_error_set(err, PLACIDO_UNSUPPORTED, "the control %s is read only",
                                      row->control.name);
}

/* Finds a lost chip again; its lines come back dark. */
static int find_again(gpio *state, placido_error *err) {
  placido_gpio_chip chip;
  placido_error why = {0};
  if (placido_gpio_chip_open(&chip, state->address, state->board.chip.lines, &why)) {
    return placido_error_set(err, PLACIDO_GONE, "the GPIO chip of %.200s is gone: %.200s",
                             state->info.uri, why.text);
  }
  if (strcmp(chip.info.label, state->info.model) != 0) {
    const int status = placido_error_set(err, PLACIDO_SYSTEM,
                                         "%.200s is the GPIO chip %s now, not %s: open it anew",
                                         state->info.uri, chip.info.label, state->info.model);
    placido_gpio_chip_close(&chip);
    return status;
  }
  state->board.chip = chip;
  const int status = request_lines(state, err);
  if (status) {
    placido_gpio_board_let_go(&state->board);
  }
  return status;
}

static int gpio_start(void *pointer, placido_error *err) {
  gpio *state = pointer;
  int status = state->board.chip.chip ? PLACIDO_OK : find_again(state, err);
  if (!status) {
    const int code = placido_gpio_inputs_start(&state->inputs);
    if (code) {
      status = placido_gpio_board_failed(&state->board, "starting the inputs", code, err);
    }
  }
  return status;
}

static int gpio_event(void *pointer, placido_event *event, int timeout_ms, placido_error *err) {
  gpio *state = pointer;
  if (!state->board.chip.chip) {
    return placido_gpio_board_failed(&state->board, "waiting for events", ENODEV, err);
  }
  if (!state->inputs.trigger && !state->inputs.pedal) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "%.200s has no inputs: name one, such as pedal=7", state->info.uri);
  }
  const int code = placido_gpio_inputs_next(&state->inputs, event, timeout_ms);
  if (code == ETIMEDOUT) {
    return placido_error_set(err, PLACIDO_TIMEOUT, "no event within %d ms", timeout_ms);
  }
  if (code == EOVERFLOW) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "the kernel stamps the edges of %s (%s) with another clock than "
                             "CLOCK_MONOTONIC: Linux 5.7 is the oldest that can be used",
                             state->board.chip.info.name, state->board.chip.info.label);
  }
  return code ? placido_gpio_board_failed(&state->board, "waiting for events", code, err)
              : PLACIDO_OK;
}

static int gpio_stop(void *pointer, placido_error *err) {
  gpio *state = pointer;
  return placido_gpio_board_darken(&state->board, err);
}

static void gpio_statistics(const void *pointer, placido_device_statistics *statistics) {
  const gpio *state = pointer;
  statistics->dropped = state->inputs.lost_count;
}

/* Who wants to hear of chips. */
struct listener {
  const placido_gpio_lines *lines;
  int (*found)(void *user, const char *uri, const char *description);
  void *user;
};

static int tell(void *user, const char *path) {
  const struct listener *listener = user;
  placido_gpio_chip chip;
  placido_error why = {0};
  char uri[100], description[300];
  snprintf(uri, sizeof uri, "gpio:%s", path);
  if (placido_gpio_chip_open(&chip, path, listener->lines, &why)) {
    snprintf(description, sizeof description, "%.250s", why.text);
  } else {
    snprintf(description, sizeof description, "GPIO chip %s, %u lines", chip.info.label,
             chip.info.line_count);
  }
  placido_gpio_chip_close(&chip);
  return listener->found(listener->user, uri, description);
}

int placido_gpio_scan(const placido_gpio_lines *lines,
                      int (*found)(void *user, const char *uri, const char *description),
                      void *user, placido_error *err) {
  (void)err;
  struct listener listener = {.lines = lines, .found = found, .user = user};
  return lines->list(tell, &listener);
}

static int scan_real(int (*found)(void *user, const char *uri, const char *description),
                     void *user, placido_error *err) {
  return placido_gpio_scan(&placido_gpio_kernel, found, user, err);
}

static const placido_match matches[] = {
    {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = "gpio-%k", .group = "gpio"},
    {.subsystem = NULL},
};

const placido_driver placido_gpio_driver = {
    .scheme = "gpio",
    .summary = "lights, pedal and trigger on the lines of a GPIO chip",
    .options = placido_gpio_options,
    .scan = scan_real,
    .open = open_real,
    .close = gpio_close,
    .info = gpio_info,
    .controls = gpio_controls,
    .get = gpio_get,
    .set = gpio_set,
    .matches = matches,
    .start = gpio_start,
    .event = gpio_event,
    .stop = gpio_stop,
    .statistics = gpio_statistics,
};
