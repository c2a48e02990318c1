/* The options about rays. */
#include "acquire/cli/ray_settings.h"

#include "acquire/cli/settings.h"

#include <string.h>

#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

static const char *const pattern_names[] = {[PLACIDO_PATTERN_CROSSHATCH] = "crosshatch",
                                            [PLACIDO_PATTERN_EQUAL_AREA] = "equal-area",
                                            [PLACIDO_PATTERN_QUASI_RANDOM] = "quasi-random"};
static const char *const light_names[] = {[PLACIDO_LIGHT_SPREAD] = "spread",
                                          [PLACIDO_LIGHT_COUNTED] = "counted"};

/* Number of the name; `count` where it is none. */
static size_t find_name(const char *const *names, size_t count, const char *text) {
  size_t i = 0;
  while (i < count && strcmp(names[i], text) != 0) {
    i++;
  }
  return i;
}

int parse_pattern(void *field, const struct option_row *row, const char *text,
                  placido_error *err) {
  const size_t found = find_name(pattern_names, COUNT(pattern_names), text);
  if (found == COUNT(pattern_names)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--%s %s: crosshatch, equal-area or quasi-random was expected",
                             row->name, text);
  }
  *(enum placido_pattern_kind *)field = (enum placido_pattern_kind)found;
  return PLACIDO_OK;
}

int parse_light(void *field, const struct option_row *row, const char *text, placido_error *err) {
  const size_t found = find_name(light_names, COUNT(light_names), text);
  if (found == COUNT(light_names)) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: spread or counted was expected",
                             row->name, text);
  }
  *(enum placido_light_kind *)field = (enum placido_light_kind)found;
  return PLACIDO_OK;
}

const char *ray_pattern_name(enum placido_pattern_kind pattern) { return pattern_names[pattern]; }

const char *ray_light_name(enum placido_light_kind light) { return light_names[light]; }

placido_optics ray_settings_read(const struct settings *settings, int threads) {
  return (placido_optics){.samples = settings->samples,
                          .pattern = settings->rays.pattern,
                          .light = settings->rays.light,
                          .grow = settings->rays.grow,
                          .wavelength_nm = settings->rays.wavelength_nm,
                          .bucket_arcmin = settings->bucket_arcmin,
                          .cwhatuc = settings->cwhatuc,
                          .threads = threads};
}
