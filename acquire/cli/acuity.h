/* Predicted acuity and ghost images through one pupil. */
#ifndef PLACIDO_CLI_ACUITY_H
#define PLACIDO_CLI_ACUITY_H

#include "acquire/cli/options.h"

#include <placido/acuity.h>
#include <placido/ghost.h>

#define ACUITY_TESTS_MAX 8

/* Which acuities are wanted. */
struct acuity_wish {
  bool none;    /* not even the default ones */
  size_t count; /* 0: the default ones */
  const placido_acuity_test *tests[ACUITY_TESTS_MAX];
};

/* "e,c,sloan" or "none" into a struct acuity_wish. */
int parse_acuity(void *field, const struct option_row *row, const char *text, placido_error *err);

struct acuity_view {
  size_t count; /* 0: none was wanted */
  placido_acuity items[ACUITY_TESTS_MAX];
  placido_ghosts ghosts;
  double seconds;
};

/* Writes acuity.json (`placido-acuity/1`, docs/formats.md). */
int acuity_save(const struct acuity_view *view, double pupil_mm, const char *path,
                placido_error *err);

#endif
