/* GPIO chips played from a script, in the place of libgpiod. */
#include "tests/drivers/gpio_fake.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define START_NS 5000000000

struct gpio_fake gpio_fake;

void gpio_fake_reset(void) {
  memset(&gpio_fake, 0, sizeof gpio_fake);
  gpio_fake.path = "/dev/gpiochip0";
  gpio_fake.label = "fake";
  gpio_fake.clock_ns = START_NS;
  gpio_fake.unplug_ns = INT64_MAX;
}

void gpio_fake_pull(double ms, unsigned line, int voltage) {
  if (gpio_fake.pull_count < FAKE_PULLS) {
    gpio_fake.pulls[gpio_fake.pull_count++] =
        (struct fake_pull){START_NS + (int64_t)(ms * FAKE_MS), line, voltage};
  }
}

void gpio_fake_unplug(void) {
  gpio_fake.is_gone = true;
}

/* The lines come back as a chip without a program leaves them. */
void gpio_fake_replug(void) {
  gpio_fake.is_gone = false;
  gpio_fake.unplug_ns = INT64_MAX;
}

/* Counts a call; errno where it is to fail. */
static int failure(void) {
  gpio_fake.call_count++;
  const bool fails = gpio_fake.fail_at > 0 &&
                     (gpio_fake.call_count == gpio_fake.fail_at ||
                      (gpio_fake.fails_for_ever && gpio_fake.call_count > gpio_fake.fail_at));
  return fails ? gpio_fake.fail_code : gpio_fake.is_gone ? ENODEV : 0;
}

static int level_of(const struct fake_line *line) {
  return line->voltage != line->as.is_active_low;
}

/* The voltage of an input changes: an edge, where there is room for it. */
static void play(const struct fake_pull *pull) {
  struct fake_line *line = &gpio_fake.lines[pull->line];
  const bool is_edge = line->voltage != pull->voltage;
  line->voltage = pull->voltage;
  const int level = level_of(line);
  if (!is_edge || !line->is_requested || line->as.use == PLACIDO_GPIO_OUTPUT ||
      (line->as.use == PLACIDO_GPIO_RISING && !level)) {
    return;
  }
  if (line->queue_length == FAKE_QUEUE) {
    line->lost++;
    return;
  }
  line->queue[line->queue_length++] = (placido_gpio_edge){
      .t_ns = pull->t_ns + gpio_fake.clock_offset_ns, .level = level, .lost = line->lost};
  line->lost = 0;
}

/* Lets time pass, up to a time or to the first edge that can be read. */
static void pass(int64_t until_ns, bool stops_at_edge) {
  size_t queued = 0;
  while (gpio_fake.pull_next < gpio_fake.pull_count && queued == 0 &&
         gpio_fake.pulls[gpio_fake.pull_next].t_ns <= until_ns) {
    const struct fake_pull *pull = &gpio_fake.pulls[gpio_fake.pull_next++];
    gpio_fake.clock_ns = pull->t_ns > gpio_fake.clock_ns ? pull->t_ns : gpio_fake.clock_ns;
    play(pull);
    queued = stops_at_edge ? gpio_fake.lines[pull->line].queue_length : 0;
  }
  if (queued == 0 && until_ns > gpio_fake.clock_ns) {
    gpio_fake.clock_ns = until_ns;
  }
  gpio_fake.is_gone = gpio_fake.is_gone || gpio_fake.clock_ns >= gpio_fake.unplug_ns;
}

static int fake_list(int (*each)(void *user, const char *path), void *user) {
  int status = gpio_fake.is_gone ? 0 : each(user, gpio_fake.path);
  if (!status && gpio_fake.other_path) {
    status = each(user, gpio_fake.other_path);
  }
  return status;
}

static int fake_open(void **chip, const char *path) {
  *chip = NULL;
  const bool is_other = gpio_fake.other_path && strcmp(path, gpio_fake.other_path) == 0;
  const int code = failure();
  if (code || gpio_fake.open_code) {
    return code ? code : gpio_fake.open_code;
  }
  if (!is_other && strcmp(path, gpio_fake.path) != 0) {
    return ENOENT;
  }
  gpio_fake.open_count++;
  *chip = is_other ? &gpio_fake.other_label : &gpio_fake.label;
  return 0;
}

