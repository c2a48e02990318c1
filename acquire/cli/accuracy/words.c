/* Settings of knobs in words. */
#include "acquire/cli/accuracy/sentences.h"

#include "acquire/cli/accuracy/setting_text.h"

#include <stdio.h>
#include <string.h>

/* What stands before and behind a value; or what a knob's one value is called: NULL where nothing
 * need be said. */
static const struct {
  const char *name, *value, *before, *behind;
} phrases[] = {
    {"meridians", NULL, "", " meridians"},
    {"filter_px", NULL, "a filter of ", " px"},
    {"knot_mm", "0", "knots as residuals ask", ""},
    {"knot_mm", NULL, "knots every ", " mm"},
    {"degree", NULL, "degree ", ""},
    {"tolerance", "0", NULL, NULL},
    {"tolerance", NULL, "a tolerance of ", ""},
    {"samples", NULL, "", " rays across"},
    {"light", "counted", "counted", ""},
    {"light", "spread", "spread", ""},
    {"bucket_arcmin", NULL, "buckets of ", "′"},
    {"buckets", NULL, "", " buckets a side"},
    {"wavelengths", "1", "one wavelength", ""},
    {"wavelengths", NULL, "", " wavelengths"},
    {"doubles", "0", "single precision", ""},
    {"doubles", "1", "double precision", ""},
    {"memory_MB", NULL, "tiles of ", " MB"},
    {"size_px", NULL, "transforms of ", " samples a side"},
    {"trials", NULL, "", " trials"},
};

static void say_knob(char *text, size_t size, const struct knob *knob) {
  for (size_t i = 0; i < sizeof phrases / sizeof *phrases; i++) {
    if (strcmp(phrases[i].name, knob->name) == 0 &&
        (!phrases[i].value || strcmp(phrases[i].value, knob->value) == 0)) {
      if (phrases[i].before) {
        snprintf(text, size, "%s%s%s", phrases[i].before, phrases[i].value ? "" : knob->value,
                 phrases[i].behind);
      }
      return;
    }
  }
  snprintf(text, size, "%s %s", knob->name, knob->value);
}

void accuracy_setting_say(char *text, size_t size, const char *setting) {
  struct knob knob;
  size_t used = 0;
  text[0] = '\0';
  while (knob_next(&knob, &setting) && used < size) {
    char words[96] = "";
    say_knob(words, sizeof words, &knob);
    if (words[0] != '\0') {
      used += (size_t)snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "", words);
    }
  }
}
