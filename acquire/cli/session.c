/* `placido session`: looks after what was recorded. */
#include "acquire/cli/session.h"

#include <stdio.h>
#include <string.h>

enum need { NEVER, MAY, MUST };

static const struct verb {
  const char *name, *summary;
  enum need output;
  bool takes_instrument, takes_pictures; /* --instrument; --frames and --type */
  int (*run)(const struct settings *settings, struct outcome *outcome, placido_error *err);
} verbs[] = {
    {"check", "Decode every frame and hold all files against each other; exit code 4: damaged.",
     NEVER, false, false, session_check},
    {"info", "Tell what was recorded, of whom, with what.", NEVER, false, false, session_info},
    {"pack", "Make FFV1 of a faster codec's frames, in place or with -o; verified bit for bit.",
     MAY, false, false, session_pack},
    {"repair", "Make a sound session of what is whole in a torn one.", MUST, true, false,
     session_repair},
    {"export", "Write frames as pictures, every sample as it is.", MUST, false, true,
     session_export},
};
#define VERB_COUNT (sizeof verbs / sizeof verbs[0])

static const struct verb *find_verb(const char *name) {
  for (size_t i = 0; i < VERB_COUNT; i++) {
    if (strcmp(verbs[i].name, name) == 0) {
      return &verbs[i];
    }
  }
  return NULL;
}

/* Options that the verb has no use for are a misunderstanding, and not ignored. */
static int check_options(const struct verb *verb, const struct settings *settings,
                         placido_error *err) {
  if (verb->output == MUST && !settings->output) {
    return placido_error_set(err, STATUS_USAGE, "%s: say where the result goes with -o",
                             verb->name);
  }
  const char *surplus = NULL;
  if (verb->output == NEVER && settings->output) {
    surplus = "output";
  } else if (!verb->takes_instrument && settings->instrument) {
    surplus = "instrument";
  } else if (!verb->takes_pictures && settings->frame_list) {
    surplus = "frames";
  } else if (!verb->takes_pictures && settings->picture_type) {
    surplus = "type";
  }
  return surplus ? placido_error_set(err, STATUS_USAGE, "%s does not take --%s", verb->name,
                                     surplus)
                 : PLACIDO_OK;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  const struct verb *verb = find_verb(settings->verb);
  if (!verb) {
    return placido_error_set(err, STATUS_USAGE,
                             "\"%.100s\" cannot be done to a session (placido help session)",
                             settings->verb);
  }
  const int status = check_options(verb, settings, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  stages_next(&outcome->stages, "%s", verb->name);
  return verb->run(settings, outcome, err);
}

static void list_verbs(void) {
  puts("\nWhat can be done");
  for (size_t i = 0; i < VERB_COUNT; i++) {
    printf("  %-8s %s\n", verbs[i].name, verbs[i].summary);
  }
}

static const struct option_group *const groups[] = {&options_session, &options_general, NULL};

const struct command command_session = {
    .name = "session",
    .summary = "Check, describe, pack, repair or export a recorded session.",
    .usage = "check|info|pack|repair|export NAME.session [OPTION...]",
    .examples = "  placido session check eye.session\n"
                "  placido session pack eye.session\n"
                "      the fast copy goes once every frame of the new one was compared\n"
                "  placido session repair torn.session -o eye.session\n"
                "  placido session export eye.session -o pictures --frames 3,5-9 --type tiff\n",
    .groups = groups,
    .list = list_verbs,
    .needs_verb = "what to do (check, info, pack, repair or export)",
    .needs_word = "NAME.session",
    .run = run,
};
