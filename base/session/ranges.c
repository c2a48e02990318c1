/* Numbers of frames as ranges: what is damaged, and what a person asks for. */
#include "base/session/ranges.h"

#include "base/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define NUMBER_MAX 1000000000LL
#define RANGE_TEXT 64 /* more than two numbers have */

static int add_range(placido_ranges *ranges, int64_t first, int64_t last, placido_error *err) {
  placido_range *grown = ranges->items;
  if ((ranges->count & (ranges->count - 1)) == 0) { /* room for 1, 2, 4, 8 ... */
    const size_t room = ranges->count ? 2 * ranges->count : 1;
    grown = placido_memory_grow(ranges->items, room, sizeof *grown, err);
  }
  if (!grown) {
    return PLACIDO_MEMORY;
  }
  ranges->items = grown;
  ranges->items[ranges->count++] = (placido_range){first, last};
  return PLACIDO_OK;
}

int placido_ranges_add(placido_ranges *ranges, int64_t number, placido_error *err) {
  placido_range *last = ranges->count > 0 ? &ranges->items[ranges->count - 1] : NULL;
  if (last && last->last + 1 == number) {
    last->last = number;
    return PLACIDO_OK;
  }
  return add_range(ranges, number, number, err);
}

static bool read_number(int64_t *number, const char **at) {
  char *end;
  if (**at < '0' || **at > '9') {
    return false;
  }
  const long long value = strtoll(*at, &end, 10);
  *number = value;
  *at = end;
  return value <= NUMBER_MAX;
}

int placido_ranges_parse(placido_ranges *ranges, const char *text, placido_error *err) {
  const char *at = text;
  for (;;) {
    placido_range range;
    bool valid = read_number(&range.first, &at);
    range.last = range.first;
    if (valid && *at == '-') {
      at++;
      valid = read_number(&range.last, &at) && range.last >= range.first;
    }
    if (!valid || (*at && *at != ',')) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "%.100s: numbers of frames like 3,5-9 were expected", text);
    }
    int status = add_range(ranges, range.first, range.last, err);
    if (status || !*at) {
      return status;
    }
    at++;
  }
}

bool placido_ranges_have(const placido_ranges *ranges, int64_t number) {
  for (size_t i = 0; i < ranges->count; i++) {
    if (number >= ranges->items[i].first && number <= ranges->items[i].last) {
      return true;
    }
  }
  return false;
}

int64_t placido_ranges_total(const placido_ranges *ranges) {
  int64_t total = 0;
  for (size_t i = 0; i < ranges->count; i++) {
    total += ranges->items[i].last - ranges->items[i].first + 1;
  }
  return total;
}

void placido_ranges_text(char *text, size_t size, const placido_ranges *ranges) {
  size_t used = 0;
  text[0] = '\0';
  for (size_t i = 0; i < ranges->count; i++) {
    const placido_range *range = &ranges->items[i];
    const char *comma = i > 0 ? ", " : "";
    if (used + RANGE_TEXT > size) {
      snprintf(text + used, size - used, "%s...", comma);
      return;
    }
    used += (size_t)(range->first == range->last
                         ? snprintf(text + used, size - used, "%s%" PRId64, comma, range->first)
                         : snprintf(text + used, size - used, "%s%" PRId64 "-%" PRId64, comma,
                                    range->first, range->last));
  }
}

void placido_ranges_free(placido_ranges *ranges) {
  placido_memory_free(ranges->items);
  *ranges = (placido_ranges){0};
}
