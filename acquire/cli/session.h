/* The verbs of `placido session`. */
#ifndef PLACIDO_CLI_SESSION_H
#define PLACIDO_CLI_SESSION_H

#include "acquire/cli/command.h"

int session_check(const struct settings *settings, struct outcome *outcome, placido_error *err);
int session_info(const struct settings *settings, struct outcome *outcome, placido_error *err);
int session_pack(const struct settings *settings, struct outcome *outcome, placido_error *err);
int session_repair(const struct settings *settings, struct outcome *outcome, placido_error *err);
int session_export(const struct settings *settings, struct outcome *outcome, placido_error *err);

#endif
