/* Values of knobs from their settings, by a table of their names. */
#include "acquire/cli/accuracy/knob_values.h"

#include "acquire/cli/accuracy/setting_text.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define FIELD(name) offsetof(struct accuracy_knobs, name)

/* In the order of their enums. */
static const char *const patterns[] = {"crosshatch", "equal-area", "quasi-random", NULL};
static const char *const lights[] = {"spread", "counted", NULL};

/* A whole number, unless it is real; or one of `words`. */
static const struct place {
  const char *name;
  size_t offset;
  bool real;
  const char *const *words;
} table[] = {
    {"meridians", FIELD(meridians), false, NULL},
    {"filter_px", FIELD(filter_px), true, NULL},
    {"knot_mm", FIELD(knot_mm), true, NULL},
    {"degree", FIELD(degree), false, NULL},
    {"tolerance", FIELD(tolerance), true, NULL},
    {"samples", FIELD(samples), false, NULL},
    {"pattern", FIELD(pattern), false, patterns},
    {"light", FIELD(light), false, lights},
    {"bucket_arcmin", FIELD(bucket_arcmin), true, NULL},
    {"buckets", FIELD(buckets), false, NULL},
    {"wavelengths", FIELD(wavelengths), false, NULL},
    {"doubles", FIELD(doubles), false, NULL},
    {"memory_MB", FIELD(memory_MB), true, NULL},
    {"size_px", FIELD(size_px), false, NULL},
    {"trials", FIELD(trials), false, NULL},
};

static bool read_word(int *value, const char *const *words, const char *text) {
  for (*value = 0; words[*value]; (*value)++) {
    if (strcmp(words[*value], text) == 0) {
      return true;
    }
  }
  return false;
}

static bool read_value(struct accuracy_knobs *knobs, const struct place *place,
                       const char *text) {
  void *field = (char *)knobs + place->offset;
  if (place->words) {
    return read_word(field, place->words, text);
  }
  const double value = knob_number(text);
  if (place->real && isfinite(value)) {
    *(double *)field = value;
    return true;
  }
  const bool whole = !place->real && value == floor(value) && fabs(value) <= 1e9;
  if (whole) {
    *(int *)field = (int)value;
  }
  return whole;
}

static bool read_knob(struct accuracy_knobs *knobs, const struct knob *knob) {
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    if (strcmp(table[i].name, knob->name) == 0) {
      return read_value(knobs, &table[i], knob->value);
    }
  }
  return false;
}

int accuracy_knobs_read(struct accuracy_knobs *knobs, const char *setting, placido_error *err) {
  struct knob knob;
  const char *rest = setting;
  while (knob_next(&knob, &rest)) {
    if (!read_knob(knobs, &knob)) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "the setting \"%.90s\" has no such knob or value: %s=%s", setting,
                               knob.name, knob.value);
    }
  }
  return PLACIDO_OK;
}
