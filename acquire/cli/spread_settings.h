/* What a person may set about the convolution: precision, memory, measured transforms. */
#ifndef PLACIDO_CLI_SPREAD_SETTINGS_H
#define PLACIDO_CLI_SPREAD_SETTINGS_H

#include "base/file.h"

#include <placido/convolution.h>
#include <stdbool.h>

struct settings;

struct spread_settings {
  bool doubles, wisdom;
  double memory_MB; /* 0: the default */
};

/* How a convolution is asked for; its folder stands in `folder`. */
placido_convolution spread_settings_read(char folder[PLACIDO_PATH_MAX],
                                         const struct settings *settings, int threads,
                                         placido_notes *notes);

#endif
