/* Settings as texts: "knob=value" pairs with a space between. */
#ifndef PLACIDO_CLI_ACCURACY_SETTING_TEXT_H
#define PLACIDO_CLI_ACCURACY_SETTING_TEXT_H

#include <stdbool.h>
#include <stddef.h>

struct knob {
  char name[24], value[40];
};

/* Reads the pair at *text and moves it on; false at the end. A pair without '=' has no value. */
bool knob_next(struct knob *knob, const char **text);

/* The knob of that name within a setting; false where there is none. */
bool knob_find(struct knob *knob, const char *setting, const char *name);

/* Whether two values are the same: as numbers where both are numbers. */
bool knob_same(const char *a, const char *b);

/* The value as a number; NaN where it is none. */
double knob_number(const char *value);

/* The setting with that knob's value replaced; at most `size` bytes. */
void knob_replace(char *out, size_t size, const char *setting, const struct knob *by);

#endif
