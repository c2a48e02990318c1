/* Numbers of frames as ranges: "3, 5-9". */
#ifndef PLACIDO_BASE_SESSION_RANGES_H
#define PLACIDO_BASE_SESSION_RANGES_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct placido_range {
  int64_t first, last;
} placido_range;

/* Start with a zeroed struct; free with placido_ranges_free. */
typedef struct placido_ranges {
  placido_range *items;
  size_t count;
} placido_ranges;

/* Adds a number; the last range grows where it is the next one. */
int placido_ranges_add(placido_ranges *ranges, int64_t number, placido_error *err);

/* Adds what a text like "3,5-9" says. PLACIDO_INPUT where it is not understood. */
int placido_ranges_parse(placido_ranges *ranges, const char *text, placido_error *err);

bool placido_ranges_have(const placido_ranges *ranges, int64_t number);

/* How many numbers there are; one that stands in two ranges counts twice. */
int64_t placido_ranges_total(const placido_ranges *ranges);

/* "3, 5-9", cut off with "..." where it is too long. */
void placido_ranges_text(char *text, size_t size, const placido_ranges *ranges);

void placido_ranges_free(placido_ranges *ranges);

#endif
