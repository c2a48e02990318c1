/* A subcommand of the program: a row of the table in main.c and a file of its own. */
#ifndef PLACIDO_CLI_COMMAND_H
#define PLACIDO_CLI_COMMAND_H

#include "acquire/cli/interrupt.h"
#include "acquire/cli/settings.h"
#include "acquire/cli/stages.h"

#include <jansson.h>
#include <placido/notes.h>
#include <placido/status.h>

/* A status of the program: recorded, but not every frame that the camera took. */
#define STATUS_INCOMPLETE 2

/* What a run hands to its end. */
struct outcome {
  placido_notes notes; /* warnings */
  json_t *result;      /* for --json; NULL where there is none */
  bool has_json_lines; /* --json printed a line a frame: `result` is one, too */
  struct stages stages;
  struct interrupt *interrupt; /* told of the directory being written; may be NULL */
};

struct command {
  const char *name, *summary;
  const char *usage;    /* what follows the name */
  const char *examples; /* lines of the help, each ending with a newline */
  const struct option_group *const *groups; /* NULL-terminated */
  void (*list)(void);       /* prints what is built in, for the help; NULL: nothing is */
  const char *needs_verb;   /* what the first word is, where it says what to do; NULL: it does not */
  const char *needs_word;   /* what the one word is; NULL where there need be none */
  bool may_have_word;       /* there may be one all the same */
  bool may_have_more;       /* and further ones */
  bool needs_output;        /* -o is not optional */
  int (*run)(const struct settings *settings, struct outcome *outcome, placido_error *err);
};

extern const struct command command_exam, command_reconstruct, command_simulate, command_phantom,
    command_devices, command_device_sim, command_live, command_session, command_record,
    command_calibrate, command_verify, command_compare, command_iso_check, command_bench, command_import, command_export,
    command_study, command_plan;

#define PROGRAM_VERSION "placido " PLACIDO_VERSION

/* Prints a line of the result to stdout, unless --quiet or --json ask for none. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void say(const struct settings *settings, const char *format, ...);

#endif
