/* The options of `placido record`. */
#include "acquire/cli/take_settings.h"

#include "acquire/cli/settings.h"
#include "acquire/cli/subject_id.h"
#include "acquire/trigger.h"

#include <stddef.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, name)
#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

static int parse_codec(void *field, const struct option_row *row, const char *text,
                       placido_error *err) {
  struct take_settings *take = field;
  take->codec_given = strcmp(text, "auto") != 0;
  if (!take->codec_given) {
    return PLACIDO_OK;
  }
  for (enum placido_session_codec codec = 0; codec < PLACIDO_CODEC_OTHER; codec++) {
    if (strcmp(text, placido_session_codec_name(codec)) == 0) {
      take->codec = codec;
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, STATUS_USAGE, "--%s %s: %s was expected", row->name, text,
                           row->value);
}

/* One name, or several separated by commas; a further option adds to those before. */
static int parse_trigger(void *field, const struct option_row *row, const char *text,
                         placido_error *err) {
  static const unsigned sources[] = {PLACIDO_TRIGGER_KEY, PLACIDO_TRIGGER_PEDAL,
                                     PLACIDO_TRIGGER_AUTO};
  for (const char *word = text;; word++) {
    const size_t length = strcspn(word, ",");
    size_t i = 0;
    while (i < COUNT(sources) && (strlen(placido_trigger_name(sources[i])) != length ||
                                  strncmp(placido_trigger_name(sources[i]), word, length) != 0)) {
      i++;
    }
    if (i == COUNT(sources)) {
      return placido_error_set(err, STATUS_USAGE, "--%s %s: %s was expected", row->name, text,
                               row->value);
    }
    *(unsigned *)field |= sources[i];
    word += length;
    if (*word == '\0') {
      return PLACIDO_OK;
    }
  }
}

static const struct option_row rows[] = {
    {"output", 'o', "NAME.session", "The session to write; must not exist yet.", FIELD(output),
     parse_text, 0, 0},
    {"instrument", 0, "FILE", "The topographer's geometry (placido-instrument/1). Needed unless "
     "the device brings its own, as a replayed session does.", FIELD(instrument), parse_text, 0,
     0},
    {"eye", 0, "OD|OS", "Which eye it is: right or left.", FIELD(side), parse_eye, 0, 0},
    {"subject", 0, "ID", "Whose eye it is: an opaque id of letters, digits, - and _, at most 32. "
     "Never a name or a date of birth.", FIELD(take.subject), parse_subject, 0, 0},
    {"axis-z", 0, "Z[,SIGMA]", "z of the cornea on the instrument's axis and its standard "
     "deviation, mm, where it was measured.", FIELD(axis_z), parse_distance, -100, 100},
    {"codec", 0, "ffv1|ffvhuff|raw|auto", "How frames are coded, always without loss (default "
     "auto: ffv1 where this machine holds the camera's rate with it, else ffvhuff).", FIELD(take),
     parse_codec, 0, 0},
    {"for", 0, "SECONDS", "End after so long (default: at Ctrl-C).", FIELD(for_s), parse_number,
     0.001, 1e7},
    {"frames", 0, "N", "End after so many frames.", FIELD(take.frames), parse_integer, 1, 2e9},
    {"queue", 0, "MB", "Memory for frames that wait for the disk (default 256).",
     FIELD(take.queue_mb), parse_integer, 1, 65536},
};

static const struct option_row burst_rows[] = {
    {"trigger", 0, "key|pedal|auto", "Record bursts only, and what starts them: space or return; "
     "--pedal; an eye that is held ready. May be given several times.", FIELD(take.triggers),
     parse_trigger, 0, 0},
    {"burst", 0, "N", "Frames of a burst (default 8).", FIELD(take.burst), parse_integer, 1,
     10000},
    {"bursts", 0, "N", "End after so many bursts.", FIELD(take.bursts), parse_integer, 1, 1e6},
    {"pedal", 0, "URI", "The foot pedal, such as \"gpio:/dev/gpiochip0?pedal=!7\".",
     FIELD(take.pedal), parse_text, 0, 0},
    {"light", 0, "URI", "The light, such as \"gpio:/dev/gpiochip0?light=5\": on for the bursts, or "
     "for the recording, and off in every way out.", FIELD(take.light), parse_text, 0, 0},
    {"guide", 0, NULL, "Say how the instrument has to be moved.", FIELD(take.guide), parse_switch,
     0, 0},
};

const struct option_group options_take = {"Recording", rows, COUNT(rows)};
const struct option_group options_burst = {"Bursts", burst_rows, COUNT(burst_rows)};
