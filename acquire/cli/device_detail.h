/* One device in detail. */
#ifndef PLACIDO_CLI_DEVICE_DETAIL_H
#define PLACIDO_CLI_DEVICE_DETAIL_H

#include "acquire/cli/command.h"

/* Opens the device of settings->input, and tells who it is, the formats, sizes and rates that it
 * has, and its controls with unit, range and value. */
int device_detail(const struct settings *settings, struct outcome *outcome, placido_error *err);

#endif
