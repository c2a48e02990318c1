/* What a person types: command lines, a word a line, against rows of every kind of value; and each
 * word as orders to a simulated camera and as numbers of frames. */
#include "acquire/cli/options.h"
#include "acquire/cli/sim_orders.h"
#include "base/session/ranges.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <string.h>

#define WORDS_MAX 24
#define LINE_MAX_BYTES 2048

struct values {
  bool on;
  double number;
  int whole;
  const char *text;
  struct number_list numbers;
  struct text_list texts;
};

#define AT(field) offsetof(struct values, field)
static const struct option_row rows[] = {
    {"on", 'o', NULL, "a switch", AT(on), parse_switch, 0, 0},
    {"number", 'n', "X", "a number", AT(number), parse_number, -10, 10},
    {"whole", 0, "N", "an integer", AT(whole), parse_integer, 0, 100},
    {"text", 't', "TEXT", "a text", AT(text), parse_text, 0, 0},
    {"numbers", 0, "X,...", "numbers", AT(numbers), parse_numbers, 0, 1e6},
    {"more", 'm', "TEXT", "texts", AT(texts), parse_text_more, 0, 0},
};
static const struct option_group group = {"Options", rows, sizeof rows / sizeof *rows};
static const struct option_group *const groups[] = {&group, NULL};

static void check(const struct values *values) {
  FUZZ_REQUIRE(values->number >= -10 && values->number <= 10);
  FUZZ_REQUIRE(values->whole >= 0 && values->whole <= 100);
  FUZZ_REQUIRE(values->numbers.count <= LIST_MAX && values->texts.count <= LIST_MAX);
  for (size_t i = 0; i < values->numbers.count; i++) {
    FUZZ_REQUIRE(values->numbers.values[i] >= 0 && values->numbers.values[i] <= 1e6);
  }
}

static void read_orders(const char *word) {
  static struct sim_orders orders;
  struct sim_order order;
  placido_error err = {0};
  if (sim_order_parse(&order, word, &err) == PLACIDO_OK) {
    FUZZ_REQUIRE(order.number >= 0 && order.number <= 1e6);
  }
  if (sim_orders_parse(&orders, word, &err) == PLACIDO_OK) {
    FUZZ_REQUIRE(orders.count <= SIM_ORDERS_MAX);
    for (size_t i = 0; i < orders.count; i++) {
      FUZZ_REQUIRE(orders.items[i].at_ns >= 0);
    }
  }
}

static void read_ranges(const char *word) {
  placido_ranges ranges = {0};
  placido_error err = {0};
  char text[100];
  if (fuzz_check(placido_ranges_parse(&ranges, word, &err), &err)) {
    placido_ranges_text(text, sizeof text, &ranges);
    FUZZ_REQUIRE(ranges.count >= 1 && text[0] != '\0');
    FUZZ_REQUIRE(placido_ranges_total(&ranges) >= (int64_t)ranges.count);
  }
  placido_ranges_free(&ranges);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char line[LINE_MAX_BYTES + 1] = "", *argv[WORDS_MAX + 1] = {NULL}, *rest = line;
  static char command[] = "fuzz";
  int argc = 1;
  memcpy(line, data, size < LINE_MAX_BYTES ? size : LINE_MAX_BYTES);
  argv[0] = command;
  while (rest && argc < WORDS_MAX) {
    argv[argc++] = strsep(&rest, "\n");
    read_orders(argv[argc - 1]);
    read_ranges(argv[argc - 1]);
  }
  struct values values = {.on = false};
  struct text_list more = {.count = 0};
  const char *word;
  placido_error err = {0};
  const int status =
      options_parse(&values, &word, size % 2 ? &more : NULL, groups, argc, argv, &err);
  if (status == PLACIDO_OK) {
    check(&values);
    FUZZ_REQUIRE(more.count <= LIST_MAX);
  } else {
    FUZZ_REQUIRE(status == STATUS_USAGE && err.text[0] != '\0' && !strchr(err.text, '\n'));
  }
  return 0;
}
