/* Command lines: words, a line each, against rows of every kind of value. */
#include "acquire/cli/options.h"
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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char line[LINE_MAX_BYTES + 1] = "", *argv[WORDS_MAX + 1] = {NULL}, *rest = line;
  static char command[] = "fuzz";
  int argc = 1;
  memcpy(line, data, size < LINE_MAX_BYTES ? size : LINE_MAX_BYTES);
  argv[0] = command;
  while (rest && argc < WORDS_MAX) {
    argv[argc++] = strsep(&rest, "\n");
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
