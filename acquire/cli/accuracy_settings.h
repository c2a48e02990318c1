/* What a person may ask of accuracy and time: settings are then chosen by the accuracy table. */
#ifndef PLACIDO_CLI_ACCURACY_SETTINGS_H
#define PLACIDO_CLI_ACCURACY_SETTINGS_H

#include "acquire/cli/options.h"

enum accuracy_name { ACCURACY_UNNAMED, ACCURACY_FAST, ACCURACY_STANDARD, ACCURACY_REFERENCE };

struct accuracy_settings {
  double max_error_um, max_error_psf, max_time_ms; /* 0: not asked */
  enum accuracy_name named;
};

struct settings;

/* As on the command line; NULL where none was named. */
const char *accuracy_name_text(enum accuracy_name name);

/* Whether anything is asked that the table must answer. */
bool accuracy_asked(const struct settings *settings);

/* Refuses what contradicts itself, with STATUS_USAGE. */
int accuracy_settings_check(const struct settings *settings, placido_error *err);

#endif
