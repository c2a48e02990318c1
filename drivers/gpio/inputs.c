/* From edges to events: the trigger counted edge by edge, the pedal debounced. */
#include "drivers/gpio/inputs.h"

#include <errno.h>

#define NS_PER_MS 1000000
/* A wait that has begun does not notice on every kernel that the chip is unplugged; a read does. */
#define SLICE_NS (100 * (int64_t)NS_PER_MS)
/* More than any queue holds: what is older than the start. */
#define DRAIN_MAX 200

/* Edges of both inputs in one order. */
struct batch {
  struct {
    placido_gpio_edge edge;
    bool is_pedal;
  } edges[2 * PLACIDO_GPIO_EDGES_MAX];
  size_t count;
  bool is_pedal_drained; /* no further edge of the pedal waits */
};

static int drain(const placido_gpio_inputs *inputs, void *line) {
  placido_gpio_edge edges[PLACIDO_GPIO_EDGES_MAX];
  size_t count = 1;
  int code = 0;
  for (int i = 0; line && !code && count > 0 && i < DRAIN_MAX; i++) {
    code = inputs->lines->read(line, edges, &count);
  }
  return code;
}

int placido_gpio_inputs_start(placido_gpio_inputs *inputs) {
  inputs->event_count = inputs->event_next = 0;
  int level = 0;
  int code = drain(inputs, inputs->trigger);
  if (!code) {
    code = drain(inputs, inputs->pedal);
  }
  if (!code && inputs->pedal) {
    code = inputs->lines->get(inputs->pedal, &level);
  }
  placido_gpio_debounce_start(&inputs->debounce, level);
  return code;
}

static void push(placido_gpio_inputs *inputs, const char *name, int64_t t_ns, int value) {
  if (inputs->event_count < PLACIDO_GPIO_EVENTS_MAX) {
    inputs->events[inputs->event_count++] =
        (placido_event){.t_ns = t_ns, .seq = ++inputs->seq, .name = name, .value = value};
  }
}

static void push_change(placido_gpio_inputs *inputs, const placido_gpio_change *change) {
  push(inputs, "pedal", change->t_ns, change->level);
}

static void accept_edge(placido_gpio_inputs *inputs, const placido_gpio_edge *edge, bool is_pedal) {
  placido_gpio_change change;
  inputs->seq += edge->lost;
  inputs->lost_count += edge->lost;
  if (!is_pedal) {
    inputs->trigger_count++;
    push(inputs, "trigger", edge->t_ns, 1);
  } else if (placido_gpio_debounce_edge(&inputs->debounce, edge->t_ns, edge->level, &change)) {
    push_change(inputs, &change);
  }
}

/* Puts edges of a line into the batch, which stays in the order of time. */
static void insert(struct batch *batch, const placido_gpio_edge *edges, size_t count,
                   bool is_pedal) {
  for (size_t i = 0; i < count; i++) {
    size_t place = batch->count++;
    for (; place > 0 && batch->edges[place - 1].edge.t_ns > edges[i].t_ns; place--) {
      batch->edges[place] = batch->edges[place - 1];
    }
    batch->edges[place].edge = edges[i];
    batch->edges[place].is_pedal = is_pedal;
  }
}

static int read_batch(struct batch *batch, const placido_gpio_inputs *inputs) {
  placido_gpio_edge edges[PLACIDO_GPIO_EDGES_MAX];
  size_t count = 0;
  *batch = (struct batch){0};
  int code = inputs->trigger ? inputs->lines->read(inputs->trigger, edges, &count) : 0;
  insert(batch, edges, count, false);
  count = 0;
  if (!code && inputs->pedal) {
    code = inputs->lines->read(inputs->pedal, edges, &count);
  }
  insert(batch, edges, count, true);
  batch->is_pedal_drained = count < PLACIDO_GPIO_EDGES_MAX;
  return code;
}

/* Ends the pedal's movement where it is due. The line is asked before: where an edge was lost, a
 * pedal must not stay pressed for ever. */
static int settle(placido_gpio_inputs *inputs, int64_t now_ns) {
  placido_gpio_debounce *debounce = &inputs->debounce;
  if (now_ns < placido_gpio_debounce_due_ns(debounce)) {
    return 0;
  }
  int level;
  const int code = inputs->lines->get(inputs->pedal, &level);
  if (code) {
    return code;
  }
  placido_gpio_change change;
  if (level != debounce->raw && placido_gpio_debounce_edge(debounce, now_ns, level, &change)) {
    push_change(inputs, &change);
  }
  if (placido_gpio_debounce_settle(debounce, now_ns, &change)) {
    push_change(inputs, &change);
  }
  return 0;
}

/* Takes what has come. */
static int take(placido_gpio_inputs *inputs) {
  struct batch batch;
  const int64_t before_ns = inputs->lines->clock_ns(); /* every edge until then is in the batch */
  inputs->event_count = inputs->event_next = 0;
  int code = read_batch(&batch, inputs);
  const int64_t after_ns = inputs->lines->clock_ns();
  for (size_t i = 0; i < batch.count; i++) {
    if (batch.edges[i].edge.t_ns < 0 || batch.edges[i].edge.t_ns > after_ns) {
      return EOVERFLOW;
    }
    accept_edge(inputs, &batch.edges[i].edge, batch.edges[i].is_pedal);
  }
  if (!code && batch.is_pedal_drained) {
    code = settle(inputs, before_ns);
  }
  return code;
}

static int wait_edge(const placido_gpio_inputs *inputs, int64_t now_ns, int64_t deadline_ns) {
  void *lines[2];
  size_t count = 0;
  if (inputs->trigger) {
    lines[count++] = inputs->trigger;
  }
  if (inputs->pedal) {
    lines[count++] = inputs->pedal;
  }
  const int64_t due_ns = placido_gpio_debounce_due_ns(&inputs->debounce);
  int64_t left_ns = (due_ns < deadline_ns ? due_ns : deadline_ns) - now_ns;
  left_ns = left_ns < SLICE_NS ? left_ns : SLICE_NS;
  return left_ns > 0
             ? inputs->lines->wait(lines, count, (int)((left_ns + NS_PER_MS - 1) / NS_PER_MS))
             : 0;
}

int placido_gpio_inputs_next(placido_gpio_inputs *inputs, placido_event *event, int timeout_ms) {
  const int64_t deadline_ns = inputs->lines->clock_ns() + (int64_t)timeout_ms * NS_PER_MS;
  int code = 0;
  while (!code && inputs->event_next == inputs->event_count) {
    code = take(inputs);
    const int64_t now_ns = inputs->lines->clock_ns();
    if (!code && inputs->event_count == 0) {
      code = now_ns < deadline_ns ? wait_edge(inputs, now_ns, deadline_ns) : ETIMEDOUT;
    }
  }
  if (inputs->event_next < inputs->event_count) {
    *event = inputs->events[inputs->event_next++];
    return 0;
  }
  return code;
}