static void fake_close(void *chip) {
  (void)chip;
  gpio_fake.open_count--;
}

static int fake_chip_info(void *chip, placido_gpio_chip_info *info) {
  *info = (placido_gpio_chip_info){0};
  const int code = failure();
  if (!code) {
    const char *const *label = chip;
    const bool is_other = label == &gpio_fake.other_label;
    info->line_count = FAKE_LINES;
    snprintf(info->label, sizeof info->label, "%s", *label);
    snprintf(info->name, sizeof info->name, "%s",
             (is_other ? gpio_fake.other_path : gpio_fake.path) + strlen("/dev/"));
  }
  return code;
}

static int fake_line_info(void *chip, unsigned offset, placido_gpio_line_info *info) {
  (void)chip;
  *info = (placido_gpio_line_info){0};
  const int code = failure();
  if (!code && offset < FAKE_LINES) {
    const struct fake_line *line = &gpio_fake.lines[offset];
    snprintf(info->name, sizeof info->name, "%s", line->name ? line->name : "");
    snprintf(info->consumer, sizeof info->consumer, "%s", line->consumer ? line->consumer : "");
    info->is_used = line->consumer || line->is_requested;
  }
  return code ? code : offset < FAKE_LINES ? 0 : EINVAL;
}

static int fake_request(void **requested, void *chip, const placido_gpio_request *request) {
  (void)chip;
  *requested = NULL;
  const int code = failure();
  if (code || request->offset >= FAKE_LINES) {
    return code ? code : EINVAL;
  }
  struct fake_line *line = &gpio_fake.lines[request->offset];
  if (line->consumer || line->is_requested) {
    return EBUSY;
  }
  if (line->has_no_interrupt && request->use != PLACIDO_GPIO_OUTPUT) {
    return ENODEV;
  }
  line->is_requested = true;
  line->as = *request;
  line->queue_length = 0;
  if (request->use == PLACIDO_GPIO_OUTPUT) {
    line->voltage = request->is_active_low;
  }
  gpio_fake.requested_count++;
  *requested = line;
  return 0;
}

static void fake_release(void *pointer) {
  struct fake_line *line = pointer;
  line->is_requested = false;
  gpio_fake.requested_count--;
}

static int fake_set(void *pointer, int level) {
  struct fake_line *line = pointer;
  const int code = failure();
  if (!code) {
    line->voltage = level != line->as.is_active_low;
  }
  return code;
}

static int fake_get(void *pointer, int *level) {
  *level = 0;
  const int code = failure();
  if (!code) {
    *level = level_of(pointer);
  }
  return code;
}

static int fake_wait(void *const *lines, size_t count, int timeout_ms) {
  const int code = failure();
  for (size_t i = 0; i < count; i++) {
    const struct fake_line *line = lines[i];
    if (line->queue_length > 0) {
      return code;
    }
  }
  /* Time goes on, whatever fails. A wait that has begun does not notice the unplugging. */
  pass(gpio_fake.clock_ns + (int64_t)timeout_ms * FAKE_MS, !code);
  return code;
}

static int fake_read(void *pointer, placido_gpio_edge *edges, size_t *count) {
  struct fake_line *line = pointer;
  *count = 0;
  pass(gpio_fake.clock_ns, false);
  const int code = failure();
  if (!code) {
    *count = line->queue_length < PLACIDO_GPIO_EDGES_MAX ? line->queue_length
                                                         : PLACIDO_GPIO_EDGES_MAX;
    line->queue_length -= *count;
    memcpy(edges, line->queue, *count * sizeof *edges);
    memmove(line->queue, line->queue + *count, line->queue_length * sizeof *line->queue);
  }
  return code;
}

static int64_t fake_clock(void) {
  return gpio_fake.clock_ns;
}

const placido_gpio_lines gpio_fake_lines = {
    .list = fake_list,
    .open = fake_open,
    .close = fake_close,
    .chip_info = fake_chip_info,
    .line_info = fake_line_info,
    .request = fake_request,
    .release = fake_release,
    .set = fake_set,
    .get = fake_get,
    .wait = fake_wait,
    .read = fake_read,
    .clock_ns = fake_clock,
};
