/* Settings as texts, knob by knob. */
#include "acquire/cli/accuracy/setting_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool knob_next(struct knob *knob, const char **text) {
  *knob = (struct knob){0};
  *text += strspn(*text, " ");
  const size_t length = strcspn(*text, " "), name = strcspn(*text, "= ");
  if (length == 0) {
    return false;
  }
  snprintf(knob->name, sizeof knob->name, "%.*s", (int)name, *text);
  if (name < length) {
    snprintf(knob->value, sizeof knob->value, "%.*s", (int)(length - name - 1), *text + name + 1);
  }
  *text += length;
  return true;
}

bool knob_find(struct knob *knob, const char *setting, const char *name) {
  while (knob_next(knob, &setting)) {
    if (strcmp(knob->name, name) == 0) {
      return true;
    }
  }
  return false;
}

double knob_number(const char *value) {
  char *end;
  const double number = strtod(value, &end);
  return end != value && *end == '\0' ? number : (double)NAN;
}

bool knob_same(const char *a, const char *b) {
  const double x = knob_number(a), y = knob_number(b);
  return isfinite(x) && isfinite(y) ? fabs(x - y) <= 1e-9 * fabs(x) : strcmp(a, b) == 0;
}

void knob_replace(char *out, size_t size, const char *setting, const struct knob *by) {
  struct knob knob;
  size_t used = 0;
  out[0] = '\0';
  while (knob_next(&knob, &setting) && used < size) {
    const char *value = strcmp(knob.name, by->name) == 0 ? by->value : knob.value;
    used += (size_t)snprintf(out + used, size - used, "%s%s=%s", used > 0 ? " " : "", knob.name,
                             value);
  }
}
