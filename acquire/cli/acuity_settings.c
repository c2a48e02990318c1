/* The option --acuity: names of tests, separated by commas. */
#include "acquire/cli/acuity.h"

#include <stdio.h>
#include <string.h>

static void list_names(char *names, size_t size) {
  size_t count, used = 0;
  const placido_acuity_test *tests = placido_acuity_tests(&count);
  names[0] = '\0';
  for (size_t i = 0; i < count && used < size; i++) {
    used += (size_t)snprintf(names + used, size - used, "%s%s", i > 0 ? ", " : "", tests[i].name);
  }
}

static int refuse(const struct option_row *row, const char *text, const char *why,
                  placido_error *err) {
  char names[128];
  list_names(names, sizeof names);
  return placido_error_set(err, STATUS_USAGE, "--%s %s: %s; known are %s; or none", row->name, text,
                           why, names);
}

static int add(struct acuity_wish *wish, const placido_acuity_test *test) {
  for (size_t i = 0; i < wish->count; i++) {
    if (wish->tests[i] == test) {
      return STATUS_USAGE;
    }
  }
  if (wish->count == ACUITY_TESTS_MAX) {
    return STATUS_USAGE;
  }
  wish->tests[wish->count++] = test;
  return PLACIDO_OK;
}

int parse_acuity(void *field, const struct option_row *row, const char *text,
                 placido_error *err) {
  struct acuity_wish *wish = field;
  *wish = (struct acuity_wish){.none = strcmp(text, "none") == 0};
  for (const char *at = text; !wish->none && at != NULL;) {
    char name[16] = "";
    const char *comma = strchr(at, ',');
    const size_t length = comma ? (size_t)(comma - at) : strlen(at);
    if (length < sizeof name) {
      memcpy(name, at, length);
    }
    const placido_acuity_test *test = placido_acuity_test_find(name);
    if (!test) {
      return refuse(row, text, "no such test", err);
    }
    if (add(wish, test) != PLACIDO_OK) {
      return refuse(row, text, "a test stands twice", err);
    }
    at = comma ? comma + 1 : NULL;
  }
  return PLACIDO_OK;
}
