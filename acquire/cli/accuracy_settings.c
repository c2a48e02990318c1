/* The options about accuracy: an error, a time, or a name. */
#include "acquire/cli/accuracy_settings.h"

#include "acquire/cli/settings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, name)
#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

struct unit {
  const char *name;
  double factor;
};

static const char *last_unit(const struct unit *units) {
  while (units[1].name) {
    units++;
  }
  return units->name;
}

/* A number and a unit of the list, which ends with a NULL; the first stands for a bare number. */
static int parse_unit(double *value, const struct option_row *row, const char *text,
                      const struct unit *units, placido_error *err) {
  char *end;
  const double number = strtod(text, &end);
  const struct unit *unit = units;
  while (unit->name && *end != '\0' && strcmp(end, unit->name) != 0) {
    unit++;
  }
  if (end == text || !unit->name) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: a number was expected, in %s or %s",
                             row->name, text, units[0].name, last_unit(units));
  }
  *value = number * unit->factor;
  if (!(*value >= row->min && *value <= row->max)) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: it ranges from %g to %g %s", row->name,
                             text, row->min, row->max, units[0].name);
  }
  return PLACIDO_OK;
}

static int parse_length(void *field, const struct option_row *row, const char *text,
                        placido_error *err) {
  static const struct unit units[] = {
      {"um", 1}, {"µm", 1}, {"nm", 1e-3}, {"mm", 1e3}, {NULL, 0}};
  return parse_unit(field, row, text, units, err);
}

static int parse_time(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  static const struct unit units[] = {{"ms", 1}, {"s", 1e3}, {NULL, 0}};
  return parse_unit(field, row, text, units, err);
}

static const char *const names[] = {[ACCURACY_FAST] = "fast",
                                    [ACCURACY_STANDARD] = "standard",
                                    [ACCURACY_REFERENCE] = "reference"};

static int parse_name(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  for (size_t i = ACCURACY_FAST; i < COUNT(names); i++) {
    if (strcmp(text, names[i]) == 0) {
      *(enum accuracy_name *)field = (enum accuracy_name)i;
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, STATUS_USAGE, "--%s %s: fast, standard or reference was expected",
                           row->name, text);
}

const char *accuracy_name_text(enum accuracy_name name) { return names[name]; }

bool accuracy_asked(const struct settings *settings) {
  const struct accuracy_settings *asked = &settings->accuracy;
  return asked->named != ACCURACY_UNNAMED || asked->max_error_um > 0 || asked->max_error_psf > 0 ||
         asked->max_time_ms > 0;
}

int accuracy_settings_check(const struct settings *settings, placido_error *err) {
  const struct accuracy_settings *asked = &settings->accuracy;
  const bool limited =
      asked->max_error_um > 0 || asked->max_error_psf > 0 || asked->max_time_ms > 0;
  if (asked->named != ACCURACY_UNNAMED && limited) {
    return placido_error_set(err, STATUS_USAGE,
                             "--accuracy %s names settings, and --max-error, --max-error-psf and "
                             "--max-time have them chosen: leave one out",
                             names[asked->named]);
  }
  if (accuracy_asked(settings) && settings->cwhatuc) {
    return placido_error_set(err, STATUS_USAGE,
                             "--cwhatuc sees as that program did, at the accuracy that it had: "
                             "leave --accuracy and the limits out");
  }
  return PLACIDO_OK;
}

/* Of what measures, of what sees, and of both. */
#define ROW_ERROR \
  {"max-error", 0, "LENGTH", "Chooses the cheapest settings whose elevation is true to so much " \
   "for every eye of the accuracy table: 0.5um, 500nm (rms over the central 6 mm; a bare number " \
   "is um).", FIELD(accuracy.max_error_um), parse_length, 1e-6, 1e3}
#define ROW_ERROR_PSF \
  {"max-error-psf", 0, "SHARE", "The same for the point spread function: the largest error of its " \
   "optical transfer function up to 60 cycles a degree.", FIELD(accuracy.max_error_psf), \
   parse_number, 1e-9, 1}
#define ROW_TIME \
  {"max-time", 0, "TIME", "Chooses the most accurate settings that take no longer from the frame " \
   "to the results, of one core's time: 800ms, 2s (a bare number is ms). With a largest error, too: " \
   "the cheapest that reach it, if they fit.", FIELD(accuracy.max_time_ms), parse_time, 1e-3, 1e9}
#define ROW_NAME \
  {"accuracy", 0, "fast|standard|reference", "Settings by name: fast for a look, standard (the " \
   "default ones), reference as fine as makes a difference. What is promised of them is told.", \
   FIELD(accuracy.named), parse_name, 0, 0}

static const struct option_row exam_rows[] = {ROW_ERROR, ROW_ERROR_PSF, ROW_TIME, ROW_NAME};
static const struct option_row measuring_rows[] = {ROW_ERROR, ROW_TIME, ROW_NAME};
static const struct option_row seeing_rows[] = {ROW_ERROR_PSF, ROW_TIME, ROW_NAME};

const struct option_group options_accuracy = {"Accuracy", exam_rows, COUNT(exam_rows)};
const struct option_group options_accuracy_measuring = {"Accuracy", measuring_rows,
                                                        COUNT(measuring_rows)};
const struct option_group options_accuracy_seeing = {"Accuracy", seeing_rows, COUNT(seeing_rows)};
