/* Orders to a simulated camera, read from text. */
#include "acquire/cli/sim_orders.h"

#include "acquire/cli/options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ORDER_BYTES 64
#define COUNT_MAX 1e6
#define SECONDS_MAX 1e6

/* Words beside the names of faults, and what number they take. */
static const struct verb_row {
  const char *word;
  enum sim_verb verb;
  double usual, max; /* number where none is given; the largest */
} verbs[] = {
    {"disconnect", SIM_DISCONNECT, 2, 3600},
    {"slow", SIM_SLOW, 0, 10000},
    {"faults", SIM_LIST, 0, 0},
    {"quit", SIM_QUIT, 0, 0},
};

const char *sim_orders_words(void) {
  return "stall, drop, corrupt, truncate, misnumber, lost-start, lost-end, pending, silent, refuse "
         "or garble and a count, disconnect and seconds, slow and milliseconds, faults, quit";
}

/* The row of a word; false where neither a verb nor a fault is called so. */
static bool find_word(struct sim_order *order, double *max, const char *word) {
  for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; i++) {
    if (strcmp(verbs[i].word, word) == 0) {
      order->verb = verbs[i].verb;
      order->number = verbs[i].usual;
      *max = verbs[i].max;
      return true;
    }
  }
  const int fault = placido_gadget_fault_by_name(word);
  if (fault < 0) {
    return false;
  }
  order->verb = SIM_FAULT;
  order->fault = (enum placido_gadget_fault)fault;
  order->number = 1;
  *max = COUNT_MAX;
  return true;
}

/* A number of 0 to `max`, an "s" behind it passed over. */
static bool read_number(double *number, const char *text, double max) {
  char *end;
  *number = strtod(text, &end);
  end += *end == 's';
  return end != text && *end == '\0' && isfinite(*number) && *number >= 0 && *number <= max;
}

static int parse_words(struct sim_order *order, const char *word, const char *number,
                       placido_error *err) {
  double max;
  *order = (struct sim_order){.verb = SIM_LIST};
  if (!find_word(order, &max, word)) {
    return placido_error_set(err, PLACIDO_INPUT, "\"%s\" is not understood: %s", word,
                             sim_orders_words());
  }
  if (number[0] && !read_number(&order->number, number, max)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s %s: a number from 0 to %g was expected", word,
                             number, max);
  }
  return PLACIDO_OK;
}

int sim_order_parse(struct sim_order *order, const char *line, placido_error *err) {
  char word[ORDER_BYTES] = "", number[ORDER_BYTES] = "", rest[2] = "";
  sscanf(line, "%63s %63s %1s", word, number, rest);
  if (rest[0]) {
    return placido_error_set(err, PLACIDO_INPUT, "%s %s: one number at most was expected", word,
                             number);
  }
  return parse_words(order, word, number, err);
}

/* One order of the list, `length` characters at `text`. */
static int parse_timed(struct sim_order *order, const char *text, size_t length,
                       placido_error *err) {
  char copy[ORDER_BYTES];
  double at_s;
  if (length >= sizeof copy) {
    return placido_error_set(err, STATUS_USAGE, "--faults: \"%.60s...\" is too long", text);
  }
  memcpy(copy, text, length);
  copy[length] = '\0';
  char *at = strchr(copy, '@');
  if (!at || !read_number(&at_s, at + 1, SECONDS_MAX)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--faults: \"%s\" does not say when (stall@5s was expected)", copy);
  }
  *at = '\0';
  char *number = strpbrk(copy, "*=");
  if (number) {
    *number++ = '\0';
  }
  const int status = parse_words(order, copy, number ? number : "", err);
  order->at_ns = llround(at_s * 1e9);
  if (status != PLACIDO_OK && err) {
    err->status = STATUS_USAGE;
  }
  return status == PLACIDO_OK ? PLACIDO_OK : STATUS_USAGE;
}

int sim_orders_parse(struct sim_orders *orders, const char *text, placido_error *err) {
  orders->count = 0;
  while (*text) {
    const size_t length = strcspn(text, ",");
    if (orders->count == SIM_ORDERS_MAX) {
      return placido_error_set(err, STATUS_USAGE, "--faults: more than %d", SIM_ORDERS_MAX);
    }
    const int status = parse_timed(&orders->items[orders->count], text, length, err);
    if (status != PLACIDO_OK) {
      return status;
    }
    orders->count++;
    text += length;
    text += *text == ',';
  }
  return PLACIDO_OK;
}
