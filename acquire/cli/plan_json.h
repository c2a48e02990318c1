/* Plans and what is wished of them as JSON. */
#ifndef PLACIDO_CLI_PLAN_JSON_H
#define PLACIDO_CLI_PLAN_JSON_H

#include "acquire/cli/plan_settings.h"

#include <jansson.h>

/* Appends what placido_plan_save would write. PLACIDO_OK, PLACIDO_MEMORY. */
int plan_json_append(json_t *list, const placido_plan *plan, placido_error *err);

/* What the picture's error is at most: left out and approximated together; NaN: out of memory. */
double plan_json_promised(const placido_plan *plan);

/* "on" or "off" by name, of every effect that is not left to the planner. NULL: out of memory. */
json_t *plan_json_forced(const struct plan_settings *settings);

#endif
