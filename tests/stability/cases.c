/* Rows of the table, their names put together, and what a refusal must have. */
#include "tests/stability/cases.h"

#include "tests/stability/table.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 64 };

void case_bounded(const struct bounded *bounded, const char *name, ...) {
  char text[NAME_SIZE];
  va_list arguments;
  va_start(arguments, name);
  vsnprintf(text, sizeof text, name, arguments);
  va_end(arguments);
  stability_add(&(struct stability_row){.name = text,
                                        .condition = bounded->condition,
                                        .perturbation = bounded->perturbation,
                                        .in_unit = bounded->in_unit,
                                        .change = bounded->change,
                                        .out_unit = bounded->out_unit,
                                        .bound = bounded->bound,
                                        .extended = NAN});
}

void case_refused(int status, int expected, const placido_error *err, const char *words,
                  const char *name, ...) {
  char text[NAME_SIZE];
  va_list arguments;
  va_start(arguments, name);
  vsnprintf(text, sizeof text, name, arguments);
  va_end(arguments);
  if (status != expected || strlen(err->text) < 20 || strstr(err->text, words) == NULL) {
    fail_msg("%s: status %d instead of %d, \"%s\" instead of \"%s\"", text, status, expected,
             err->text, words);
  }
  stability_add(&(struct stability_row){.name = text,
                                        .condition = NAN,
                                        .perturbation = NAN,
                                        .change = NAN,
                                        .bound = NAN,
                                        .extended = NAN,
                                        .refused = err->text});
}

size_t count_spoilt(const float *samples, size_t count) {
  size_t spoilt = 0;
  for (size_t i = 0; i < count; i++) {
    spoilt += !isfinite(samples[i]);
  }
  return spoilt;
}
